// SPDX-License-Identifier: MIT
#include "parallel/heap.hpp"

#include <cstdlib> // says whether it is glibc

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace flotilla {

void release_free_memory() {
#if defined(__GLIBC__)
    malloc_trim(0);
#endif
}

} // namespace flotilla
