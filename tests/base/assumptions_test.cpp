// SPDX-License-Identifier: MIT
// Each way in which a thread's arithmetic may be another one is found and named.
#include "base/assumptions.hpp"

#include <cfenv>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include <gtest/gtest.h>

#include "base/floating_point.hpp"

namespace flotilla {
namespace {

TEST(Assumptions, HoldInTheDefaultEnvironment) {
    const DefaultFloatingPoint environment;
    EXPECT_EQ(arithmetic_fault(), "");
}

TEST(Assumptions, NameOtherRoundings) {
    for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
        const DefaultFloatingPoint environment;
        std::fesetround(mode);
        EXPECT_EQ(arithmetic_fault(), "sums are not rounded to nearest, ties to even") << mode;
    }
}

#if defined(__SSE__)
TEST(Assumptions, NameSubnormalNumbersThatAreNone) {
    constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040; // bits of MXCSR
    for (const unsigned mode : {kFlushToZero, kDenormalsAreZero, kFlushToZero | kDenormalsAreZero}) {
        const DefaultFloatingPoint environment;
        _mm_setcsr(_mm_getcsr() | mode);
        EXPECT_EQ(arithmetic_fault(), "subnormal numbers are flushed to zero") << mode;
    }
}
#endif

} // namespace
} // namespace flotilla
