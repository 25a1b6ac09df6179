// SPDX-License-Identifier: MIT
// Which frames an export writes, and about how much that is.
#include <algorithm>
#include <string>

#include <flotilla/error.hpp>

#include "io/export.hpp"

namespace flotilla::io {
namespace {

/// Of an export.
struct Bytes {
    double once = 0, per_frame = 0;
};

// Text has as many digits as read back to the same number: 17 to 19 with sign, point and separator, 11 in single precision.
constexpr double kDouble = 18.5, kFloat = 11;

double sum_names(const RunScene& scene) {
    double sum = 0;
    for (const auto& body : scene.bodies) sum += static_cast<double>(body.name.size());
    return sum;
}

/// Of shapes, or of all bodies.
struct Features {
    double vertices = 0, triangles = 0;
    void add(const TriangleMesh& mesh) {
        vertices += static_cast<double>(mesh.vertices.size());
        triangles += static_cast<double>(mesh.triangles.size());
    }
};

Bytes bytes_of(const RunScene& scene, ExportFormat format) {
    const auto bodies = static_cast<double>(scene.bodies.size());
    const auto dynamic = static_cast<double>(std::count_if(
        scene.bodies.begin(), scene.bodies.end(), [](const RunBody& b) { return b.type == BodyType::dynamic; }));
    Features shapes, all;
    for (const auto& shape : scene.shapes) shapes.add(shape.mesh);
    for (const auto& body : scene.bodies) all.add(scene.shapes[static_cast<std::size_t>(body.shape)].mesh);
    const double digits = static_cast<double>(std::to_string(static_cast<std::int64_t>(all.vertices)).size());
    switch (format) {
    case ExportFormat::csv:
        return {0, sum_names(scene) + bodies * 20 + 13 * (kDouble * dynamic + 2 * (bodies - dynamic))};
    case ExportFormat::obj:
        return {0, sum_names(scene) + 3 * bodies + all.vertices * (2 + 3 * kDouble) +
                       all.triangles * (2 + 3 * (digits + 1))};
    case ExportFormat::vtp: { // 22 numbers a body, three a vertex and four a triangle, of 8 bytes in base64, in XML
        constexpr double kBase64 = 8 * 4.0 / 3, kXml = 1500;
        return {kBase64 * (3 * shapes.vertices + 4 * shapes.triangles), kXml + bodies * 22 * kBase64};
    }
    case ExportFormat::glb: // JSON of a body's node and its two tracks; 7 numbers of 4 bytes a frame
        return {sum_names(scene) + 700 * bodies + 12 * (shapes.vertices + shapes.triangles), 28 * bodies};
    case ExportFormat::usd: // five attributes of 17 numbers; those of fixed bodies are mostly 0
        return {sum_names(scene) + 10 * bodies + shapes.vertices * 3 * kFloat +
                    shapes.triangles * (2 + 3 * (digits + 1)),
                10 * bodies + 17 * (kFloat * dynamic + 2 * (bodies - dynamic))};
    }
    return {};
}

} // namespace

FrameRange frames_of(const RunReader& run, const FrameRange& range) {
    const std::string of_run =
        run.frames() == 0 ? "it has none yet" : "it has 0 to " + std::to_string(run.frames() - 1);
    const std::int64_t last = std::min(range.last, run.frames() - 1);
    if (range.first < 0 || range.first > last || range.every < 1)
        throw InputError(run.folder().string() + ": the run has no frame to export; " + of_run);
    return {range.first, last - (last - range.first) % range.every, range.every};
}

std::uintmax_t export_bytes(const RunScene& scene, ExportFormat format, std::int64_t frames) {
    const Bytes bytes = bytes_of(scene, format);
    return static_cast<std::uintmax_t>(bytes.once + bytes.per_frame * static_cast<double>(frames));
}

} // namespace flotilla::io
