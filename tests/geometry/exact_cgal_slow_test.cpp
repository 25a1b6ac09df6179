// SPDX-License-Identifier: MIT
// The exact triangle test against CGAL on 12 classes, 3 million pairs.
#include <gtest/gtest.h>

#include "geometry/exact_cgal_check.hpp"

namespace flotilla::test {
namespace {

class ExactTriangleSlow : public testing::TestWithParam<PairClass> {};

TEST_P(ExactTriangleSlow, AgreesWithCgal) { expect_agreement_with_cgal(GetParam(), 250'000, 2); }

INSTANTIATE_TEST_SUITE_P(Classes, ExactTriangleSlow, testing::ValuesIn(kPairClasses),
                         [](const auto& tested) { return tested.param.name; });

} // namespace
} // namespace flotilla::test
