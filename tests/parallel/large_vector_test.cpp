// SPDX-License-Identifier: MIT
#include "parallel/large_vector.hpp"

#include <cstdint>
#include <numeric>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

struct alignas(64) Line {
    std::int64_t value = 0;
};

constexpr std::size_t kPage = std::size_t{1} << 21;

std::uintptr_t place_of(const void* memory) { return reinterpret_cast<std::uintptr_t>(memory); }

TEST(LargeVector, IsAVectorOfAnySize) {
    LargeVector<Line> list;
    for (std::int64_t i = 0; i < 100000; ++i) { // 6.4 MB: through small arrays and large ones
        list.push_back({i});
        ASSERT_EQ(place_of(list.data()) % alignof(Line), 0u);
    }
    const LargeVector<Line> copy = list;
    list.clear();
    list.shrink_to_fit();
    for (std::size_t i = 0; i < copy.size(); ++i) ASSERT_EQ(copy[i].value, static_cast<std::int64_t>(i));
    list = copy;
    EXPECT_EQ(list.size(), copy.size());
    EXPECT_EQ(list.back().value, 99999);
}

TEST(LargeVector, LargeArraysHavePagesOfTheirOwn) {
    EXPECT_EQ(place_of(LargeVector<double>(kPage / sizeof(double)).data()) % kPage, 0u);
    EXPECT_EQ(place_of(LargeVector<double>(5 * kPage / sizeof(double) + 1).data()) % kPage, 0u);
}

TEST(LargeVector, RefusesWhatNoMemoryHolds) {
    LargePageAllocator<Line> allocator;
    EXPECT_THROW(static_cast<void>(allocator.allocate(static_cast<std::size_t>(-1) / sizeof(Line))),
                 std::bad_array_new_length);
}

} // namespace
} // namespace flotilla
