// SPDX-License-Identifier: MIT
// Whole files, read and written so that a crash, a full disk or a power cut leaves the old content or the new one,
// never a mixture. Every failure is an IoError that names the path and carries the system's own text.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flotilla::io {

/// The file's bytes.
[[nodiscard]] std::vector<std::byte> read_file(const std::filesystem::path& path);
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

/// What is written to take the place of what `path` names, in one or several parts. Everything that writes whole files
/// does so by this. A regular file, or none yet, is replaced at once by close(): until then the content is beside it
/// under a temporary name, which is gone again without close(). A symbolic link stays, and what it leads to is
/// replaced. What is no regular file (a pipe, a device, a descriptor of a process) is written straight into.
class OutputFile {
  public:
    explicit OutputFile(const std::filesystem::path& path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void append(std::span<const std::byte> bytes);
    void append(std::string_view text);
    /// Makes what was appended durable, and lets it stay under its temporary name where close() is not reached. Of
    /// another thread than append() maybe.
    void sync();
    /// Syncs, renames, syncs the folder.
    void close();

  private:
    std::filesystem::path path_, target_, temporary_; ///< as given, links followed, beside that; empty: straight
    int descriptor_ = -1;
    std::atomic<bool> stays_ = false;
};

/// The temporary name of an OutputFile of this path; empty where it writes straight.
[[nodiscard]] std::filesystem::path temporary_name(const std::filesystem::path& path);
/// Puts what is under the temporary name in the place of what `path` names, as close() would have.
void take_temporary(const std::filesystem::path& path);

/// IoError where an OutputFile could not be opened now. Changes nothing: for what must be known before other files do.
void check_writable(const std::filesystem::path& path);

/// All of it by an OutputFile. On failure what was there before is as it was, if it is a regular file.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_file(const std::filesystem::path& path, std::string_view text);

/// Makes earlier renames and removals in the folder durable.
void sync_folder(const std::filesystem::path& folder);

/// Creates the folder and its parents where they are missing.
void create_folder(const std::filesystem::path& folder);

/// Keeps other processes from writing into a folder while it lives; the system gives it up with the process, however
/// that ends.
class FolderLock {
  public:
    /// IoError where another process (or another lock of this one) has it. File systems without locks are left
    /// unlocked.
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

  private:
    int descriptor_;
};

/// Names that an interrupted OutputFile left behind end with this.
inline constexpr std::string_view kTemporarySuffix = ".tmp";

/// A checksum of bytes (XXH3, 64 bits). Stored in files: never to be changed.
[[nodiscard]] std::uint64_t checksum(std::span<const std::byte> bytes);

/// A file that only grows, one whole line per call: what is lost in a crash is whole lines at the end.
class AppendFile {
  public:
    /// Opens for appending, creating the file where it is missing.
    explicit AppendFile(const std::filesystem::path& path);
    ~AppendFile();
    AppendFile(const AppendFile&) = delete;
    AppendFile& operator=(const AppendFile&) = delete;

    void append(std::string_view text);
    void sync();

  private:
    std::filesystem::path path_;
    int descriptor_ = -1;
};

} // namespace flotilla::io
