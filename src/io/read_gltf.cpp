// SPDX-License-Identifier: MIT
#include "io/read_gltf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include <flotilla/error.hpp>

#include "base/rotation.hpp"
#include "base/text.hpp"
#include "base/vec3.hpp"
#include "io/gltf_buffers.hpp"
#include "mesh/mesh_file.hpp"

namespace flotilla::io {

namespace {

using std::string_view_literals::operator""sv;

constexpr std::uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr std::uint64_t kNone = std::numeric_limits<std::int32_t>::max();
constexpr std::uint64_t kMostElements = std::uint64_t{1} << 26; // so many vertices take 1.6 GB
// What a file may require of its reader without moving a vertex.
constexpr std::array kHarmless{"KHR_materials_"sv, "KHR_texture_"sv, "EXT_texture_"sv, "KHR_lights_"sv, "KHR_xmp"sv};

struct Affine {
    Mat3 linear = identity();
    Vec3 offset;
};

Affine operator*(const Affine& a, const Affine& b) { return {a.linear * b.linear, a.linear * b.offset + a.offset}; }

std::string primitives_place(std::uint64_t mesh) { return "/meshes/" + std::to_string(mesh) + "/primitives"; }

/// The two chunks of a file; the second has no data where there is none.
struct Chunks {
    std::string_view json, binary;
};

Chunks split_chunks(const std::filesystem::path& path, std::string_view data) {
    const auto word = [&](std::size_t at) {
        std::uint32_t value = 0;
        if (at + sizeof value > data.size()) refuse_gltf(path, "", "the file ends early");
        std::memcpy(&value, data.data() + at, sizeof value);
        return value;
    };
    if (data.size() < 4 || word(0) != kMagic) return {data, {}};
    if (word(4) != 2) refuse_gltf(path, "", "binary glTF of version " + std::to_string(word(4)) + ", 2 is known");
    if (word(8) != data.size())
        refuse_gltf(path, "",
                    "the file says " + std::to_string(word(8)) + " bytes, it has " + std::to_string(data.size()));
    Chunks chunks;
    for (std::size_t at = 12; at < data.size();) {
        const std::size_t length = word(at), type = word(at + 4);
        at += 8;
        if (length > data.size() - at) refuse_gltf(path, "", "a chunk ends behind the file");
        if (type == kJsonChunk && chunks.json.data() == nullptr) chunks.json = data.substr(at, length);
        if (type == kBinaryChunk && chunks.binary.data() == nullptr) chunks.binary = data.substr(at, length);
        at += length;
    }
    if (chunks.json.data() == nullptr) refuse_gltf(path, "", "the file has no JSON chunk");
    return chunks;
}

class GltfReader {
  public:
    GltfReader(const std::filesystem::path& path, const Json& document, std::string_view binary)
        : path_(path), document_(document), buffers_(path, document, binary) {}

    TriangleMesh read(std::string_view node);

  private:
    struct Visit {
        std::uint64_t node;
        Affine above; ///< the transform of what the node hangs on
        bool wanted;  ///< the node, or what it hangs on, is the one asked for
    };

    [[noreturn]] void refuse(const std::string& where, const std::string& reason) const {
        refuse_gltf(path_, where, reason);
    }
    [[nodiscard]] std::uint64_t number(const Json& object, const std::string& where, const char* key,
                                       std::uint64_t otherwise) const {
        return gltf_number(path_, object, where, key, otherwise, kNone);
    }
    [[nodiscard]] const Json& list(const char* key) const;
    [[nodiscard]] const Json& object(const char* key, std::uint64_t index, const std::string& asked_at) const;
    [[nodiscard]] std::vector<std::uint64_t> numbers(const Json& owner, const std::string& where,
                                                     const char* key) const;
    template <std::size_t N>
    bool doubles(std::array<double, N>& out, const Json& owner, const std::string& where, const char* key) const;
    void check_requirements() const;
    [[nodiscard]] std::vector<std::uint64_t> roots() const;
    [[nodiscard]] Affine transform(const Json& node, const std::string& where) const;
    void visit(const Visit& v, std::string_view wanted, std::vector<Visit>& waiting);
    void show(std::uint64_t mesh, const Affine& to_scene, const std::string& asked_at);
    [[nodiscard]] const Json& primitives(std::uint64_t mesh) const;
    struct Arrays {
        std::uint64_t mode = 0, positions = kNone, indices = kNone; ///< no positions: nothing to take
    };
    [[nodiscard]] Arrays arrays(const Json& primitive, const std::string& where) const;
    [[nodiscard]] std::uint64_t count(std::uint64_t mesh);
    void add_primitive(const Arrays& arrays, const std::string& where, const Affine& to_scene);
    void add_corners(const std::vector<std::uint32_t>& corners, std::uint64_t mode, std::size_t first);

