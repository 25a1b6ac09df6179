// SPDX-License-Identifier: MIT
#include "io/image.hpp"

#include <fstream>
#include <system_error>

#include <png.h>

#include <flotilla/error.hpp>

namespace flotilla {
namespace {

std::vector<char> encode_png(const Image& image) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(image.width);
    header.height = static_cast<png_uint_32>(image.height);
    header.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = 0;
    if (png_image_write_to_memory(&header, nullptr, &size, 0, image.rgb.data(), 0, nullptr) == 0)
        throw IoError(std::string("PNG: ") + header.message);
    std::vector<char> bytes(size);
    if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0)
        throw IoError(std::string("PNG: ") + header.message);
    bytes.resize(size);
    return bytes;
}

} // namespace

void write_png(const std::filesystem::path& path, const Image& image) {
    const std::vector<char> bytes = encode_png(image);
    std::filesystem::path aside = path;
    aside += ".part";
    {
        std::ofstream file(aside, std::ios::binary);
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        file.close();
        if (!file) {
            std::error_code ignored;
            std::filesystem::remove(aside, ignored);
            throw IoError(path.string() + ": cannot be written");
        }
    }
    std::error_code error;
    std::filesystem::rename(aside, path, error);
    if (error) {
        std::error_code ignored;
        std::filesystem::remove(aside, ignored);
        throw IoError(path.string() + ": " + error.message());
    }
}

} // namespace flotilla
