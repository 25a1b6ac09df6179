// SPDX-License-Identifier: MIT
#include "mpi/claim.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <flotilla/error.hpp>

namespace flotilla::mpi {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const char* what) {
    throw IoError(file.string() + ": cannot " + what + ": " + std::strerror(errno));
}

/// Not closed in processes that are started: they keep the lock.
int open_file(const std::filesystem::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT, 0666);
    if (descriptor < 0) fail(file, "open");
    return descriptor;
}

} // namespace

std::optional<Claim> Claim::take(const std::filesystem::path& file) {
    const int descriptor = open_file(file);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return Claim(descriptor);
    const int error = errno;
    ::close(descriptor);
    if (error == EWOULDBLOCK) return {};
    errno = error;
    fail(file, "lock");
}

Claim Claim::wait_for(const std::filesystem::path& file) {
    const int descriptor = open_file(file);
    while (::flock(descriptor, LOCK_EX) != 0)
        if (errno != EINTR) fail(file, "lock");
    return Claim(descriptor);
}

Claim::~Claim() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

} // namespace flotilla::mpi
