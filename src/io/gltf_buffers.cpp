// SPDX-License-Identifier: MIT
#include "io/gltf_buffers.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>

#include <flotilla/error.hpp>

#include "base/text.hpp"
#include "io/base64.hpp"

namespace flotilla::io {

static_assert(std::endian::native == std::endian::little,
              "glTF's numbers are little-endian and are copied as they stand");

namespace {

constexpr std::uint64_t kUnsignedByte = 5121, kUnsignedShort = 5123, kUnsignedInt = 5125,
                        kFloat = 5126;                       // OpenGL's numbers
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 40; // sums of a few such numbers cannot overflow
constexpr std::uint64_t kMostStride = 252;                   // the specification's

std::uint64_t size_of(std::uint64_t component) {
    switch (component) {
    case kUnsignedByte: return 1;
    case kUnsignedShort: return 2;
    default: return 4;
    }
}

/// A file's name out of a URI (RFC 3986): "my%20file.bin".
std::optional<std::string> without_percents(std::string_view uri) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    const auto digit = [&](char c) {
        return kDigits.find(c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c);
    };
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            name += uri[i];
            continue;
        }
        if (i + 2 >= uri.size() || digit(uri[i + 1]) > 15 || digit(uri[i + 2]) > 15) return std::nullopt;
        name += static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]));
        i += 2;
    }
    return name;
}

/// The first `bytes` of a file that has as many: neither devices nor pipes, which may have no end.
std::string first_bytes(const std::filesystem::path& file, std::uint64_t bytes) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
        throw IoError("cannot read " + file.string() + ": " + (error ? error.message() : "no file of bytes"));
    if (std::filesystem::file_size(file) < bytes)
        throw IoError("cannot read " + file.string() + ": it is shorter than the " + std::to_string(bytes) +
                      " bytes of its buffer");
    std::string data(bytes, '\0');
    std::ifstream in(file, std::ios::binary);
    if (!in.read(data.data(), static_cast<std::streamsize>(bytes))) throw IoError("cannot read " + file.string());
    return data;
}

} // namespace

void refuse_gltf(const std::filesystem::path& path, const std::string& where, const std::string& reason) {
    throw InputError(path.string() + ": " + (where.empty() ? "" : where + ": ") + reason);
}

std::uint64_t gltf_number(const std::filesystem::path& path, const Json& object, const std::string& where,
                          const char* key, std::uint64_t otherwise, std::uint64_t most) {
    const auto found = object.find(key);
    if (found == object.end()) return otherwise;
    const std::string at = where + "/" + key;
    if (!found->is_number_unsigned()) refuse_gltf(path, at, "must be a whole number from 0, got " + kind_of(*found));
    const auto value = found->get<std::uint64_t>();
    if (value > most)
        refuse_gltf(path, at, "must be at most " + std::to_string(most) + ", got " + std::to_string(value));
    return value;
}

const Json& GltfBuffers::entry(const char* list, std::uint64_t index, const std::string& asked_at) const {
    const auto found = document_.find(list);
    const std::uint64_t count = found != document_.end() && found->is_array() ? found->size() : 0;
    if (index >= count)
        refuse_gltf(path_, asked_at,
                    "names /" + std::string(list) + "/" + std::to_string(index) + ", there are " +
                        std::to_string(count));
    const Json& value = (*found)[index];
    if (!value.is_object())
        refuse_gltf(path_, "/" + std::string(list) + "/" + std::to_string(index),
                    "must be an object, got " + kind_of(value));
    return value;
}

std::string GltfBuffers::read_buffer(const std::string& uri, std::uint64_t bytes, const std::string& where) const {
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(',');
        if (comma == std::string::npos || !std::string_view(uri).substr(0, comma).ends_with(";base64"))
            refuse_gltf(path_, where, "must be a data URI in base64, or a file");
        std::optional<std::string> data = from_base64(std::string_view(uri).substr(comma + 1));
        if (!data) refuse_gltf(path_, where, "malformed base64");
        return std::move(*data);
    }
    const std::optional<std::string> name = without_percents(uri);
    if (!name || uri.find("://") != std::string::npos)
        refuse_gltf(path_, where, "must be a data URI in base64, or a file");
    try {
        return first_bytes(path_.parent_path() / *name, bytes);
    } catch (const IoError& error) {
        refuse_gltf(path_, where, error.what());
    }
}

std::string_view GltfBuffers::buffer(std::uint64_t index) {
    const std::string where = "/buffers/" + std::to_string(index);
    const Json& json = entry("buffers", index, where);
    const std::uint64_t bytes = gltf_number(path_, json, where, "byteLength", 0, kMostBytes);
    const auto uri = json.find("uri");
    std::string_view data = binary_;
    if (uri == json.end()) {
        if (index != 0 || binary_.data() == nullptr) refuse_gltf(path_, where + "/uri", "is missing");
    } else {
        if (!uri->is_string()) refuse_gltf(path_, where + "/uri", "must be a string, got " + kind_of(*uri));
        auto known = std::find_if(read_.begin(), read_.end(), [&](const auto& one) { return one.first == index; });
        if (known == read_.end())
            known = read_.insert(read_.end(),
                                 {index, read_buffer(uri->get_ref<const std::string&>(), bytes, where + "/uri")});
        data = known->second;
    }
    if (data.size() < bytes)
        refuse_gltf(path_, where + "/byteLength",
                    "says " + std::to_string(bytes) + " bytes, there are " + std::to_string(data.size()));
    return data.substr(0, bytes);
}

