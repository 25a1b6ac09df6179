// SPDX-License-Identifier: MIT
// Integers modulo 2^(32 n) in two's complement, just enough of them to evaluate a 3x3 determinant of any finite
// doubles. Addition and multiplication modulo a power of two form a ring, so a polynomial of the inputs is right
// whatever its intermediate results do, provided only that its final value fits, which the caller's choice of n
// ensures. Slow on purpose (about 0.1 ms for a determinant at full width): it serves coordinates outside [1e-90, 1e101]
// only.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/assert.hpp"

namespace flotilla::exact {

class WideInteger {
  public:
    /// Every finite double is an integer below 2^2098 in units of 2^-1074; a determinant of three differences is below
    /// 2^(3 * 2098 + 6), and 6400 bits hold it with its sign.
    static constexpr std::size_t kMaxLimbs = 200;

    /// value * 2^-exponent in limbs * 32 bits. Precondition: that product is an integer and fits.
    WideInteger(double value, int exponent, std::size_t limbs) : limbs_(limbs) {
        FLOTILLA_ASSERT(limbs <= kMaxLimbs);
        const int unit = unit_exponent(value);
        const auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::abs(value), -unit)); // exact, below 2^53
        if (mantissa != 0) place(mantissa, static_cast<std::size_t>(unit - exponent));
        if (value < 0) *this = WideInteger(0, 0, limbs) - *this;
    }

    /// The exponent e for which value is a 53-bit integer times 2^e. Precondition: value finite.
    static int unit_exponent(double value) {
        int e = 0;
        std::frexp(value, &e); // |value| in [2^(e-1), 2^e)
        return e - 53 < -1074 ? -1074 : e - 53;
    }

    /// Precondition of both: equal widths.
    friend WideInteger operator-(const WideInteger& a, const WideInteger& b) {
        WideInteger r = a;
        std::uint64_t borrow = 0;
        for (std::size_t i = 0; i < a.limbs_; ++i) {
            const std::uint64_t t = std::uint64_t{a.limb_[i]} - b.limb_[i] - borrow;
            r.limb_[i] = static_cast<std::uint32_t>(t);
            borrow = t >> 63;
        }
        return r;
    }
    friend WideInteger operator*(const WideInteger& a, const WideInteger& b) {
        WideInteger r(0, 0, a.limbs_);
        for (std::size_t i = 0; i < a.limbs_; ++i) {
            std::uint64_t carry = 0;
            for (std::size_t j = 0; i + j < a.limbs_; ++j) { // (2^32-1)^2 + 2 (2^32-1) = 2^64 - 1: no overflow
                carry += std::uint64_t{a.limb_[i]} * b.limb_[j] + r.limb_[i + j];
                r.limb_[i + j] = static_cast<std::uint32_t>(carry);
                carry >>= 32;
            }
        }
        return r;
    }

    [[nodiscard]] int sign() const {
        if ((limb_[limbs_ - 1] >> 31) != 0) return -1;
        for (std::size_t i = 0; i < limbs_; ++i)
            if (limb_[i] != 0) return 1;
        return 0;
    }

  private:
    void place(std::uint64_t mantissa, std::size_t shift) {
        const std::size_t at = shift / 32, bits = shift % 32;
        FLOTILLA_ASSERT(at + 3 <= limbs_);
        limb_[at] = static_cast<std::uint32_t>(mantissa << bits);
        limb_[at + 1] = static_cast<std::uint32_t>(mantissa >> (32 - bits));
        if (bits != 0) limb_[at + 2] = static_cast<std::uint32_t>(mantissa >> (64 - bits));
    }

    std::size_t limbs_;
    std::array<std::uint32_t, kMaxLimbs> limb_{}; ///< lowest first; limbs from limbs_ on stay zero
};

} // namespace flotilla::exact