    const std::filesystem::path& path_;
    const Json& document_;
    GltfBuffers buffers_;
    TriangleMesh mesh_;
    struct Shown {
        std::uint64_t mesh;
        Affine to_scene;
    };
    std::vector<Shown> shown_;
    std::vector<std::uint64_t> counts_; ///< of vertices or corners, whichever are more, by mesh; kNone: not counted yet
    std::uint64_t elements_ = 0;        ///< of all that is shown
    bool found_ = false;
    std::vector<bool> visited_;
    std::vector<std::string_view> names_;
};

const Json& GltfReader::list(const char* key) const {
    static const Json kEmpty = Json::array();
    const auto found = document_.find(key);
    if (found == document_.end()) return kEmpty;
    if (!found->is_array()) refuse("/" + std::string(key), "must be an array, got " + kind_of(*found));
    return *found;
}

const Json& GltfReader::object(const char* key, std::uint64_t index, const std::string& asked_at) const {
    const Json& all = list(key);
    if (index >= all.size())
        refuse(asked_at, "names /" + std::string(key) + "/" + std::to_string(index) + ", there are " +
                             std::to_string(all.size()));
    if (!all[index].is_object())
        refuse("/" + std::string(key) + "/" + std::to_string(index), "must be an object, got " + kind_of(all[index]));
    return all[index];
}

std::vector<std::uint64_t> GltfReader::numbers(const Json& owner, const std::string& where, const char* key) const {
    std::vector<std::uint64_t> values;
    const auto found = owner.find(key);
    if (found == owner.end()) return values;
    if (!found->is_array()) refuse(where + "/" + key, "must be an array, got " + kind_of(*found));
    for (const Json& value : *found) {
        if (!value.is_number_unsigned()) refuse(where + "/" + key, "must hold whole numbers from 0");
        values.push_back(value.get<std::uint64_t>());
    }
    return values;
}

template <std::size_t N>
bool GltfReader::doubles(std::array<double, N>& out, const Json& owner, const std::string& where,
                         const char* key) const {
    const auto found = owner.find(key);
    if (found == owner.end()) return false;
    const auto is_number = [](const Json& value) { return value.is_number(); };
    if (!found->is_array() || found->size() != N || !std::all_of(found->begin(), found->end(), is_number))
        refuse(where + "/" + key, "must be an array of " + std::to_string(N) + " numbers");
    for (std::size_t i = 0; i < N; ++i) out[i] = (*found)[i].template get<double>();
    return true;
}

void GltfReader::check_requirements() const {
    const auto asset = document_.find("asset");
    const auto version = asset != document_.end() && asset->is_object() ? asset->value("version", Json()) : Json();
    if (!version.is_string() || !version.get_ref<const std::string&>().starts_with("2."))
        refuse("/asset/version", "must be 2.0, got " + kind_of(version));
    const Json& required = list("extensionsRequired");
    for (const Json& name : required) {
        const auto is_harmless = [&](std::string_view start) {
            return name.get_ref<const std::string&>().starts_with(start);
        };
        if (!name.is_string() || std::none_of(kHarmless.begin(), kHarmless.end(), is_harmless))
            refuse("/extensionsRequired", name.is_string()
                                              ? in_quotes(name.get_ref<const std::string&>()) + " is not supported"
                                              : "must hold names");
    }
}

/// Of the scene to show; without scenes, the nodes that hang on none.
std::vector<std::uint64_t> GltfReader::roots() const {
    if (const Json& scenes = list("scenes"); !scenes.empty()) {
        const std::uint64_t scene = number(document_, "", "scene", 0);
        return numbers(object("scenes", scene, "/scene"), "/scenes/" + std::to_string(scene), "nodes");
    }
    const Json& nodes = list("nodes");
    std::vector<bool> hangs(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const std::string where = "/nodes/" + std::to_string(i);
        for (const std::uint64_t child : numbers(object("nodes", i, where), where, "children"))
            if (child < hangs.size()) hangs[child] = true;
    }
    std::vector<std::uint64_t> free;
    for (std::size_t i = 0; i < hangs.size(); ++i)
        if (!hangs[i]) free.push_back(i);
    return free;
}

Affine GltfReader::transform(const Json& node, const std::string& where) const {
    Affine t;
    std::array<double, 16> m{}; // column by column
    if (doubles(m, node, where, "matrix")) {
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) t.linear.m[3 * i + j] = m[4 * j + i];
        t.offset = {m[12], m[13], m[14]};
        return t;
    }
    std::array<double, 4> q{0, 0, 0, 1};
    std::array<double, 3> scale{1, 1, 1}, offset{};
    if (doubles(q, node, where, "rotation")) {
        const Quat turn{q[3], q[0], q[1], q[2]};
        if (!(std::abs(norm(turn) - 1) < 1e-3))
            refuse(where + "/rotation",
                   "must be a unit quaternion [x, y, z, w]"); // written as floats, or with few digits
        t.linear = matrix(normalized(turn));
    }
    if (doubles(scale, node, where, "scale")) t.linear = t.linear * diagonal({scale[0], scale[1], scale[2]});
    doubles(offset, node, where, "translation");
    t.offset = {offset[0], offset[1], offset[2]};
    return t;
}

/// How many elements so many corners make.
std::size_t elements_of(std::size_t corners, std::uint64_t mode) {
    constexpr std::array<std::size_t, 7> kLeast{1, 2, 2, 2, 3, 3, 3};
    if (corners < kLeast[mode]) return 0;
    switch (mode) {
    case 1: return corners / 2;
    case 2: return corners;
    case 4: return corners / 3;
    default: return corners + 1 - kLeast[mode];
    }
}

/// Points, lines, loop, strip of lines; triangles, strip, fan.
void GltfReader::add_corners(const std::vector<std::uint32_t>& corners, std::uint64_t mode, std::size_t first) {
    const auto at = [&](std::size_t i) { return static_cast<std::int32_t>(first + corners[i]); };
    const std::size_t count = elements_of(corners.size(), mode);
    for (std::size_t i = 0; i < count; ++i) {
        if (mode == 0) mesh_.triangles.push_back(point_element(at(i)));
        if (mode == 1) mesh_.triangles.push_back(segment_element(at(2 * i), at(2 * i + 1)));
        if (mode == 2 || mode == 3) mesh_.triangles.push_back(segment_element(at(i), at((i + 1) % corners.size())));
        const std::size_t odd = i % 2; // every second triangle of a strip faces the other way
        if (mode == 4) mesh_.triangles.push_back({at(3 * i), at(3 * i + 1), at(3 * i + 2)});
        if (mode == 5) mesh_.triangles.push_back({at(i), at(i + 1 + odd), at(i + 2 - odd)});
        if (mode == 6) mesh_.triangles.push_back({at(i + 1), at(i + 2), at(0)});
    }
}

const Json& GltfReader::primitives(std::uint64_t mesh) const {
    const Json& json = list("meshes")[mesh];
    const auto found = json.find("primitives");
    if (found == json.end() || !found->is_array()) refuse(primitives_place(mesh), "must be an array");
    return *found;
}

GltfReader::Arrays GltfReader::arrays(const Json& primitive, const std::string& where) const {
    if (!primitive.is_object()) refuse(where, "must be an object, got " + kind_of(primitive));
    Arrays a{number(primitive, where, "mode", 4)};
    if (a.mode > 6) refuse(where + "/mode", "must be at most 6, got " + std::to_string(a.mode));
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) refuse(where + "/attributes", "must be an object");
    a.positions = number(*attributes, where + "/attributes", "POSITION", kNone);
    a.indices = number(primitive, where, "indices", kNone);
    return a;
}

