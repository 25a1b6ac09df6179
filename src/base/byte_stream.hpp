// SPDX-License-Identifier: MIT
// Values as bytes, in the order of memory.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace flotilla {

static_assert(std::endian::native == std::endian::little);

/// Arrays are copied as they lie in memory: their elements must have no padding, whose bytes would be anything.
class ByteWriter {
  public:
    template <typename T>
    void add(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        add_bytes(&value, sizeof value);
    }
    template <typename T>
    void add(const std::vector<T>& values) {
        static_assert(std::is_trivially_copyable_v<T>);
        add(static_cast<std::uint64_t>(values.size()));
        add_bytes(values.data(), values.size() * sizeof(T));
    }
    void add(const std::string& text) {
        add(static_cast<std::uint64_t>(text.size()));
        add_bytes(text.data(), text.size());
    }
    void add_bytes(const void* data, std::size_t size) {
        const std::size_t before = bytes_.size();
        bytes_.resize(before + size);
        if (size > 0) std::memcpy(bytes_.data() + before, data, size);
    }
    [[nodiscard]] std::vector<std::byte> take() { return std::move(bytes_); }

  private:
    std::vector<std::byte> bytes_;
};

/// Calls `fail`, which throws, where the bytes end before what is asked for.
template <class Fail>
class ByteReader {
  public:
    ByteReader(std::span<const std::byte> bytes, Fail fail) : bytes_(bytes), fail_(std::move(fail)) {}

    template <typename T>
    void read(T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        take(&value, sizeof value);
    }
    template <typename T>
    void read(std::vector<T>& values) {
        values.resize(size_of(sizeof(T)));
        take(values.data(), values.size() * sizeof(T));
    }
    void read(std::string& text) {
        text.resize(size_of(1));
        take(text.data(), text.size());
    }
    /// The number of elements, of so many bytes at least each, that come next.
    [[nodiscard]] std::size_t size_of(std::size_t element) {
        std::uint64_t size = 0;
        read(size);
        if (size > bytes_.size() / element) fail_();
        return static_cast<std::size_t>(size);
    }
    [[nodiscard]] std::span<const std::byte> rest() const { return bytes_; }
    void skip(std::size_t size) {
        if (size > bytes_.size()) fail_();
        bytes_ = bytes_.subspan(size);
    }

  private:
    void take(void* to, std::size_t size) {
        if (size > bytes_.size()) fail_();
        if (size > 0) std::memcpy(to, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
    }

    std::span<const std::byte> bytes_;
    Fail fail_;
};

} // namespace flotilla
