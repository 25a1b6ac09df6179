// SPDX-License-Identifier: MIT
// Arrays that sweeps read from end to end, on large pages where the system has them: with pages of 4 kB a stream of
// tens of megabytes waits for an address translation after every few items, and the processor's prefetching ends at
// every page. Changes times only.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace flotilla {

template <class T>
struct LargePageAllocator {
    using value_type = T;
    LargePageAllocator() = default;
    template <class U>
    LargePageAllocator(const LargePageAllocator<U>&) {} // NOLINT(google-explicit-constructor): as allocators convert

    T* allocate(std::size_t n) {
        const std::size_t bytes = size_of(n);
        void* memory = ::operator new(bytes, alignment_of(bytes));
#if defined(__linux__)
        if (bytes >= kPage) static_cast<void>(madvise(memory, bytes, MADV_HUGEPAGE)); // refused: pages stay small
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t n) { ::operator delete(memory, alignment_of(size_of(n))); }
    friend bool operator==(const LargePageAllocator&, const LargePageAllocator&) { return true; }

  private:
    static constexpr std::size_t kPage = std::size_t{1} << 21; // of x86-64, and of others with base pages of 4 kB

    /// Whole pages where the array is large: nothing else shares them.
    static std::size_t size_of(std::size_t n) {
        if (n > (static_cast<std::size_t>(-1) - kPage) / sizeof(T)) throw std::bad_array_new_length();
        const std::size_t bytes = n * sizeof(T);
        return bytes >= kPage ? (bytes + kPage - 1) / kPage * kPage : bytes;
    }
    static std::align_val_t alignment_of(std::size_t bytes) {
        return std::align_val_t{bytes >= kPage ? kPage : alignof(T)};
    }
};

template <class T>
using LargeVector = std::vector<T, LargePageAllocator<T>>;

} // namespace flotilla
