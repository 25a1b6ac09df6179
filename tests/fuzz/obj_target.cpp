// SPDX-License-Identifier: MIT
// The reader of OBJ files.
#include "fuzz/checks.hpp"
#include "mesh/text_input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace flotilla;
    TriangleMesh mesh;
    const std::string text = fuzz::text_of(data, size);
    if (fuzz::accepted("mesh.obj", [&] { mesh = read_obj("mesh.obj", text); })) fuzz::check_mesh(mesh);
    return 0;
}
