// SPDX-License-Identifier: MIT
// Large text files in one pass, written or read through a buffer; gzip where the name ends with .gz.
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <string>
#include <string_view>

#include "io/file.hpp"

namespace flotilla::io {

/// Writes an OutputFile. Without close() nothing is left behind but what was synced.
class OutputStream {
  public:
    explicit OutputStream(const std::filesystem::path& path);
    ~OutputStream();
    OutputStream(const OutputStream&) = delete;
    OutputStream& operator=(const OutputStream&) = delete;

    void write(std::string_view text) {
        buffer_ += text;
        if (buffer_.size() >= kBuffer) drain(Drain::full);
    }
    /// All of it so far is in the file and can be read there (WholeLines).
    void flush() { drain(Drain::all); }
    /// What flush() left there is durable, and stays there without close(). Of another thread maybe.
    void sync() { file_.sync(); }
    void close();

  private:
    static constexpr std::size_t kBuffer = 1u << 18;
    enum class Drain : std::uint8_t { full, all, last };
    struct Deflate;

    void drain(Drain what);

    OutputFile file_;
    std::unique_ptr<Deflate> deflate_; ///< null: plain
    std::string buffer_;
};

/// Reads plain and compressed files alike, whatever the name. Damage of a compressed file is an IoError, thrown while
/// reading.
class InputStream {
  public:
    explicit InputStream(const std::filesystem::path& path);
    ~InputStream();
    InputStream(const InputStream&) = delete;
    InputStream& operator=(const InputStream&) = delete;

    /// For parsers that read the stream's buffer; formatted extraction would swallow errors.
    [[nodiscard]] std::istream& stream() { return stream_; }

  private:
    class Buffer;
    std::unique_ptr<Buffer> buffer_;
    std::istream stream_;
};

/// Reads the whole lines of a file, compressed or not, that may have been cut off anywhere.
class WholeLines {
  public:
    explicit WholeLines(const std::filesystem::path& path);
    ~WholeLines();
    WholeLines(const WholeLines&) = delete;
    WholeLines& operator=(const WholeLines&) = delete;

    /// The next one, with its end; empty after the last. Valid until the next call.
    [[nodiscard]] std::string_view next();

  private:
    static constexpr std::size_t kChunk = 1u << 18;
    struct File;
    std::unique_ptr<File> file_;
    std::string text_;
    std::size_t begin_ = 0; ///< of what is not given yet
};

} // namespace flotilla::io
