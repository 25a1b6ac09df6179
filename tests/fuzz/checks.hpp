// SPDX-License-Identifier: MIT
// What the fuzz targets ask of what was read. A target is a function of bytes: input that a reader refuses with a
// documented exception is in order, and everything else must hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include <flotilla/error.hpp>
#include <flotilla/scene.hpp>
#include <flotilla/verify.hpp>

#include "mesh/triangle_mesh.hpp"

/// The entry of a target, as libFuzzer calls it; replay.cpp feeds it with files.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace flotilla::fuzz {

/// Ends the process where `ok` is false: a finding.
void require(bool ok, const std::string& what);

/// False where `read` refuses, which must say why and name the source.
template <class Read>
bool accepted(std::string_view source, Read&& read) {
    try {
        std::forward<Read>(read)();
        return true;
    } catch (const InputError& error) {
        require(std::string_view(error.what()).find(source) != std::string_view::npos, "a refusal names its source");
    } catch (const IoError& error) {
        require(std::string_view(error.what()).find(source) != std::string_view::npos, "a refusal names its file");
    }
    return false;
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

inline VerifyOptions one_thread() {
    VerifyOptions options;
    options.threads = 1;
    return options;
}

/// A folder of this process, the same in every call; removed at the end.
const std::filesystem::path& scratch();
/// Writes a file there, without waiting for the disk.
std::filesystem::path write_scratch(const std::string& name, std::string_view content);

/// The same numbers in the same places, bit for bit.
bool same_meshes(const TriangleMesh& a, const TriangleMesh& b);

/// What write_scene writes of `scene`.
std::string written(const SceneDescription& scene);

/// A few steps of a scene that was accepted, where it is small; limits of loops are cut for it. Every promise must
/// hold.
void check_steps(SceneDescription scene, int steps);

/// A mesh that a reader accepted: whole, the same after a way through a scene file, and fit for a step of two of it.
void check_mesh(const TriangleMesh& mesh);

} // namespace flotilla::fuzz
