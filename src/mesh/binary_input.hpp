// SPDX-License-Identifier: MIT
// Binary file contents walked value by value, of either byte order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include <flotilla/error.hpp>

namespace flotilla {

class BinaryInput {
  public:
    BinaryInput(const std::filesystem::path& path, std::string_view data, std::size_t position, std::endian order)
        : path_(path), data_(data), position_(position), swap_(order != std::endian::native) {}

    [[nodiscard]] std::size_t position() const { return position_; }
    [[nodiscard]] std::size_t remaining() const { return data_.size() - position_; }

    [[noreturn]] void fail_at(std::size_t byte, const std::string& reason) const {
        throw InputError(path_.string() + ":byte " + std::to_string(byte) + ": " + reason);
    }
    [[noreturn]] void fail(const std::string& reason) const { fail_at(position_, reason); }

    template <class T>
    T take() {
        if (remaining() < sizeof(T)) fail("the file ends early");
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), data_.data() + position_, sizeof(T));
        if (swap_) std::reverse(bytes.begin(), bytes.end());
        position_ += sizeof(T);
        return std::bit_cast<T>(bytes);
    }
    void skip(std::size_t bytes) {
        if (remaining() < bytes) fail("the file ends early");
        position_ += bytes;
    }

  private:
    const std::filesystem::path& path_;
    std::string_view data_;
    std::size_t position_;
    bool swap_;
};

} // namespace flotilla
