// SPDX-License-Identifier: MIT
// Binary glTF 2.0 (Khronos specification): a JSON chunk that describes and a binary chunk that holds the arrays.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include <flotilla/error.hpp>

#include "base/rotation.hpp"
#include "run_folder/body_colour.hpp"
#include "run_folder/export.hpp"
#include "run_folder/frames_in_order.hpp"
#include "run_folder/held_poses.hpp"

namespace flotilla::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFloat = 5126, kUnsignedInt = 5125; // component types
constexpr int kVertexArray = 34962, kIndexArray = 34963;
constexpr std::uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

/// The file under construction.
class Glb {
  public:
    Json json;

    /// Appends values to the binary chunk; returns the accessor's index. `type` is SCALAR, VEC3 or VEC4, `target` 0 for
    /// data that is no vertex attribute. Minimum and maximum are written where the specification wants them.
    template <typename T>
    std::size_t add(std::span<const T> values, const std::string& type, int target, bool bounds) {
        const std::size_t width = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : 4;
        Json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", values.size_bytes()}};
        if (target != 0) view["target"] = target;
        json["bufferViews"].push_back(std::move(view));
        const auto bytes = std::as_bytes(values);
        binary_.insert(binary_.end(), bytes.begin(), bytes.end());
        Json accessor{{"bufferView", json["bufferViews"].size() - 1},
                      {"componentType", std::is_same_v<T, float> ? kFloat : kUnsignedInt},
                      {"count", values.size() / width},
                      {"type", type}};
        if (bounds) {
            for (std::size_t k = 0; k < width; ++k) {
                T low = values[k], high = values[k];
                for (std::size_t i = k; i < values.size(); i += width) {
                    low = std::min(low, values[i]);
                    high = std::max(high, values[i]);
                }
                accessor["min"].push_back(low);
                accessor["max"].push_back(high);
            }
        }
        json["accessors"].push_back(std::move(accessor));
        return json["accessors"].size() - 1;
    }

    [[nodiscard]] std::vector<std::byte> finish() {
        if (!binary_.empty()) json["buffers"] = Json::array({Json{{"byteLength", binary_.size()}}});
        std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
        text.append((4 - text.size() % 4) % 4, ' ');
        std::vector<std::byte> file;
        const auto put = [&file](std::span<const std::byte> bytes) {
            file.insert(file.end(), bytes.begin(), bytes.end());
        };
        const auto word = [&put](std::size_t value) {
            if (value > std::numeric_limits<std::uint32_t>::max())
                throw IoError("the run is too long for one glTF file (4 GiB); export fewer frames (--frames)");
            const auto number = static_cast<std::uint32_t>(value);
            put(std::as_bytes(std::span(&number, 1)));
        };
        const std::size_t chunks = binary_.empty() ? 1 : 2;
        word(kMagic), word(2), word(12 + 8 * chunks + text.size() + binary_.size());
        word(text.size()), word(kJsonChunk), put(std::as_bytes(std::span(text)));
        if (!binary_.empty()) word(binary_.size()), word(kBinaryChunk), put(binary_);
        return file;
    }

  private:
    std::vector<std::byte> binary_; ///< all elements have four bytes, so everything stays aligned
};

/// Accessors of a shape; none for an empty one, which glTF cannot hold.
struct ShapeArrays {
    struct Part {
        int mode = 4; ///< 0 points, 1 lines, 4 triangles
        std::size_t index = 0;
    };
    std::size_t position = 0;
    std::vector<Part> parts;
};
std::optional<ShapeArrays> add_shape(Glb& glb, const RunShape& shape) {
    if (shape.mesh.triangles.empty()) return {};
    std::vector<float> positions;
    for (const Vec3& v : shape.mesh.vertices)
        for (const double x : {v.x, v.y, v.z}) positions.push_back(static_cast<float>(x));
    ShapeArrays arrays{glb.add<float>(positions, "VEC3", kVertexArray, true), {}};
    constexpr std::array kParts{std::pair{ElementKind::triangle, 4}, std::pair{ElementKind::segment, 1},
                                std::pair{ElementKind::point, 0}};
    for (const auto& [kind, mode] : kParts) {
        std::vector<std::uint32_t> indices;
        for (const Triangle& t : shape.mesh.triangles) {
            if (element_of(t) != kind) continue;
            const auto [a, b] = segment_ends(t);
            const Triangle named = kind == ElementKind::triangle ? t : Triangle{a, b, b};
            for (std::size_t k = 0; k <= static_cast<std::size_t>(kind); ++k)
                indices.push_back(static_cast<std::uint32_t>(named[k]));
        }
        if (!indices.empty())
            arrays.parts.push_back({mode, glb.add<std::uint32_t>(indices, "SCALAR", kIndexArray, false)});
    }
    return arrays;
}

