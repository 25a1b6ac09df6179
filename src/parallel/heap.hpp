// SPDX-License-Identifier: MIT
// What the C library does with freed memory.
#pragma once

namespace flotilla {

/// Gives freed memory back to the system, which some C libraries (glibc) keep for what the process allocates next. It
/// takes time by all that the process ever freed: for moments when a large part of its memory has become free.
void release_free_memory();

} // namespace flotilla
