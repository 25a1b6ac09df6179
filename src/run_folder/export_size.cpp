// SPDX-License-Identifier: MIT
// Which frames an export writes, and about how much that is.
#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include <flotilla/error.hpp>

#include "mesh/placement.hpp"
#include "run_folder/drawn_mesh.hpp"
#include "run_folder/export.hpp"
#include "run_folder/poses_csv.hpp"

namespace flotilla::io {
namespace {

constexpr double kFloat = 11; // characters of a number in single precision, mostly, with its separator

/// Of numbers as text; Number is float where they are written in single precision.
template <class Number>
double characters(std::initializer_list<double> values) {
    char buffer[32];
    std::ptrdiff_t sum = 0;
    for (const double value : values)
        sum += std::to_chars(buffer, buffer + sizeof buffer, static_cast<Number>(value)).ptr - buffer;
    return static_cast<double>(sum);
}

/// The first frame, which may be a start where nothing moves yet, one in the middle, and the last, which may be a rest.
struct Samples {
    Samples(RunReader& run, const FrameRange& range) : count(io::count(range)) {
        for (const std::int64_t k : {std::int64_t{0}, count / 2, count - 1})
            frames.push_back(run.frame(range.first + k * range.every));
    }
    /// Of all frames, by the bytes of one.
    template <class BytesOf>
    [[nodiscard]] double sum(BytesOf&& bytes_of) const {
        if (count == 1) return bytes_of(frames[0]);
        return bytes_of(frames[0]) + static_cast<double>(count - 1) / 2 * (bytes_of(frames[1]) + bytes_of(frames[2]));
    }
    /// Whether not all of them are the same; value(frame) is written in single precision.
    template <class Value>
    [[nodiscard]] bool change(Value&& value) const {
        const auto differs = [&](const Frame& frame) { return value(frame) != value(frames[0]); };
        return std::any_of(frames.begin(), frames.end(), differs);
    }

    std::int64_t count;
    std::vector<Frame> frames;
};

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

Features of_bodies(const RunScene& scene) {
    Features all;
    for (const auto& body : scene.bodies) all.add(scene.shapes[static_cast<std::size_t>(body.shape)].mesh);
    return all;
}

// Bodies differ: what is fixed, sleeps or was never turned has few digits, anything else all that read back to the same
// number.

double csv_frame(const RunScene& scene, const Frame& frame) {
    std::vector<std::string> names;
    for (const auto& body : scene.bodies) names.push_back(body.name);
    return static_cast<double>(poses_csv_rows(frame, names).size());
}

/// Lines of vertices; some of each body, since a frame may hold millions.
double obj_vertices(const RunScene& scene, const Frame& frame) {
    constexpr std::size_t kLooks = 4;
    double sum = 0;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        if (frame.absent(i)) continue;
        const std::vector<Vec3>& vertices = scene.shapes[static_cast<std::size_t>(scene.bodies[i].shape)].mesh.vertices;
        const std::size_t looks = std::min(kLooks, vertices.size());
        for (std::size_t k = 0; k < looks; ++k) {
            std::array<Vec3, 1> world;
            world_vertices({&vertices[(2 * k + 1) * vertices.size() / (2 * looks)], 1}, frame.position[i],
                           frame.rotation[i], world);
            const double line = 5 + characters<double>({world[0].x, world[0].y, world[0].z});
            sum += line * static_cast<double>(vertices.size()) / static_cast<double>(looks);
        }
    }
    return sum;
}

double num_present(const Frame& frame) {
    double count = 0;
    for (std::size_t i = 0; i < frame.position.size(); ++i) count += frame.absent(i) ? 0 : 1;
    return count;
}

/// Five attributes: position, rotation twice, velocity, angular velocity.
double usd_frame(const Frame& frame) {
    double sum = 0;
    for (std::size_t i = 0; i < frame.position.size(); ++i) {
        const Vec3 &p = frame.position[i], &v = frame.velocity[i], &w = frame.angular_velocity[i];
        const Quat& q = frame.rotation[i];
        sum += 27 + characters<float>({p.x, p.y, p.z, v.x, v.y, v.z, w.x, w.y, w.z}) +
               2 * characters<float>({q.w, q.x, q.y, q.z});
    }
    return sum;
}

/// Three numbers of vertices each, as text.
double faces(const RunScene& scene, const Features& features) {
    const auto vertices = static_cast<std::int64_t>(of_bodies(scene).vertices);
    const auto digits = static_cast<double>(std::to_string(vertices).size());
    return features.triangles * (2 + 3 * (digits + 1));
}

/// A node in JSON for each body, and where its position or its rotation changes a track: JSON, and 4 bytes a number and
/// frame.
double glb_bodies(const Samples& samples) {
    constexpr double kNode = 60, kTrack = 260;
    const auto frames = static_cast<double>(samples.count);
    using Position = std::array<float, 3>;
    using Rotation = std::array<float, 4>;
    double sum = 0;
    for (std::size_t i = 0; i < samples.frames[0].position.size(); ++i) {
        const auto position = [i](const Frame& frame) {
            const Vec3& p = frame.position[i];
            return Position{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
        };
        const auto rotation = [i](const Frame& frame) {
            const Quat& q = frame.rotation[i];
            return Rotation{static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
                            static_cast<float>(q.z)};
        };
        sum += kNode;
        for (const float x : position(samples.frames[0])) sum += characters<double>({x});
        for (const float x : rotation(samples.frames[0])) sum += characters<double>({x});
        if (samples.change(position)) sum += kTrack + sizeof(Position) * frames;
        if (samples.change(rotation)) sum += kTrack + sizeof(Rotation) * frames;
    }
    return sum;
}

double bytes_of(const RunScene& scene, ExportFormat format, const Samples& samples) {
    const auto bodies = static_cast<double>(scene.bodies.size());
    Features shapes;
    for (const auto& shape : scene.shapes)
        shapes.add(format == ExportFormat::usd ? drawn_triangles(shape.mesh) : shape.mesh);
    switch (format) {
    case ExportFormat::csv: return samples.sum([&](const Frame& frame) { return csv_frame(scene, frame); });
    case ExportFormat::obj: {
        const double same = sum_names(scene) + 3 * bodies + faces(scene, of_bodies(scene));
        return samples.sum([&](const Frame& frame) { return same + obj_vertices(scene, frame); });
    }
    case ExportFormat::vtp: { // 22 numbers a body, three a vertex and four a triangle, of 8 bytes in base64, in XML
        constexpr double kBase64 = 8 * 4.0 / 3, kXml = 1500;
        return kBase64 * (3 * shapes.vertices + 4 * shapes.triangles) +
               samples.sum([](const Frame& frame) { return kXml + num_present(frame) * 22 * kBase64; });
    }
    case ExportFormat::glb: return sum_names(scene) + 12 * (shapes.vertices + shapes.triangles) + glb_bodies(samples);
    case ExportFormat::usd:
        return sum_names(scene) + 10 * bodies + shapes.vertices * 3 * kFloat + faces(scene, shapes) +
               samples.sum(usd_frame);
    }
    return 0;
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

std::uintmax_t export_bytes(RunReader& run, ExportFormat format, const FrameRange& range) {
    return static_cast<std::uintmax_t>(bytes_of(run.scene(), format, Samples(run, range)));
}

} // namespace flotilla::io