std::uint64_t GltfReader::count(std::uint64_t mesh) {
    std::uint64_t vertices = 0, corners = 0;
    const Json& all = primitives(mesh);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Arrays a = arrays(all[i], primitives_place(mesh) + "/" + std::to_string(i));
        if (a.positions == kNone) continue;
        const std::uint64_t here = buffers_.count_positions(a.positions);
        vertices += here;
        corners += a.indices == kNone ? here : buffers_.count_indices(a.indices);
    }
    return std::max(vertices, corners);
}

/// Notes that a mesh is to be taken. Nodes may show one any number of times, so a small file could ask for all memory.
void GltfReader::show(std::uint64_t mesh, const Affine& to_scene, const std::string& asked_at) {
    (void)object("meshes", mesh, asked_at);
    counts_.resize(list("meshes").size(), kNone);
    if (counts_[mesh] == kNone) counts_[mesh] = count(mesh);
    elements_ += counts_[mesh];
    if (elements_ > kMostElements)
        refuse(asked_at,
               "the mesh has more than " + std::to_string(kMostElements) + " vertices or corners of triangles");
    shown_.push_back({mesh, to_scene});
}

void GltfReader::add_primitive(const Arrays& arrays, const std::string& where, const Affine& to_scene) {
    if (arrays.positions == kNone) return;
    const std::size_t first = mesh_.vertices.size();
    for (const Vec3& v : buffers_.positions(arrays.positions)) {
        mesh_.vertices.push_back(to_scene.linear * v + to_scene.offset);
        if (!is_finite(mesh_.vertices.back())) refuse(where, "a coordinate is not finite");
    }
    const std::uint64_t vertices = mesh_.vertices.size() - first;
    std::vector<std::uint32_t> order(arrays.indices == kNone ? vertices : 0);
    std::iota(order.begin(), order.end(), 0U);
    if (arrays.indices != kNone) order = buffers_.indices(arrays.indices);
    for (const std::uint32_t i : order)
        if (i >= vertices)
            refuse(where + "/indices", "index " + std::to_string(i) + " is out of range, there are " +
                                           std::to_string(vertices) + " vertices");
    add_corners(order, arrays.mode, first);
}

