// SPDX-License-Identifier: MIT
// Lists that grow together or not at all.
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

namespace flotilla::io {

/// Shortens lists to what they were when it was made, unless keep() was called. Memory may be refused between any two
/// of them. Lists: a tuple of references to vectors.
template <class Lists>
class Growth {
  public:
    explicit Growth(const Lists& lists)
        : lists_(lists), sizes_(std::apply([](const auto&... list) { return std::array{list.size()...}; }, lists)) {}
    ~Growth() {
        if (!kept_) shorten(std::make_index_sequence<std::tuple_size_v<Lists>>());
    }
    Growth(const Growth&) = delete;
    Growth& operator=(const Growth&) = delete;

    void keep() { kept_ = true; }

  private:
    template <std::size_t... I>
    void shorten(std::index_sequence<I...>) {
        (std::get<I>(lists_).resize(sizes_[I]), ...);
    }

    Lists lists_;
    std::array<std::size_t, std::tuple_size_v<Lists>> sizes_;
    bool kept_ = false;
};

} // namespace flotilla::io
