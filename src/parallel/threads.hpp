// SPDX-License-Identifier: MIT
// Where threads come from: OpenMP (threads_openmp.cpp), or for ThreadSanitizer, which does not see into OpenMP's
// runtime, plain threads (threads_plain.cpp, chosen at build by FLOTILLA_PLAIN_THREADS, for tests alone).
#pragma once

#include <memory>
#include <type_traits>

namespace flotilla {

/// A reference to a callable, without allocation.
template <class... Arguments>
struct CallRef {
    void (*function)(void*, Arguments...) = nullptr;
    void* object = nullptr;

    template <class F>
    static CallRef of(F&& f) {
        return {[](void* callee, Arguments... arguments) {
                    (*static_cast<std::remove_reference_t<F>*>(callee))(arguments...);
                },
                const_cast<void*>(static_cast<const void*>(std::addressof(f)))};
    }
    void operator()(Arguments... arguments) const { function(object, arguments...); }
};

/// Threads to use where the caller does not say: FLOTILLA_NUM_THREADS, else what OpenMP would take (OMP_NUM_THREADS,
/// else the cores that this process may use).
[[nodiscard]] int default_threads();

/// The cores that this process may use.
[[nodiscard]] int usable_cores();

/// Whether the caller is one of several that work side by side already: in an active parallel region of OpenMP, or in a
/// task of TBB.
[[nodiscard]] bool among_workers();

/// Threads of coarse work for which nobody gave a number: default_threads(), or one among workers.
[[nodiscard]] inline int free_threads() { return among_workers() ? 1 : default_threads(); }

/// One parallel region: calls work(thread, threads) side by side for thread = 0, which is the caller, to threads - 1,
/// and returns when all calls have. As many as `wanted`, or fewer where OpenMP's limits (nesting, OMP_THREAD_LIMIT,
/// OMP_DYNAMIC) say so. No exceptions.
void with_threads(int wanted, const CallRef<int, int>& work);

} // namespace flotilla
