// SPDX-License-Identifier: MIT
// A list that grows at its end and whose items stay where they are, in slabs of many: neighbours in the list are
// neighbours in memory, and an item costs no allocation of its own.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace flotilla {

/// Items are made a slab at a time, so T must have a default value that costs little.
template <class T, std::size_t kItemsPerSlab>
class SlabList {
  public:
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] T& operator[](std::size_t i) { return slabs_[i / kItemsPerSlab][i % kItemsPerSlab]; }
    [[nodiscard]] const T& operator[](std::size_t i) const { return slabs_[i / kItemsPerSlab][i % kItemsPerSlab]; }
    /// A new item at the end, with T's default value.
    T& add() {
        if (size_ == slabs_.size() * kItemsPerSlab) slabs_.push_back(std::make_unique<T[]>(kItemsPerSlab));
        return (*this)[size_++];
    }
    void clear() {
        slabs_.clear();
        size_ = 0;
    }

  private:
    std::vector<std::unique_ptr<T[]>> slabs_;
    std::size_t size_ = 0;
};

} // namespace flotilla
