// SPDX-License-Identifier: MIT
#include "picture/image.hpp"

#include <cstddef>
#include <string>

#include <png.h>

#include <flotilla/error.hpp>

#include "io/file.hpp"

namespace flotilla {
namespace {

std::vector<std::byte> encode_png(const Image& image) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(image.width);
    header.height = static_cast<png_uint_32>(image.height);
    header.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = 0;
    if (png_image_write_to_memory(&header, nullptr, &size, 0, image.rgb.data(), 0, nullptr) == 0)
        throw IoError(std::string("PNG: ") + header.message);
    std::vector<std::byte> bytes(size);
    if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0)
        throw IoError(std::string("PNG: ") + header.message);
    bytes.resize(size);
    return bytes;
}

} // namespace

void write_png(const std::filesystem::path& path, const Image& image) { io::write_file(path, encode_png(image)); }

} // namespace flotilla
