// SPDX-License-Identifier: MIT
#include <flotilla/picture.hpp>

#include <string>
#include <system_error>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "base/floating_point.hpp"
#include "picture/render.hpp"
#include "run_folder/run_folder.hpp"

namespace flotilla {
namespace {

PictureBody picture_body(const TriangleMesh& mesh, std::size_t index, BodyType type, const Vec3& position,
                         const Quat& rotation) {
    return {.mesh = &mesh,
            .position = position,
            .rotation = rotation,
            .fixed = type != BodyType::dynamic,
            .colour = static_cast<std::uint32_t>(index)};
}

std::vector<PictureBody> bodies_of(const io::RunScene& scene, const io::Frame& frame) {
    std::vector<PictureBody> bodies;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        if (frame.absent(i)) continue;
        const TriangleMesh& mesh = scene.shapes.at(static_cast<std::size_t>(scene.bodies[i].shape)).mesh;
        bodies.push_back(picture_body(mesh, i, scene.bodies[i].type, frame.position.at(i), frame.rotation.at(i)));
    }
    return bodies;
}

PictureReport write_frame(const std::filesystem::path& folder, const std::filesystem::path& output,
                          const PictureOptions& options, std::optional<std::int64_t> frame_wanted) {
    io::RunReader run(folder);
    if (run.frames() == 0) throw InputError(folder.string() + ": there is no frame yet");
    const std::int64_t k = frame_wanted.value_or(run.frames() - 1), seen = options.camera_frame.value_or(k);
    for (const std::int64_t wanted : {k, seen})
        if (wanted < 0 || wanted >= run.frames())
            throw InputError(folder.string() + ": there is no frame " + std::to_string(wanted) +
                             "; the run has frames 0 to " + std::to_string(run.frames() - 1));
    const io::Frame frame = run.frame(k);
    const std::vector<PictureBody> bodies = bodies_of(run.scene(), frame);
    write_png(output,
              seen == k ? render(bodies, options) : render(bodies, bodies_of(run.scene(), run.frame(seen)), options));
    return {.frame = k, .frames = run.frames(), .time = frame.time, .bodies = bodies.size()};
}

PictureReport write_initial_state(const std::filesystem::path& file, const std::filesystem::path& output,
                                  const PictureOptions& options, std::optional<std::int64_t> frame_wanted) {
    if (frame_wanted.value_or(0) != 0 || options.camera_frame.value_or(0) != 0)
        throw InputError(file.string() + ": a scene has no frame but its initial state, frame 0");
    const SceneDescription scene = read_scene(file);
    std::vector<TriangleMesh> meshes;
    for (const ShapeDescription& shape : scene.shapes) meshes.push_back({shape.vertices, shape.triangles});
    std::vector<PictureBody> bodies;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyDescription& body = scene.bodies[i];
        bodies.push_back(
            picture_body(meshes.at(static_cast<std::size_t>(body.shape)), i, body.type, body.position, body.rotation));
    }
    write_png(output, render(bodies, options));
    return {.frame = 0, .frames = 1, .time = 0, .bodies = bodies.size()};
}

} // namespace

PictureReport write_picture(const std::filesystem::path& source, const std::filesystem::path& output,
                            const PictureOptions& options, std::optional<std::int64_t> frame) {
    const DefaultFloatingPoint environment;
    std::error_code error; // reading names it
    return std::filesystem::is_directory(source, error) ? write_frame(source, output, options, frame)
                                                        : write_initial_state(source, output, options, frame);
}

} // namespace flotilla
