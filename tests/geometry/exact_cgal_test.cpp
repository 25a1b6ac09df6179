// SPDX-License-Identifier: MIT
// A slice of exact_cgal_slow_test for every build: 12 classes, 36,000 pairs.
#include <gtest/gtest.h>

#include "geometry/exact_cgal_check.hpp"

namespace flotilla::test {
namespace {

class ExactTriangle : public testing::TestWithParam<PairClass> {};

TEST_P(ExactTriangle, AgreesWithCgal) { expect_agreement_with_cgal(GetParam(), 3000, 1); }

INSTANTIATE_TEST_SUITE_P(Classes, ExactTriangle, testing::ValuesIn(kPairClasses),
                         [](const auto& tested) { return tested.param.name; });

} // namespace
} // namespace flotilla::test
