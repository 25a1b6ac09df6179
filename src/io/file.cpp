// SPDX-License-Identifier: MIT
#include "io/file.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <flotilla/error.hpp>

namespace flotilla::io {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, std::string_view action, int error) {
    throw IoError(path.string() + ": cannot " + std::string(action) + ": " +
                  std::error_code(error, std::generic_category()).message());
}

/// A file descriptor that closes itself.
class Descriptor {
  public:
    Descriptor(const fs::path& path, int flags) : value_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
    ~Descriptor() {
        if (value_ >= 0) ::close(value_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] int get() const { return value_; }
    /// Closes now; some file systems report a failed write only here. Returns errno or 0.
    int close() {
        const int result = ::close(value_);
        value_ = -1;
        return result == 0 ? 0 : errno;
    }

  private:
    int value_;
};

/// Returns errno, 0 after success.
int write_all(int descriptor, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::write(descriptor, bytes.data(), bytes.size());
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return errno;
        bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
    return 0;
}

int write_and_sync(const fs::path& path, std::span<const std::byte> bytes) {
    Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC);
    if (file.get() < 0) return errno;
    if (const int error = write_all(file.get(), bytes)) return error;
    if (::fsync(file.get()) != 0) return errno;
    return file.close();
}

} // namespace

std::vector<std::byte> read_file(const fs::path& path) {
    Descriptor file(path, O_RDONLY);
    if (file.get() < 0) fail(path, "open", errno);
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) fail(path, "read", errno);
    std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
    std::size_t size = 0;
    while (true) {
        if (size == bytes.size()) bytes.resize(size + 4096); // it grew, or is not a plain file
        const ssize_t n = ::read(file.get(), bytes.data() + size, bytes.size() - size);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail(path, "read", errno);
        if (n == 0) break;
        size += static_cast<std::size_t>(n);
    }
    bytes.resize(size);
    return bytes;
}

std::string read_text(const fs::path& path) {
    const auto bytes = read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void write_file(const fs::path& path, std::span<const std::byte> bytes) {
    const fs::path temporary = path.string() + std::string(kTemporarySuffix);
    if (const int error = write_and_sync(temporary, bytes)) {
        ::unlink(temporary.c_str());
        fail(path, "write", error);
    }
    replace_file(temporary, path);
}

void replace_file(const fs::path& from, const fs::path& to) {
    if (::rename(from.c_str(), to.c_str()) != 0) {
        const int error = errno;
        ::unlink(from.c_str());
        fail(to, "replace", error);
    }
    sync_folder(to.has_parent_path() ? to.parent_path() : fs::path("."));
}

void write_file(const fs::path& path, std::string_view text) { write_file(path, std::as_bytes(std::span(text))); }

void sync_folder(const fs::path& folder) {
    Descriptor descriptor(folder, O_RDONLY | O_DIRECTORY);
    if (descriptor.get() < 0) fail(folder, "open", errno);
    // Some file systems cannot sync a folder and say EINVAL; nothing more can be done there.
    if (::fsync(descriptor.get()) != 0 && errno != EINVAL) fail(folder, "sync", errno);
}

void create_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw IoError(folder.string() + ": cannot create the folder: " + error.message());
}

FolderLock::FolderLock(const fs::path& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (descriptor_ < 0) fail(folder, "open", errno);
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    ::close(descriptor_);
    throw IoError(folder.string() + ": another run is writing into this folder");
}

FolderLock::~FolderLock() { ::close(descriptor_); }

std::uint64_t checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

AppendFile::AppendFile(const fs::path& path)
    : path_(path), descriptor_(::open(path.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) fail(path, "open", errno);
}

AppendFile::~AppendFile() { ::close(descriptor_); }

void AppendFile::append(std::string_view text) {
    if (const int error = write_all(descriptor_, std::as_bytes(std::span(text)))) fail(path_, "write", error);
}

void AppendFile::sync() {
    if (::fsync(descriptor_) != 0) fail(path_, "sync", errno);
}

} // namespace flotilla::io
