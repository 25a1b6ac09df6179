// SPDX-License-Identifier: MIT
#include "base/rotation.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

TEST(SinCos, AgreesWithLibmToAnUlpOfOne) {
    std::mt19937_64 rng(1);
    for (double range : {1e-8, 1e-3, 1.0, 10.0, 1e3, 1e6}) {
        std::uniform_real_distribution<double> angle(-range, range);
        for (int i = 0; i < 20000; ++i) {
            const double x = angle(rng);
            const auto [s, c] = sin_cos(x);
            ASSERT_NEAR(s, std::sin(x), 2.3e-16) << x;
            ASSERT_NEAR(c, std::cos(x), 2.3e-16) << x;
        }
    }
}

TEST(SinCos, IsExactAtZeroAndStaysOnTheUnitCircle) {
    EXPECT_EQ(sin_cos(0.0).sin, 0.0);
    EXPECT_EQ(sin_cos(0.0).cos, 1.0);
    EXPECT_EQ(sin_cos(1e-300).sin, 1e-300);
    for (double x = -1e9; x < 1e9; x += 1.234567e6) {
        const auto [s, c] = sin_cos(x);
        EXPECT_NEAR(s * s + c * c, 1.0, 5e-16);
    }
}

TEST(SinCos, OfWhatIsNoAngleIsNoNumber) {
    for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
        EXPECT_TRUE(std::isnan(sin_cos(x).sin)) << x;
        EXPECT_TRUE(std::isnan(sin_cos(x).cos)) << x;
    }
    EXPECT_TRUE(std::isnan(rotation_from_vector({1e200, 0, 0}).w)); // its length is infinite
}

TEST(Rotation, ExponentialMapRoundTrips) {
    std::mt19937_64 rng(2);
    std::normal_distribution<double> n;
    for (int i = 0; i < 2000; ++i) {
        Vec3 w{n(rng), n(rng), n(rng)};
        w = (std::numbers::pi * 0.999 * std::uniform_real_distribution<double>(0, 1)(rng)) * normalized(w);
        EXPECT_NEAR(length(rotation_vector(rotation_from_vector(w)) - w), 0, 1e-13);
    }
    EXPECT_EQ(rotation_from_vector({}), (Quat{1, 0, 0, 0}));
    EXPECT_NEAR(length(rotation_vector(rotation_from_vector({1e-200, 0, 0})) - Vec3{1e-200, 0, 0}), 0, 1e-210);
}

TEST(Rotation, MatrixQuaternionAndProductAgree) {
    std::mt19937_64 rng(3);
    std::normal_distribution<double> n;
    for (int i = 0; i < 2000; ++i) {
        const Quat a = normalized(Quat{n(rng), n(rng), n(rng), n(rng)});
        const Quat b = normalized(Quat{n(rng), n(rng), n(rng), n(rng)});
        const Vec3 v{n(rng), n(rng), n(rng)};
        EXPECT_NEAR(length(rotate(a * b, v) - matrix(a) * (matrix(b) * v)), 0, 1e-14);
        const Quat c = quaternion(matrix(a));
        EXPECT_NEAR(std::abs((a.w * c.w + a.x * c.x) + (a.y * c.y + a.z * c.z)), 1, 1e-14);
    }
}

} // namespace
} // namespace flotilla
