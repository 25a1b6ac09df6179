// SPDX-License-Identifier: MIT
#include "run_folder/file_stream.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <streambuf>
#include <system_error>
#include <vector>

#include <zlib.h>

#include <flotilla/error.hpp>

namespace flotilla::io {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, std::string_view action, const std::string& reason) {
    throw IoError(path.string() + ": cannot " + std::string(action) + ": " + reason);
}

} // namespace

struct OutputStream::Deflate {
    explicit Deflate(const fs::path& path) {
        constexpr int kGzip = 15 + 16; // the largest window, gzip header
        if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK)
            fail(path, "compress", "out of memory");
    }
    ~Deflate() { deflateEnd(&stream); }
    Deflate(const Deflate&) = delete;
    Deflate& operator=(const Deflate&) = delete;

    z_stream stream{};
    std::vector<char> out = std::vector<char>(kBuffer);
};

OutputStream::OutputStream(const fs::path& path) : file_(path) {
    if (path.extension() == ".gz") deflate_ = std::make_unique<Deflate>(path);
    buffer_.reserve(2 * kBuffer);
}

OutputStream::~OutputStream() = default;

void OutputStream::drain(Drain what) {
    if (!deflate_) {
        file_.append(buffer_);
    } else {
        z_stream& z = deflate_->stream;
        const int mode = what == Drain::last ? Z_FINISH : what == Drain::all ? Z_SYNC_FLUSH : Z_NO_FLUSH;
        z.next_in = reinterpret_cast<Bytef*>(buffer_.data());
        z.avail_in = static_cast<uInt>(buffer_.size());
        do {
            z.next_out = reinterpret_cast<Bytef*>(deflate_->out.data());
            z.avail_out = static_cast<uInt>(deflate_->out.size());
            deflate(&z, mode);
            file_.append({deflate_->out.data(), deflate_->out.size() - z.avail_out});
        } while (z.avail_out == 0);
    }
    buffer_.clear();
}

void OutputStream::close() {
    drain(Drain::last);
    file_.close();
}

class InputStream::Buffer : public std::streambuf {
  public:
    explicit Buffer(const fs::path& path) : path_(path), file_(gzopen(path.c_str(), "rb")) {
        if (file_ == nullptr) fail(path, "open", std::error_code(errno, std::generic_category()).message());
        gzbuffer(file_, 1u << 17);
    }
    ~Buffer() override { gzclose(file_); }

  protected:
    int_type underflow() override {
        const int n = gzread(file_, data_.data(), static_cast<unsigned>(data_.size()));
        int error = Z_OK;
        const char* message = gzerror(file_, &error);
        // A file that ends too early is reported with its last bytes.
        if (n < 0 || (error != Z_OK && error != Z_STREAM_END))
            fail(path_, "read",
                 error == Z_ERRNO ? std::error_code(errno, std::generic_category()).message() : std::string(message));
        if (n == 0) return traits_type::eof();
        setg(data_.data(), data_.data(), data_.data() + n);
        return traits_type::to_int_type(data_[0]);
    }

  private:
    fs::path path_;
    gzFile file_;
    std::array<char, 1u << 18> data_{};
};

struct WholeLines::File {
    explicit File(const fs::path& path) : file(gzopen(path.c_str(), "rb")) {
        if (file == nullptr) fail(path, "open", std::error_code(errno, std::generic_category()).message());
    }
    ~File() { gzclose(file); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    gzFile file;
};

WholeLines::WholeLines(const fs::path& path) : file_(std::make_unique<File>(path)) {}
WholeLines::~WholeLines() = default;

std::string_view WholeLines::next() {
    std::size_t searched = begin_, end = 0;
    while ((end = text_.find('\n', searched)) == std::string::npos) {
        text_.erase(0, begin_);
        begin_ = 0;
        searched = text_.size();
        text_.resize(searched + kChunk);
        // Before the error of a file that ends too early or is damaged comes what can be read of it.
        const int n = gzread(file_->file, text_.data() + searched, kChunk);
        text_.resize(searched + static_cast<std::size_t>(std::max(n, 0)));
        if (n <= 0) return {};
    }
    const std::string_view line(text_.data() + begin_, end + 1 - begin_);
    begin_ = end + 1;
    return line;
}

InputStream::InputStream(const fs::path& path) : buffer_(std::make_unique<Buffer>(path)), stream_(buffer_.get()) {}
InputStream::~InputStream() = default;

} // namespace flotilla::io
