// SPDX-License-Identifier: MIT
#include "dynamic_contact/least_impulses.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "base/index.hpp"

namespace flotilla {
namespace {

constexpr double kYields = 0x1p-30;   ///< of a diagonal element
constexpr int kTakesBack = 3;         ///< how often what that changed is solved for again
constexpr double kRounding = 0x1p-32; ///< of the largest impulse or velocity: no more than zero
/// Blocks that may be exchanged without fewer being wrong.
constexpr int kBlocks = 3;
constexpr std::size_t kMostSets = 4; ///< of the other method, for each row: rounding may take it round in circles

/// Rows whose impulses push, and the solution for them.
class Pivoting {
  public:
    Pivoting(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& present, const std::vector<double>& impulses)
        : matrix_(matrix), q_(present), pushes_(impulses.size(), 0) {
        const Eigen::Map<const Eigen::VectorXd> l(impulses.data(), std::ssize(impulses));
        q_ -= matrix * l;
        yielding_ = matrix_.diagonal() * kYields;
        for (std::size_t i = 0; i < impulses.size(); ++i)
            pushes_[i] = impulses[i] > 0 || present[static_cast<std::ptrdiff_t>(i)] < 0 ? 1 : 0;
    }

    /// Block by block, which takes few turns; where that goes round in circles one row after the other.
    bool run() { return exchange_blocks() || add_one_by_one(); }

    [[nodiscard]] double impulse(std::size_t i) const {
        return pushes_[i] != 0 ? l_[static_cast<std::ptrdiff_t>(i)] : 0;
    }

  private:
    /// Exchanges all rows that are wrong at once, while they get fewer.
    bool exchange_blocks() {
        std::size_t fewest = pushes_.size() + 1;
        for (int blocks = kBlocks; blocks > 0;) {
            if (!solve()) return false;
            find_wrong();
            if (wrong_.empty()) return true;
            blocks = wrong_.size() < fewest ? kBlocks : blocks - 1;
            fewest = std::min(fewest, wrong_.size());
            for (const std::size_t i : wrong_) pushes_[i] ^= 1;
        }
        return false;
    }

    /// The method of active sets (Lawson and Hanson 1974, chapter 23): l / 2 . A l + q . l falls with every row that is
    /// added, and no set comes twice.
    bool add_one_by_one() {
        Eigen::VectorXd l = Eigen::VectorXd::Zero(q_.size());
        std::ranges::fill(pushes_, std::uint8_t{0});
        for (std::size_t turn = 0; turn <= kMostSets * pushes_.size(); ++turn) {
            if (!solve()) return false;
            double step = 1;
            std::ptrdiff_t first = -1;
            for (const std::ptrdiff_t i : rows_)
                if (l_[i] < 0 && l[i] <= step * (l[i] - l_[i])) step = l[i] / (l[i] - l_[i]), first = i;
            if (first >= 0) { // as far as the first that would pull
                l += step * (l_ - l);
                l[first] = 0;
                pushes_[static_cast<std::size_t>(first)] = 0;
                continue;
            }
            l = l_;
            std::ptrdiff_t least = 0;
            for (std::ptrdiff_t i = 1; i < w_.size(); ++i)
                if (pushes_[static_cast<std::size_t>(i)] == 0 &&
                    (pushes_[static_cast<std::size_t>(least)] != 0 || w_[i] < w_[least]))
                    least = i;
            if (pushes_[static_cast<std::size_t>(least)] != 0 || !(w_[least] < -kRounding * scale_)) return true;
            pushes_[static_cast<std::size_t>(least)] = 1;
        }
        return false;
    }

    /// l of the rows that push, so that their w is zero, and w of all.
    bool solve() {
        rows_.clear();
        for (std::size_t i = 0; i < pushes_.size(); ++i)
            if (pushes_[i] != 0) rows_.push_back(static_cast<std::ptrdiff_t>(i));
        l_ = Eigen::VectorXd::Zero(q_.size());
        if (!rows_.empty()) {
            const Eigen::MatrixXd of_rows = matrix_(rows_, rows_);
            const Eigen::VectorXd right = -q_(rows_), yielding = yielding_(rows_);
            const Eigen::LDLT<Eigen::MatrixXd> factors(of_rows + Eigen::MatrixXd(yielding.asDiagonal()));
            if (factors.info() != Eigen::Success) return false;
            Eigen::VectorXd found = factors.solve(right);
            for (int k = 0; k < kTakesBack; ++k) found += factors.solve(right - of_rows * found);
            for (std::size_t i = 0; i < rows_.size(); ++i) l_[rows_[i]] = found[static_cast<std::ptrdiff_t>(i)];
        }
        w_ = matrix_ * l_ + q_;
        scale_ = (matrix_.cwiseAbs() * l_.cwiseAbs() + q_.cwiseAbs()).maxCoeff();
        return l_.allFinite() && w_.allFinite();
    }

    void find_wrong() {
        wrong_.clear();
        const double least_l = -kRounding * l_.cwiseAbs().maxCoeff(), least_w = -kRounding * scale_;
        for (std::size_t i = 0; i < pushes_.size(); ++i) {
            const auto k = static_cast<std::ptrdiff_t>(i);
            if (pushes_[i] != 0 ? l_[k] < least_l : w_[k] < least_w) wrong_.push_back(i);
        }
    }

    Eigen::MatrixXd matrix_;
    Eigen::VectorXd q_, yielding_, l_, w_;
    double scale_ = 0; ///< m/s, of what w is a sum of
    std::vector<std::uint8_t> pushes_;
    std::vector<std::ptrdiff_t> rows_;
    std::vector<std::size_t> wrong_;
};

} // namespace

bool least_impulses(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& present, std::vector<double>& impulses) {
    Pivoting pivoting(matrix, present, impulses);
    if (!pivoting.run()) return false;
    for (std::size_t i = 0; i < impulses.size(); ++i) impulses[i] = std::max(0.0, pivoting.impulse(i));
    return true;
}

} // namespace flotilla
