// SPDX-License-Identifier: MIT
// The reader of glTF files, both forms. What stands before the first line break is the name of a node.
#include "fuzz/checks.hpp"
#include "io/read_gltf.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace flotilla;
    const std::string text = fuzz::text_of(data, size);
    const std::size_t end = text.find('\n');
    if (end == std::string::npos) return 0;
    const std::string node = text.substr(0, end), file = text.substr(end + 1);
    TriangleMesh mesh;
    // No file lies in the folder that buffers are looked for in.
    const std::filesystem::path path = fuzz::scratch() / "none" / "mesh.gltf";
    if (fuzz::accepted("mesh.gltf", [&] { mesh = io::read_gltf(path, file, node); })) fuzz::check_mesh(mesh);
    return 0;
}
