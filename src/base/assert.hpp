// SPDX-License-Identifier: MIT
// FLOTILLA_ASSERT checks for bugs, not for input: on in debug and RelWithDebInfo builds (no NDEBUG or
// FLOTILLA_ASSERTIONS).
#pragma once

namespace flotilla {
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);
} // namespace flotilla

#if !defined(NDEBUG) || defined(FLOTILLA_ASSERTIONS)
#define FLOTILLA_ASSERT(condition)                                                                                     \
    ((condition) ? static_cast<void>(0) : ::flotilla::assertion_failed(#condition, __FILE__, __LINE__))
#else
#define FLOTILLA_ASSERT(condition) static_cast<void>(0)
#endif