std::string_view GltfBuffers::view(std::uint64_t index, std::uint64_t& stride) {
    const std::string where = "/bufferViews/" + std::to_string(index);
    const Json& json = entry("bufferViews", index, where);
    const std::uint64_t offset = gltf_number(path_, json, where, "byteOffset", 0, kMostBytes);
    const std::uint64_t length = gltf_number(path_, json, where, "byteLength", 0, kMostBytes);
    stride = gltf_number(path_, json, where, "byteStride", stride, kMostStride);
    const std::uint64_t of = gltf_number(path_, json, where, "buffer", kMostBytes, kMostBytes);
    if (of == kMostBytes) refuse_gltf(path_, where + "/buffer", "is missing");
    const std::string_view bytes = buffer(of);
    if (offset + length > bytes.size())
        refuse_gltf(path_, where,
                    "ends at byte " + std::to_string(offset + length) + " of a buffer of " +
                        std::to_string(bytes.size()));
    return bytes.substr(offset, length);
}

GltfBuffers::Elements GltfBuffers::elements(std::uint64_t accessor, std::string_view type) {
    Elements e;
    e.where = "/accessors/" + std::to_string(accessor);
    const Json& json = entry("accessors", accessor, e.where);
    const auto kind = json.find("type");
    if (kind == json.end() || *kind != type) refuse_gltf(path_, e.where + "/type", "must be " + std::string(type));
    if (json.contains("sparse")) refuse_gltf(path_, e.where + "/sparse", "is not supported");
    e.component = gltf_number(path_, json, e.where, "componentType", 0, kFloat);
    e.count = gltf_number(path_, json, e.where, "count", 0, kMostBytes);
    const std::uint64_t size = size_of(e.component) * (type == "VEC3" ? 3 : 1);
    const std::uint64_t offset = gltf_number(path_, json, e.where, "byteOffset", 0, kMostBytes);
    const std::uint64_t of = gltf_number(path_, json, e.where, "bufferView", kMostBytes, kMostBytes);
    if (of == kMostBytes) refuse_gltf(path_, e.where + "/bufferView", "is missing");
    e.stride = size;
    const std::string_view bytes = view(of, e.stride);
    if (e.stride < size) refuse_gltf(path_, e.where, "its elements of " + std::to_string(size) + " bytes overlap");
    // count <= 2^40 and stride <= 252: no overflow.
    const std::uint64_t end = e.count == 0 ? offset : offset + (e.count - 1) * e.stride + size;
    if (end > bytes.size())
        refuse_gltf(path_, e.where,
                    "ends at byte " + std::to_string(end) + " of a view of " + std::to_string(bytes.size()));
    e.bytes = bytes.substr(offset);
    return e;
}

GltfBuffers::Elements GltfBuffers::position_elements(std::uint64_t accessor) {
    Elements e = elements(accessor, "VEC3");
    if (e.component != kFloat) refuse_gltf(path_, e.where + "/componentType", "must be 5126, floats");
    return e;
}

GltfBuffers::Elements GltfBuffers::index_elements(std::uint64_t accessor) {
    Elements e = elements(accessor, "SCALAR");
    if (e.component != kUnsignedByte && e.component != kUnsignedShort && e.component != kUnsignedInt)
        refuse_gltf(path_, e.where + "/componentType", "must be 5121, 5123 or 5125, unsigned integers");
    return e;
}

std::uint64_t GltfBuffers::count_positions(std::uint64_t accessor) { return position_elements(accessor).count; }
std::uint64_t GltfBuffers::count_indices(std::uint64_t accessor) { return index_elements(accessor).count; }

std::vector<Vec3> GltfBuffers::positions(std::uint64_t accessor) {
    const Elements e = position_elements(accessor);
    std::vector<Vec3> list(e.count);
    for (std::uint64_t i = 0; i < e.count; ++i) {
        float x[3];
        std::memcpy(x, e.bytes.data() + i * e.stride, sizeof x);
        if (!std::isfinite(x[0]) || !std::isfinite(x[1]) || !std::isfinite(x[2]))
            refuse_gltf(path_, e.where, "position " + std::to_string(i) + " is not finite");
        list[i] = {double{x[0]}, double{x[1]}, double{x[2]}};
    }
    return list;
}

std::vector<std::uint32_t> GltfBuffers::indices(std::uint64_t accessor) {
    const Elements e = index_elements(accessor);
    std::vector<std::uint32_t> list(e.count);
    for (std::uint64_t i = 0; i < e.count; ++i)
        std::memcpy(&list[i], e.bytes.data() + i * e.stride, size_of(e.component));
    return list;
}

} // namespace flotilla::io