void GltfReader::visit(const Visit& v, std::string_view wanted, std::vector<Visit>& waiting) {
    const std::string where = "/nodes/" + std::to_string(v.node);
    const Json& node = object("nodes", v.node, where);
    if (visited_[v.node]) refuse(where, "hangs on more than one node, or on itself");
    visited_[v.node] = true;
    bool taken = v.wanted;
    if (const auto name = node.find("name"); name != node.end() && name->is_string()) {
        names_.push_back(name->get_ref<const std::string&>());
        taken |= names_.back() == wanted;
    }
    found_ |= taken;
    const Affine to_scene = v.above * transform(node, where);
    if (const std::uint64_t mesh = number(node, where, "mesh", kNone); taken && mesh != kNone)
        show(mesh, to_scene, where + "/mesh");
    const std::vector<std::uint64_t> children = numbers(node, where, "children");
    for (auto child = children.rbegin(); child != children.rend(); ++child)
        waiting.push_back({*child, to_scene, taken});
}

TriangleMesh GltfReader::read(std::string_view node) {
    check_requirements();
    const bool all = node.empty();
    visited_.resize(list("nodes").size());
    std::vector<Visit> waiting; // the next one at the end
    const std::vector<std::uint64_t> first = roots();
    for (auto root = first.rbegin(); root != first.rend(); ++root) waiting.push_back({*root, {}, all});
    while (!waiting.empty()) {
        const Visit next = waiting.back();
        waiting.pop_back();
        visit(next, node, waiting);
    }
    if (visited_.empty() && all) // meshes alone
        for (std::size_t i = 0; i < list("meshes").size(); ++i) show(i, {}, "/meshes/" + std::to_string(i));
    if (!all && !found_) refuse("", unknown_name("node", node, names_));
    for (const Shown& s : shown_) {
        const Json& parts = primitives(s.mesh);
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const std::string where = primitives_place(s.mesh) + "/" + std::to_string(i);
            add_primitive(arrays(parts[i], where), where, s.to_scene);
        }
    }
    if (mesh_.triangles.empty())
        refuse("", all ? "the file has no geometry" : "node " + in_quotes(node) + " has no geometry");
    return without_unused_vertices(merge_equal_vertices(mesh_));
}

} // namespace

TriangleMesh read_gltf(const std::filesystem::path& path, std::string_view data, std::string_view node) {
    const Chunks chunks = split_chunks(path, data);
    ErrorList errors(path.string());
    const Json document = parse_json(chunks.json, errors);
    const MemoryForTheEnd memory(chunks.json.size());
    errors.throw_if_any();
    if (!document.is_object()) refuse_gltf(path, "", "must be an object, got " + kind_of(document));
    return GltfReader(path, document, chunks.binary).read(node);
}

} // namespace flotilla::io
