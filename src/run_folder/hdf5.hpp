// SPDX-License-Identifier: MIT
// HDF5 files as byte images. HDF5 builds and reads images in memory only; the bytes go through io/file, so that a full
// disk or an interrupted write is one kind of failure with one kind of message, and HDF5 never holds a file open.
// HDF5 itself is not safe against damaged files: with bits flipped in its metadata it crashes or never returns. So a
// trailer behind the image, which HDF5 tools ignore, holds a checksum, and a file that does not match never reaches
// HDF5. Datasets whose owner checks each row itself can be left out of it, so that damage there costs the row and not
// the file. Debian's library is not thread-safe: every call here holds one lock of the process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flotilla::io {

/// Bytes [begin, begin + size) of an image.
struct ByteRange {
    std::uint64_t begin = 0, size = 0;
};

/// Builds an image. Element types: double, int64_t, int32_t, uint64_t, uint16_t, uint8_t.
class Hdf5Writer {
  public:
    Hdf5Writer();
    ~Hdf5Writer();
    Hdf5Writer(const Hdf5Writer&) = delete;
    Hdf5Writer& operator=(const Hdf5Writer&) = delete;

    void create_group(const std::string& name);
    enum class Checked {
        by_file,  ///< a flipped bit makes the file unreadable
        by_owner, ///< a flipped bit is not seen here
    };
    /// A contiguous dataset. Precondition: values.size() is the product of `shape`.
    template <typename T>
    void write(const std::string& name, std::span<const T> values, std::initializer_list<std::size_t> shape,
               Checked checked = Checked::by_file);
    /// UTF-8, without zero characters.
    void write_strings(const std::string& name, const std::vector<std::string>& values);
    /// Attributes of the file ("/"), a group or a dataset.
    void attribute(const std::string& object, const std::string& name, std::int64_t value);
    void attribute(const std::string& object, const std::string& name, const std::string& value);

    /// Closes the image and returns the file's bytes.
    [[nodiscard]] std::vector<std::byte> finish();

  private:
    struct Memory;
    std::unique_ptr<Memory> memory_;
    std::vector<ByteRange> unchecked_;
    std::int64_t file_;
};

/// Reads an image. Whatever does not fit is an IoError "<path>: ...".
class Hdf5Reader {
  public:
    explicit Hdf5Reader(const std::filesystem::path& path);
    ~Hdf5Reader();
    Hdf5Reader(const Hdf5Reader&) = delete;
    Hdf5Reader& operator=(const Hdf5Reader&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] bool has(const std::string& name) const;
    [[nodiscard]] std::vector<std::size_t> shape(const std::string& name) const;
    /// The whole dataset, row-major.
    template <typename T>
    [[nodiscard]] std::vector<T> read(const std::string& name) const;
    /// Row `row` along the first dimension. Precondition: values.size() is the size of one row.
    template <typename T>
    void read_row(const std::string& name, std::size_t row, std::span<T> values) const;
    [[nodiscard]] std::vector<std::string> read_strings(const std::string& name) const;
    [[nodiscard]] std::int64_t int_attribute(const std::string& object, const std::string& name) const;
    [[nodiscard]] std::string string_attribute(const std::string& object, const std::string& name) const;

  private:
    std::filesystem::path path_;
    std::int64_t file_;
};

} // namespace flotilla::io
