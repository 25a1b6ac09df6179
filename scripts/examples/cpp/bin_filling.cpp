// SPDX-License-Identifier: MIT
// Plates without thickness fall into a bin; prints where they lie, as CSV, and proves the whole fall.
// usage: bin_filling PLATES FOLDER
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <flotilla/error.hpp>
#include <flotilla/picture.hpp>
#include <flotilla/run.hpp>
#include <flotilla/run_folder.hpp>
#include <flotilla/verify.hpp>

namespace {

constexpr double kPlate = 0.1, kBin = 0.25, kHeight = 0.2; // m

flotilla::ShapeDescription plate() {
    return {.name = "plate",
            .vertices = {{0, 0, 0}, {kPlate, 0, 0}, {kPlate, kPlate, 0}, {0, kPlate, 0}},
            .triangles = {{0, 1, 2}, {0, 2, 3}},
            .mass_kind = flotilla::MassKind::surface_density,
            .mass_value = 5};
}

flotilla::ShapeDescription bin() {
    return {.name = "bin",
            .vertices = {{0, 0, 0},
                         {kBin, 0, 0},
                         {kBin, kBin, 0},
                         {0, kBin, 0},
                         {0, 0, kHeight},
                         {kBin, 0, kHeight},
                         {kBin, kBin, kHeight},
                         {0, kBin, kHeight}},
            .triangles = {{0, 1, 2},
                          {0, 2, 3},
                          {0, 1, 5},
                          {0, 5, 4},
                          {1, 2, 6},
                          {1, 6, 5},
                          {2, 3, 7},
                          {2, 7, 6},
                          {3, 0, 4},
                          {3, 4, 7}}};
}

/// Plates above each other, each a little turned and aside, so that they do not fall as a stack.
flotilla::SceneDescription make_scene(int plates) {
    flotilla::SceneDescription scene;
    scene.shapes = {bin(), plate()};
    scene.bodies.push_back({.name = "bin", .shape = 0, .type = flotilla::BodyType::fixed});
    for (int k = 0; k < plates; ++k) {
        flotilla::BodyDescription body{.name = "plate" + std::to_string(k), .shape = 1};
        body.position = {0.03 + 0.02 * (k % 5), 0.03 + 0.03 * (k % 3), 0.05 + 0.1 * k};
        body.rotation = {0.96, 0.28, 0, 0}; // 33 degrees about x
        body.angular_velocity = {0.5 * (k % 4), 0.7 * (k % 3), 0};
        scene.bodies.push_back(body);
    }
    return scene;
}

int fill(int plates, const std::filesystem::path& folder) {
    flotilla::RunOptions options;
    options.output = folder;
    options.overwrite = true;
    options.steps = 24 * 3;
    const flotilla::RunTotals totals = flotilla::run_scene(make_scene(plates), "bin", options);
    const flotilla::RunFrames last = flotilla::read_frames(folder, {.first = totals.last.step});
    std::printf("name,x,y,z\n");
    for (std::size_t i = 0; i < last.bodies.size(); ++i)
        std::printf("%s,%.6f,%.6f,%.6f\n", last.bodies[i].c_str(), last.position[i].x, last.position[i].y,
                    last.position[i].z);
    flotilla::write_picture(folder, folder / "end.png", {.width = 400, .height = 300});
    const flotilla::VerifyReport proof = flotilla::verify_run(folder);
    std::fprintf(stderr, "%ld frames %s\n", static_cast<long>(proof.frames), proof.proved() ? "proved" : "NOT PROVED");
    return proof.proved() ? 0 : 1;
}

} // namespace

int main(int count, char** arguments) {
    if (count != 3) {
        std::fprintf(stderr, "usage: bin_filling PLATES FOLDER\n");
        return 2;
    }
    try {
        return fill(std::atoi(arguments[1]), arguments[2]);
    } catch (const flotilla::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