/// A material for every colour that a body has, and a mesh for every shape in a colour, which share the shape's arrays.
class Looks {
  public:
    Looks(Glb& glb, const RunScene& scene) : glb_(glb), scene_(scene) {
        for (const auto& shape : scene.shapes) shapes_.push_back(add_shape(glb, shape));
    }
    /// The index of the body's mesh; none for a shape without triangles.
    std::optional<std::size_t> mesh_of(std::size_t body) {
        const auto shape = static_cast<std::size_t>(scene_.bodies[body].shape);
        if (!shapes_[shape]) return {};
        const std::size_t colour = scene_.bodies[body].type == BodyType::dynamic
                                       ? colour_of(static_cast<std::uint32_t>(body)).colour
                                       : kBodyColours.size();
        const auto [place, is_new] = meshes_.try_emplace({shape, colour}, meshes_.size());
        if (is_new) {
            Json primitives = Json::array();
            for (const ShapeArrays::Part& part : shapes_[shape]->parts) {
                Json primitive{{"attributes", {{"POSITION", shapes_[shape]->position}}}, {"indices", part.index}};
                if (part.mode != 4) primitive["mode"] = part.mode;
                primitive["material"] = material(colour);
                primitives.push_back(std::move(primitive));
            }
            glb_.json["meshes"].push_back(Json{{"name", scene_.shapes[shape].name}, {"primitives", primitives}});
        }
        return place->second;
    }

  private:
    /// One number after the last colour: the grey of bodies that are not dynamic.
    std::size_t material(std::size_t colour) {
        const auto [place, is_new] = materials_.try_emplace(colour, materials_.size());
        if (!is_new) return place->second;
        std::array<float, 3> base = kFixedColour;
        if (colour < kBodyColours.size())
            for (std::size_t k = 0; k < 3; ++k) base[k] = linear_of_srgb(kBodyColours[colour][k]);
        const Json look{{"baseColorFactor", Json::array({base[0], base[1], base[2], 1})},
                        {"metallicFactor", 0},
                        {"roughnessFactor", 0.8}};
        glb_.json["materials"].push_back(Json{{"doubleSided", true}, {"pbrMetallicRoughness", look}});
        return place->second;
    }

    Glb& glb_;
    const RunScene& scene_;
    std::vector<std::optional<ShapeArrays>> shapes_;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> meshes_; ///< by shape and colour
    std::map<std::size_t, std::size_t> materials_;                      ///< by colour
};

/// The keyframes of all bodies.
struct Tracks {
    std::vector<float> times;
    std::vector<std::vector<float>> translations, rotations; ///< by body: x y z; x y z w
    /// By body: all zero in frames where it is not there, which hides it. Of an edited run alone.
    std::vector<std::vector<float>> scales;
};

/// A frame's part of the tracks, body after body.
struct KeyFrame {
    float time = 0;
    std::vector<float> translations;
    std::vector<Quat> rotations;
    std::vector<float> scales; ///< one a body; empty where all are there
};

KeyFrame key_frame(const Frame& frame) {
    KeyFrame key{static_cast<float>(frame.time), {}, {}, {}};
    for (const Vec3& p : frame.position)
        for (const double x : {p.x, p.y, p.z}) key.translations.push_back(static_cast<float>(x));
    for (const Quat& q : frame.rotation) key.rotations.push_back(normalized(q));
    return key;
}

KeyFrame key_frame(const Frame& frame, const HeldPoses& held) {
    if (!held.any()) return key_frame(frame);
    KeyFrame key = key_frame(held.hold(frame));
    for (std::size_t i = 0; i < frame.position.size(); ++i) key.scales.push_back(frame.absent(i) ? 0.0F : 1.0F);
    return key;
}

/// Turned to the same half of the unit quaternions as the one before, so that interpolation takes the short way.
void append_rotation(std::vector<float>& track, const Quat& q) {
    std::array<double, 4> value{q.x, q.y, q.z, q.w};
    if (track.size() >= 4) {
        double cosine = 0;
        for (std::size_t k = 0; k < 4; ++k) cosine += value[k] * static_cast<double>(track[track.size() - 4 + k]);
        if (cosine < 0)
            for (double& x : value) x = -x;
    }
    for (const double x : value) track.push_back(static_cast<float>(x));
}

