// SPDX-License-Identifier: MIT
// The linear complementarity problem of hits that are solved together.
#include <gtest/gtest.h>

#include <algorithm>

#include "dynamic_contact/least_impulses.hpp"
#include "support/random.hpp"

namespace flotilla {
namespace {

Eigen::MatrixXd random_rows(test::Random& random, int rows, int columns) {
    Eigen::MatrixXd out(rows, columns);
    for (double& x : out.reshaped()) x = random.uniform(-1, 1);
    return out;
}

/// The largest of what l < 0, w < 0 and l w are off, against the scale of l and w.
double error_of(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& q, const std::vector<double>& impulses) {
    const Eigen::Map<const Eigen::VectorXd> l(impulses.data(), std::ssize(impulses));
    const Eigen::VectorXd w = matrix * l + q;
    const double of_l = std::max(1e-300, l.cwiseAbs().maxCoeff()), of_w = q.cwiseAbs().maxCoeff();
    return std::max(
        {-l.minCoeff() / of_l, -w.minCoeff() / of_w, (l.cwiseProduct(w)).cwiseAbs().maxCoeff() / (of_l * of_w)});
}

// Of any rank, below its size as well; that it has a solution is known.
TEST(LeastImpulses, AreComplementary) {
    test::Random random(7);
    for (int round = 0; round < 300; ++round) {
        const int n = 1 + static_cast<int>(random.below(40)), rank = 1 + static_cast<int>(random.below(60));
        const Eigen::MatrixXd rows = random_rows(random, n, rank), matrix = rows * rows.transpose();
        const Eigen::VectorXd some = random_rows(random, n, 1), slack = random_rows(random, n, 1);
        const Eigen::VectorXd q = slack.cwiseMax(0) - matrix * some.cwiseMax(0);
        std::vector<double> impulses(static_cast<std::size_t>(n), 0.0);
        ASSERT_TRUE(least_impulses(matrix, q, impulses)) << round << ", " << n << " of rank " << rank;
        EXPECT_LT(error_of(matrix, q, impulses), 1e-8) << round << ", " << n << " of rank " << rank;
    }
}

TEST(LeastImpulses, RowsThatSayTheSameShareWhatTheyCarry) {
    const Eigen::MatrixXd matrix = Eigen::MatrixXd::Constant(4, 4, 2.0);
    std::vector<double> impulses(4, 0.0);
    ASSERT_TRUE(least_impulses(matrix, Eigen::VectorXd::Constant(4, -8.0), impulses));
    for (const double l : impulses) EXPECT_NEAR(l, 1, 1e-6);
}

// A chain of bodies of 1 and 1e6 kg in turn, its first one before a wall: all of its mass is carried there.
TEST(LeastImpulses, OfMassesFarApart) {
    constexpr int kBodies = 12;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(kBodies, kBodies);
    const auto inverse = [](int i) { return i % 2 == 0 ? 1.0 : 1e-6; };
    for (int i = 0; i < kBodies; ++i) {
        matrix(i, i) = inverse(i) + (i > 0 ? inverse(i - 1) : 0.0);
        if (i > 0) matrix(i, i - 1) = matrix(i - 1, i) = -inverse(i - 1);
    }
    Eigen::VectorXd present = Eigen::VectorXd::Zero(kBodies);
    present[0] = -1; // all move at 1 m/s
    std::vector<double> impulses(kBodies, 0.0);
    ASSERT_TRUE(least_impulses(matrix, present, impulses));
    for (int i = 0; i < kBodies; ++i) {
        const double behind = 1e6 * ((kBodies - i + 1) / 2) + (kBodies - i) / 2;
        EXPECT_NEAR(impulses[static_cast<std::size_t>(i)] / behind, 1, 1e-5) << i;
    }
}

// What was found is what is given the next time: nothing changes, and what it says no more goes.
TEST(LeastImpulses, GoOnFromWhatIsGiven) {
    Eigen::MatrixXd matrix(2, 2);
    matrix << 2, 1, 1, 2;
    std::vector<double> impulses{3, 4};
    Eigen::VectorXd present(2);
    present << 0, 0;
    ASSERT_TRUE(least_impulses(matrix, present, impulses));
    EXPECT_NEAR(impulses[0], 3, 1e-8);
    EXPECT_NEAR(impulses[1], 4, 1e-8);
    present << 20, 20;
    ASSERT_TRUE(least_impulses(matrix, present, impulses));
    EXPECT_EQ(impulses[0], 0);
    EXPECT_EQ(impulses[1], 0);
}

} // namespace
} // namespace flotilla
