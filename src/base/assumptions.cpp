// SPDX-License-Identifier: MIT
#include "base/assumptions.hpp"

#include <bit>
#include <cfloat>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <limits>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0) ||                          \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "flotilla cannot be built with -ffast-math or a part of it: proofs would be none"
#endif

namespace flotilla {
namespace {

static_assert(std::numeric_limits<double>::is_iec559 && std::numeric_limits<double>::digits == 53,
              "error bounds and exact predicates are those of IEEE 754 binary64");
static_assert(std::numeric_limits<float>::is_iec559, "coarse boxes are rounded outwards in IEEE 754 binary32");
static_assert(FLT_EVAL_METHOD == 0, "a double must be computed as a double: x87 keeps more, and error bounds break");
static_assert(sizeof(std::size_t) == 8 && sizeof(std::ptrdiff_t) == 8, "pairs and features are counted in 64 bits");
static_assert(CHAR_BIT == 8 && std::endian::native == std::endian::little,
              "files hold the bytes of numbers as they are");

/// What a compiler cannot know.
template <class T>
T hidden(T value) {
    volatile T out = value;
    return out;
}

} // namespace

std::string arithmetic_fault() {
    constexpr double kHalfUlp = 0x1p-53; // of 1
    const double one = hidden(1.0), half = hidden(kHalfUlp);
    if (one + half != 1 || !(one + hidden(1.5 * kHalfUlp) > 1) || -one - half != -1 || !(-one - 1.5 * half < -1))
        return "sums are not rounded to nearest, ties to even";
    if ((one + half) + half != 1) return "sums are kept to more digits than a double has";
    const double x = hidden(1 + 0x1p-30);
    if (x * x - hidden(1 + 0x1p-29) != 0)
        return "products are not rounded before they are added: this build contracts (-ffp-contract=off is missing)";
    const double least = hidden(std::numeric_limits<double>::min());
    if (!(least / 2 > 0) || least / 2 * 2 != least) return "subnormal numbers are flushed to zero";
    return {};
}

} // namespace flotilla
