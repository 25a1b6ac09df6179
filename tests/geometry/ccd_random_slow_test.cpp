// SPDX-License-Identifier: MIT
// All generated queries: 10^8 wide against scalar, 10^6 against exact arithmetic. Others than the fast test's.
#include <gtest/gtest.h>

#include "support/ccd_random.hpp"

namespace flotilla::test {
namespace {

constexpr std::uint64_t kFirst = std::uint64_t{1} << 40;

TEST(CcdRandomSlow, WideKernelsGiveTheBitsOfTheScalarCode) {
    check_wide_against_scalar(kFirst, count_from_environment("FLOTILLA_CCD_QUERIES", 100'000'000));
}

TEST(CcdRandomSlow, MissesNoContactOfTheExactOracle) {
    check_against_oracle(kFirst, count_from_environment("FLOTILLA_CCD_ORACLE_QUERIES", 1'000'000));
}

} // namespace
} // namespace flotilla::test
