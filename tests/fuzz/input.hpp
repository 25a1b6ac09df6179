// SPDX-License-Identifier: MIT
// Bytes of a fuzzer as a source of values. At their end everything is zero.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

#include <flotilla/types.hpp>

namespace flotilla::fuzz {

class Input {
  public:
    Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

    template <class T>
    [[nodiscard]] T take() {
        static_assert(std::is_trivially_copyable_v<T>);
        T value{};
        const std::size_t n = std::min(sizeof value, rest_.size());
        if (n > 0) std::memcpy(&value, rest_.data(), n);
        rest_ = rest_.subspan(n);
        return value;
    }
    [[nodiscard]] std::size_t below(std::size_t n) { return n == 0 ? 0 : take<std::uint8_t>() % n; }
    /// Without order of evaluation in doubt.
    [[nodiscard]] Vec3 vector() {
        const auto x = take<double>(), y = take<double>(), z = take<double>();
        return {x, y, z};
    }
    [[nodiscard]] std::string text(std::size_t most) {
        const std::size_t n = std::min(below(most + 1), rest_.size());
        std::string out(reinterpret_cast<const char*>(rest_.data()), n);
        rest_ = rest_.subspan(n);
        return out;
    }
    [[nodiscard]] std::string remaining() const { return {reinterpret_cast<const char*>(rest_.data()), rest_.size()}; }
    [[nodiscard]] bool empty() const { return rest_.empty(); }

  private:
    std::span<const std::uint8_t> rest_;
};

} // namespace flotilla::fuzz
