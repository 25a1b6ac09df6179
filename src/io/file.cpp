// SPDX-License-Identifier: MIT
#include "io/file.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

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

/// Where symbolic links lead, also where nothing is there yet. Empty: to a descriptor of a process, whose name says
/// nothing, or nowhere.
fs::path followed(fs::path path) {
    constexpr int kMostLinks = 40; // as Linux has it
    std::error_code error;
    for (int k = 0; k < kMostLinks && fs::is_symlink(path, error); ++k) {
        const fs::path folder = path.parent_path(), to = fs::read_symlink(path, error);
        if (error || fs::weakly_canonical(folder, error).string().starts_with("/proc/")) return {};
        path = folder / to; // of an absolute one: itself
    }
    return fs::is_symlink(path, error) ? fs::path() : path; // round and round: opening says so
}

/// Where a new file for `path` belongs; empty where what is there is to be written into.
fs::path to_be_replaced(const fs::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) return {};
    return followed(path);
}

fs::path beside(const fs::path& target) { return target.string() + std::string(kTemporarySuffix); }

/// Pipes and most devices cannot be synced and say EINVAL: `straight`. Returns errno, 0 after success.
int sync_content(int descriptor, bool straight) {
    return ::fsync(descriptor) != 0 && !(straight && errno == EINVAL) ? errno : 0;
}

} // namespace

fs::path temporary_name(const fs::path& path) {
    const fs::path target = to_be_replaced(path);
    return target.empty() ? target : beside(target);
}

void take_temporary(const fs::path& path) {
    const fs::path target = to_be_replaced(path);
    if (::rename(beside(target).c_str(), target.c_str()) != 0) fail(path, "replace", errno);
}

void check_writable(const fs::path& path) {
    const fs::path target = to_be_replaced(path);
    if (target.empty()) { // not opened: the reader of a pipe would take that for all there is
        std::error_code error;
        if (fs::is_directory(path, error)) fail(path, "write", EISDIR);
        if (::access(path.c_str(), W_OK) != 0) fail(path, "write", errno);
        return;
    }
    const fs::path temporary = beside(target);
    if (Descriptor(temporary, O_WRONLY | O_CREAT | O_EXCL).get() >= 0)
        ::unlink(temporary.c_str());
    else if (errno != EEXIST || Descriptor(temporary, O_WRONLY).get() < 0)
        fail(path, "write", errno);
}

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

OutputFile::OutputFile(const fs::path& path) : path_(path), target_(to_be_replaced(path)) {
    if (!target_.empty()) temporary_ = beside(target_);
    const fs::path& file = target_.empty() ? path_ : temporary_;
    descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail(path_, "write", errno);
}

OutputFile::~OutputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!temporary_.empty() && !stays_) ::unlink(temporary_.c_str());
}

void OutputFile::append(std::span<const std::byte> bytes) {
    if (const int error = write_all(descriptor_, bytes)) fail(path_, "write", error);
}

void OutputFile::append(std::string_view text) { append(std::as_bytes(std::span(text))); }

void OutputFile::sync() {
    if (const int error = sync_content(descriptor_, target_.empty())) fail(path_, "write", error);
    stays_ = true;
}

void OutputFile::close() {
    if (const int error = sync_content(descriptor_, target_.empty())) fail(path_, "write", error);
    // Some file systems report a failed write only here.
    if (::close(std::exchange(descriptor_, -1)) != 0) fail(path_, "write", errno);
    if (target_.empty()) return;
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(path_, "replace", errno);
    temporary_.clear();
    sync_folder(target_.has_parent_path() ? target_.parent_path() : fs::path("."));
}

void write_file(const fs::path& path, std::span<const std::byte> bytes) {
    OutputFile file(path);
    file.append(bytes);
    file.close();
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
