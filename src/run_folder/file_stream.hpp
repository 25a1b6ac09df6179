// SPDX-License-Identifier: MIT
// Large text files in one pass, written or read through a buffer; gzip where the name ends with .gz.
#pragma once

#include <filesystem>
#include <istream>
#include <memory>
#include <string>
#include <string_view>

#include "io/file.hpp"

namespace flotilla::io {

/// Writes an OutputFile. Without close() nothing is left behind.
class OutputStream {
  public:
    explicit OutputStream(const std::filesystem::path& path);
    ~OutputStream();
    OutputStream(const OutputStream&) = delete;
    OutputStream& operator=(const OutputStream&) = delete;

    void write(std::string_view text) {
        buffer_ += text;
        if (buffer_.size() >= kBuffer) flush(false);
    }
    void close();

  private:
    static constexpr std::size_t kBuffer = 1u << 18;
    struct Deflate;

    void flush(bool last);

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

} // namespace flotilla::io
