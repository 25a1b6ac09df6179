// SPDX-License-Identifier: MIT
#include "cli/run_action.hpp"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <string>

#include <sys/resource.h>

#include <flotilla/error.hpp>
#include <flotilla/world.hpp>

namespace flotilla::cli {
namespace {

/// The limit on what the process may ask for, where there is one.
std::string memory_limit_text() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return {};
    return ": the process may have " + std::to_string(limit.rlim_cur >> 20) + " MiB (ulimit -v)";
}

/// Memory for the way out: where some is refused, destructors may need some all the same (a JSON document's lists what
/// it holds), and one that throws ends the process.
std::atomic<void*> g_reserve = nullptr;

void keep_reserve() {
    constexpr std::size_t kReserve = std::size_t{4}
                                     << 20; // never touched: a JSON document of some 250,000 values needs it
    g_reserve = std::malloc(kReserve);
    if (g_reserve == nullptr) throw std::bad_alloc();
    std::set_new_handler([] {
        std::free(g_reserve.exchange(nullptr));
        throw std::bad_alloc();
    });
}

int guarded(const Action& action) {
    try {
        keep_reserve();
        const int code = action();
        if (!std::cout.flush()) throw IoError("cannot write to standard output");
        return code;
    } catch (const OverlapError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return kOverlap;
    } catch (const ScriptError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return kScript;
    } catch (const BrokenPromise& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return kBrokenPromise;
    } catch (const InputError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return kBadInput;
    } catch (const IoError& e) {
        std::cerr << "flotilla: " << e.what() << '\n';
        return kIoFailure;
    } catch (const std::bad_alloc&) {
        std::cerr << "flotilla: not enough memory" << memory_limit_text() << '\n';
        return kInternalError;
    } catch (const std::exception& e) {
        std::cerr << "flotilla: internal error: " << e.what() << '\n';
        return kInternalError;
    }
}

} // namespace

int run_action(const Action& action) {
    std::signal(SIGXFSZ, SIG_IGN); // a file that may not grow any more is an error of its write, like a full disk
    return guarded(action);
}

} // namespace flotilla::cli
