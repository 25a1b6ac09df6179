// SPDX-License-Identifier: MIT
// The reader of STL files.
#include "fuzz/checks.hpp"
#include "mesh/text_input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace flotilla;
    TriangleMesh mesh;
    const std::string text = fuzz::text_of(data, size);
    if (fuzz::accepted("mesh.stl", [&] { mesh = read_stl("mesh.stl", text); })) fuzz::check_mesh(mesh);
    return 0;
}
