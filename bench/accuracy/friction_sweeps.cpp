// SPDX-License-Identifier: MIT
#include "friction_sweeps.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "static_contact/contact_tuning.hpp"
#include "static_contact/momentum.hpp"

namespace flotilla::survey {
namespace {

/// As in sweep_island.cpp.
constexpr int kLookEvery = 10;
constexpr double kMostRise = 2;

/// The impulses x of the last two sweeps and y, from which the last began.
class Course {
  public:
    explicit Course(FrictionProblem& problem) : problem_(problem) {
        for (const LocalContact& c : problem.contacts) before_.push_back(c.impulse);
        start_ = before_;
    }

    /// y = x + m (x - x_before)
    void extrapolate(double m) {
        for (std::size_t i = 0; i < before_.size(); ++i) {
            Vec3& r = problem_.contacts[i].impulse;
            const Vec3 x = r;
            r = x + m * (x - before_[i]);
            before_[i] = x;
            start_[i] = r;
        }
    }

    /// (y - x) W (x - x_before) > 0
    [[nodiscard]] bool turned_back() const {
        double sum = 0;
        for (std::size_t i = 0; i < before_.size(); ++i) {
            Vec3 v;
            for (const FrictionProblem::Block& b : problem_.row[i])
                v += b.w * (problem_.contacts[b.column].impulse - before_[b.column]);
            sum += dot(start_[i] - problem_.contacts[i].impulse, v);
        }
        return sum > 0;
    }

  private:
    FrictionProblem& problem_;
    std::vector<Vec3> before_, start_;
};

bool reached(const FrictionProblem& problem, const FrictionGoal& goal, double residual) {
    return residual <= goal.residual && problem.natural_map() <= goal.natural_map;
}

template <Cone kCone>
int sweep_plainly(FrictionProblem& problem, const FrictionGoal& goal, int limit) {
    int sweeps = 0;
    while (sweeps < limit) {
        ++sweeps;
        if (problem.sweep<kCone>() <= goal.residual && reached(problem, goal, problem.residual<kCone>())) break;
    }
    return sweeps;
}

int sweep_with_momentum(FrictionProblem& problem, const FrictionGoal& goal, int limit) {
    Course course(problem);
    Momentum momentum(ContactTuning{}.most_momentum);
    double m = 0, lowest = std::numeric_limits<double>::infinity();
    for (int sweeps = 1; sweeps <= limit; ++sweeps) {
        course.extrapolate(m);
        const double worst = problem.sweep<Cone::disc>();
        bool rose = false;
        if (worst <= goal.residual || sweeps % kLookEvery == 0) {
            const double residual = problem.residual<Cone::disc>();
            if (reached(problem, goal, residual)) return sweeps;
            rose = residual > kMostRise * lowest;
            lowest = rose ? residual : std::min(lowest, residual);
        }
        m = momentum.next(course.turned_back() || rose);
    }
    return limit;
}

} // namespace

int sweep_disc(FrictionProblem& problem, const FrictionGoal& goal, int limit, bool momentum) {
    return momentum ? sweep_with_momentum(problem, goal, limit) : sweep_plainly<Cone::disc>(problem, goal, limit);
}

int sweep_pyramid(FrictionProblem& problem, const FrictionGoal& goal, int limit) {
    return sweep_plainly<Cone::pyramid>(problem, goal, limit);
}

} // namespace flotilla::survey