Tracks read_tracks(RunReader& run, const FrameRange& range, const HeldPoses& held) {
    const std::size_t n = run.scene().bodies.size();
    using ByBody = std::vector<std::vector<float>>;
    Tracks tracks{{}, ByBody(n), ByBody(n), ByBody(held.any() ? n : 0)};
    const auto make = [&](const Frame& frame) { return key_frame(frame, held); };
    frames_in_order(run, range, make, [&](const KeyFrame& key, std::int64_t) {
        tracks.times.push_back(key.time);
        for (std::size_t i = 0; i < n; ++i) {
            const auto at = key.translations.begin() + static_cast<std::ptrdiff_t>(3 * i);
            tracks.translations[i].insert(tracks.translations[i].end(), at, at + 3);
            append_rotation(tracks.rotations[i], key.rotations[i]);
            if (held.any()) tracks.scales[i].insert(tracks.scales[i].end(), 3, key.scales[i]);
        }
    });
    return tracks;
}

bool is_constant(std::span<const float> track, std::size_t width) {
    for (std::size_t i = width; i < track.size(); ++i)
        if (track[i] != track[i - width]) return false;
    return true;
}

class Animation {
  public:
    Animation(Glb& glb, std::span<const float> times) : glb_(glb), times_(glb.add<float>(times, "SCALAR", 0, true)) {}

    void add(std::size_t node, const std::string& path, std::span<const float> track, const std::string& type,
             const std::string& interpolation = "LINEAR") {
        const std::size_t output = glb_.add<float>(track, type, 0, false);
        const Json target{{"node", node}, {"path", path}};
        json_["channels"].push_back(Json{{"sampler", json_["samplers"].size()}, {"target", target}});
        json_["samplers"].push_back(Json{{"input", times_}, {"interpolation", interpolation}, {"output", output}});
    }
    void finish() {
        if (json_.contains("channels")) glb_.json["animations"].push_back(json_);
    }

  private:
    Glb& glb_;
    std::size_t times_;
    Json json_{{"name", "run"}, {"samplers", Json::array()}};
};

Json first_pose(const Tracks& tracks, std::size_t body) {
    Json node;
    const auto& t = tracks.translations[body];
    const auto& r = tracks.rotations[body];
    if (!t.empty()) node["translation"] = Json::array({t[0], t[1], t[2]});
    if (!r.empty()) node["rotation"] = Json::array({r[0], r[1], r[2], r[3]});
    if (!tracks.scales.empty() && tracks.scales[body].front() == 0) node["scale"] = Json::array({0, 0, 0});
    return node;
}

/// Node 0 turns z up into glTF's y up; body i is node i + 1.
void add_frame_of_reference(Glb& glb, std::size_t bodies) {
    glb.json["asset"] = Json{{"version", "2.0"}, {"generator", "flotilla"}};
    glb.json["scene"] = 0;
    glb.json["scenes"] = Json::array({Json{{"nodes", Json::array({0})}}});
    const double half = std::sqrt(0.5);
    Json root{{"name", "z up"}, {"rotation", Json::array({-half, 0, 0, half})}};
    for (std::size_t i = 0; i < bodies; ++i) root["children"].push_back(i + 1);
    glb.json["nodes"] = Json::array({root});
}

void add_animation(Glb& glb, const Tracks& tracks) {
    if (tracks.times.size() < 2) return;
    Animation animation(glb, tracks.times);
    for (std::size_t i = 0; i < tracks.rotations.size(); ++i) {
        if (!is_constant(tracks.translations[i], 3))
            animation.add(i + 1, "translation", tracks.translations[i], "VEC3");
        if (!is_constant(tracks.rotations[i], 4)) animation.add(i + 1, "rotation", tracks.rotations[i], "VEC4");
        if (!tracks.scales.empty() && !is_constant(tracks.scales[i], 3))
            animation.add(i + 1, "scale", tracks.scales[i], "VEC3", "STEP");
    }
    animation.finish();
}

} // namespace

void export_glb(RunReader& run, const FrameRange& range, const std::filesystem::path& file) {
    static_assert(std::endian::native == std::endian::little);
    const RunScene& scene = run.scene();
    Glb glb;
    add_frame_of_reference(glb, scene.bodies.size());
    Looks looks(glb, scene);
    const HeldPoses held(run, range);
    const Tracks tracks = read_tracks(run, range, held);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Json node = first_pose(tracks, i);
        node["name"] = scene.bodies[i].name;
        if (held.seen(i))
            if (const auto mesh = looks.mesh_of(i)) node["mesh"] = *mesh;
        glb.json["nodes"].push_back(std::move(node));
    }
    add_animation(glb, tracks);
    write_file(file, glb.finish());
}

} // namespace flotilla::io
