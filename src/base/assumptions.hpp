// SPDX-License-Identifier: MIT
// What all results and all proofs take for granted of the machine and of the compiler (src/ASSUMPTIONS.md). The
// compiler's part is checked where assumptions.cpp is compiled, the rest here.
#pragma once

#include <string>

namespace flotilla {

/// What is wrong with the arithmetic of the calling thread, or with that of the build; empty where nothing is. Some
/// nanoseconds.
[[nodiscard]] std::string arithmetic_fault();

} // namespace flotilla
