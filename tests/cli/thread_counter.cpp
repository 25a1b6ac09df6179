// SPDX-License-Identifier: MIT
// Loaded before a program (LD_PRELOAD), counts the threads that it starts and writes their number to the file
// THREAD_COUNT_FILE.
#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace {

struct Counter {
    std::atomic<int> threads{0};
    ~Counter() {
        const char* const name = std::getenv("THREAD_COUNT_FILE");
        std::FILE* const file = name != nullptr ? std::fopen(name, "w") : nullptr;
        if (file == nullptr) return;
        std::fprintf(file, "%d", threads.load());
        std::fclose(file);
    }
} counter;

} // namespace

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*start)(void*),
                              void* argument) noexcept {
    using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
    static const auto create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
    ++counter.threads;
    return create(thread, attributes, start, argument);
}
