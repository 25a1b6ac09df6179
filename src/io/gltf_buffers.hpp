// SPDX-License-Identifier: MIT
// The arrays of a glTF file: buffers, the views into them and the accessors that give them types.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <flotilla/types.hpp>

#include "io/json_document.hpp"

namespace flotilla::io {

/// Refuses the file: "path: /accessors/3: reason".
[[noreturn]] void refuse_gltf(const std::filesystem::path& path, const std::string& where, const std::string& reason);

/// A whole number that says how many, where or which; `otherwise` where the object has none. Refuses what is none or
/// beyond `most`.
[[nodiscard]] std::uint64_t gltf_number(const std::filesystem::path& path, const Json& object, const std::string& where,
                                        const char* key, std::uint64_t otherwise, std::uint64_t most);

class GltfBuffers {
  public:
    /// `binary`: the chunk of a .glb that is its first buffer. All of them must outlive this.
    GltfBuffers(const std::filesystem::path& path, const Json& document, std::string_view binary)
        : path_(path), document_(document), binary_(binary) {}

    /// How many elements an accessor says it has, once it was found to be good: triples of floats, or vertex numbers.
    [[nodiscard]] std::uint64_t count_positions(std::uint64_t accessor);
    [[nodiscard]] std::uint64_t count_indices(std::uint64_t accessor);

    [[nodiscard]] std::vector<Vec3> positions(std::uint64_t accessor);
    [[nodiscard]] std::vector<std::uint32_t> indices(std::uint64_t accessor);

  private:
    /// Bytes of the elements; element i starts at i * stride.
    struct Elements {
        std::string_view bytes;
        std::uint64_t count = 0, stride = 0;
        std::uint64_t component = 0; ///< type, a number of OpenGL's
        std::string where;
    };
    [[nodiscard]] Elements elements(std::uint64_t accessor, std::string_view type);
    [[nodiscard]] Elements position_elements(std::uint64_t accessor);
    [[nodiscard]] Elements index_elements(std::uint64_t accessor);
    [[nodiscard]] std::string_view view(std::uint64_t index, std::uint64_t& stride);
    [[nodiscard]] std::string_view buffer(std::uint64_t index);
    [[nodiscard]] std::string read_buffer(const std::string& uri, std::uint64_t bytes, const std::string& where) const;
    [[nodiscard]] const Json& entry(const char* list, std::uint64_t index, const std::string& asked_at) const;

    const std::filesystem::path& path_;
    const Json& document_;
    std::string_view binary_;
    std::vector<std::pair<std::uint64_t, std::string>> read_; ///< buffers that came from outside, by index
};

} // namespace flotilla::io
