// SPDX-License-Identifier: MIT
// Asking for memory before it is needed. No effect but on time.
#pragma once

namespace flotilla {

/// __builtin_prefetch(address, 1) asks for a line to write only where the target has the instruction by name; all
/// x86-64 processors run it, the oldest as one that does nothing. Never a function of its own: kernels compiled for one
/// instruction set use it too.
[[gnu::always_inline]] inline void fetch_to_write(const void* address) {
#if defined(__x86_64__)
    asm volatile("prefetchw %0" : : "m"(*static_cast<const char*>(address)));
#else
    __builtin_prefetch(address, 1);
#endif
}

} // namespace flotilla
