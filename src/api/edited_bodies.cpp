// SPDX-License-Identifier: MIT
#include "api/edited_bodies.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include <flotilla/error.hpp>

#include "base/byte_stream.hpp"
#include "base/error_list.hpp"
#include "base/hasher.hpp"
#include "base/vec3.hpp"
#include "scene/description_checks.hpp"
#include "state/snapshot.hpp"

namespace flotilla {
namespace {

constexpr std::uint64_t kMagic = 0x544944454c464c46; // "FLFLEDIT"
constexpr std::uint64_t kVersion = 3;

static_assert(sizeof(Keyframe) == 8 * sizeof(double) && sizeof(EditedBodies::Push) == 7 * sizeof(double));
static_assert(sizeof(EditedBodies::Kept) == 7 * sizeof(double));
static_assert(sizeof(Triangle) == 12 && sizeof(Vec3) == 24);

[[noreturn]] void damaged() { throw InputError("damaged snapshot: its edited part is none"); }

// One list of members for both ways: `out` is a ByteWriter, or a reader that fills what it is given.

template <class Stream, class T>
void part(Stream& s, T& value) {
    if constexpr (requires { s.add(value); })
        s.add(value);
    else
        s.read(value);
}

template <class Stream, class T>
void optional_part(Stream& s, std::optional<T>& value) {
    std::uint8_t has = value.has_value() ? 1 : 0;
    part(s, has);
    if (has > 1) damaged();
    if (has == 0) return;
    if (!value) value.emplace();
    part(s, *value);
}

/// As bytes, for not every byte is a bool.
template <class Stream>
void flags(Stream& s, std::array<bool, 3>& values) {
    for (bool& value : values) {
        std::uint8_t byte = value ? 1 : 0;
        part(s, byte);
        if (byte > 1) damaged();
        value = byte != 0;
    }
}

template <class Stream, class T, class Each>
void list(Stream& s, std::vector<T>& values, Each&& each) {
    if constexpr (requires { s.add(std::uint64_t{}); })
        s.add(static_cast<std::uint64_t>(values.size()));
    else
        values.resize(s.size_of(8)); // no element takes less
    for (T& value : values) each(value);
}

template <class Stream>
void visit(Stream& s, ShapeDescription& shape) {
    part(s, shape.name), part(s, shape.mesh_path), part(s, shape.scale), part(s, shape.vertices);
    part(s, shape.triangles), part(s, shape.mass_kind), part(s, shape.mass_value);
    optional_part(s, shape.inertia), optional_part(s, shape.center_of_mass);
}

template <class Stream>
void visit(Stream& s, BodyDescription& body) {
    part(s, body.name), part(s, body.shape), part(s, body.type), part(s, body.position), part(s, body.rotation);
    part(s, body.velocity), part(s, body.angular_velocity), part(s, body.friction), part(s, body.restitution);
    part(s, body.keyframes), part(s, body.group);
    flags(s, body.locked_translation), flags(s, body.locked_rotation), part(s, body.force), part(s, body.torque);
}

template <class Stream>
void visit(Stream& s, EditedBodies& e, std::vector<ShapeDescription>& added) {
    part(s, e.hash), part(s, e.gravity);
    list(s, added, [&](ShapeDescription& shape) { visit(s, shape); });
    list(s, e.bodies, [&](BodyDescription& body) { visit(s, body); });
    part(s, e.present), part(s, e.generation), part(s, e.user_data), part(s, e.pushes), part(s, e.kept);
    part(s, e.moved);
    const auto names = [&](NamedPair& pair) { part(s, pair.a), part(s, pair.b); };
    list(s, e.ignored_groups, names), list(s, e.ignored_bodies, names);
}

/// What edits keep true.
void check(const EditedBodies& e) {
    const std::size_t n = e.bodies.size();
    if (e.hash == 0 || e.present.size() != n || e.generation.size() != n || e.user_data.size() != n ||
        e.moved.size() != n)
        damaged();
    SceneDescription scene;
    if (!is_finite(e.gravity) || max_component(abs(e.gravity)) > kMaxGravity) damaged();
    for (const ShapeDescription& shape : e.shapes) {
        if (shape.mass_kind > MassKind::line_density) damaged();
        scene.shapes.emplace_back();
        scene.shapes.back().name = shape.name;
        scene.shapes.back().mass_kind = shape.mass_kind;
    }
    ErrorList errors("damaged snapshot");
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < n; ++i) {
        const BodyDescription& body = e.bodies[i];
        if (e.present[i] > 1 || body.shape < 0 || body.type > BodyType::kinematic) damaged();
        if (static_cast<std::size_t>(body.shape) >= e.shapes.size()) refuse_other_scene();
        if (e.present[i] == 0) continue;
        if (was_removed(e.shapes[static_cast<std::size_t>(body.shape)])) damaged();
        if (!names.insert(body.name).second) damaged();
        BodyDescription copy = body;
        check_name(copy.name, element_path("bodies", i), errors);
        check_body(copy, scene, element_path("bodies", i), errors);
    }
    errors.throw_if_any();
    const auto check_loads = [&](const auto& list, bool dynamic) {
        std::int32_t last = -1;
        for (const auto& p : list) {
            const auto i = static_cast<std::size_t>(p.body);
            if (p.body <= last || i >= n || e.present[i] == 0) damaged();
            if ((e.bodies[i].type == BodyType::dynamic) != dynamic) damaged();
            if (!(max_component(abs(p.force)) <= kMaxForce) || !is_finite(p.force)) damaged();
            if (!(max_component(abs(p.torque)) <= kMaxForce) || !is_finite(p.torque)) damaged();
            last = p.body;
        }
    };
    check_loads(e.pushes, true), check_loads(e.kept, false);
    if (std::ranges::any_of(e.kept, [](const EditedBodies::Kept& k) { return k.locked >> 6 != 0; })) damaged();
}

// Hashes of edits. Names of bodies and shapes change no bit.

void add(Hasher& h, const std::string& text) {
    h.add(static_cast<std::uint64_t>(text.size()));
    for (const char c : text) h.add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
}
void add(Hasher& h, BodyId body) {
    h.add(static_cast<std::uint64_t>(body.index)), h.add(std::uint64_t{body.generation});
}
void add(Hasher& h, const std::vector<Keyframe>& keyframes) {
    h.add(static_cast<std::uint64_t>(keyframes.size()));
    for (const Keyframe& k : keyframes) h.add(k.time), h.add(k.position), h.add(k.rotation);
}
void add(Hasher& h, const edits::AddShape& e) {
    const ShapeDescription& s = e.shape;
    for (const Vec3& v : s.vertices) h.add(v);
    for (const Triangle& t : s.triangles)
        for (const std::int32_t v : t) h.add(static_cast<std::uint64_t>(v));
    h.add(static_cast<std::uint64_t>(s.mass_kind)), h.add(s.mass_value);
    if (s.inertia)
        for (const double x : s.inertia->m) h.add(x);
    if (s.center_of_mass) h.add(*s.center_of_mass);
}
void add(Hasher& h, const edits::AddBody& e) {
    const BodyDescription& b = e.body;
    h.add(static_cast<std::uint64_t>(b.shape)), h.add(static_cast<std::uint64_t>(b.type));
    h.add(b.position), h.add(b.rotation), h.add(b.velocity), h.add(b.angular_velocity);
    h.add(b.friction), h.add(b.restitution), add(h, b.keyframes), add(h, b.group), h.add(b.force), h.add(b.torque);
    for (const auto* axes : {&b.locked_translation, &b.locked_rotation})
        for (const bool locked : *axes) h.add(std::uint64_t{locked});
}
void add(Hasher& h, const edits::RemoveBody& e) { add(h, e.body); }
void add(Hasher& h, const edits::SetPose& e) { add(h, e.body), h.add(e.position), h.add(e.rotation); }
void add(Hasher& h, const edits::SetVelocity& e) { add(h, e.body), h.add(e.velocity), h.add(e.angular_velocity); }
void add(Hasher& h, const edits::SetType& e) { add(h, e.body), h.add(static_cast<std::uint64_t>(e.type)); }
void add(Hasher& h, const edits::SetScript& e) { add(h, e.body), add(h, e.keyframes); }
void add(Hasher& h, const edits::SetMaterial& e) { add(h, e.body), h.add(e.friction), h.add(e.restitution); }
void add(Hasher& h, const edits::SetForce& e) { add(h, e.body), h.add(e.force), h.add(e.torque); }
void add(Hasher& h, const edits::ApplyForce& e) { add(h, e.body), h.add(e.force), h.add(e.torque); }
void add(Hasher& h, const edits::ApplyImpulse& e) { add(h, e.body), h.add(e.impulse), h.add(e.angular_impulse); }
void add(Hasher& h, const edits::SetGravity& e) { h.add(e.gravity); }
void add(Hasher& h, const edits::SetGroup& e) { add(h, e.body), add(h, e.group); }
void add(Hasher& h, const edits::IgnoreGroups& e) { add(h, e.a), add(h, e.b), h.add(std::uint64_t{e.ignored}); }
void add(Hasher& h, const edits::IgnorePair& e) { add(h, e.a), add(h, e.b), h.add(std::uint64_t{e.ignored}); }
void add(Hasher& h, const edits::Wake& e) { add(h, e.body); }
void add(Hasher& h, const edits::RemoveShape& e) { h.add(static_cast<std::uint64_t>(e.shape)); }

std::uint64_t hash_of(std::span<const std::byte> bytes) {
    Hasher h;
    for (const std::byte b : bytes) h.add(static_cast<std::uint64_t>(b));
    return h.value();
}

} // namespace

std::uint64_t chained(std::uint64_t hash, const Edit& edit, std::int64_t step) {
    Hasher of_change;
    of_change.add(hash), of_change.add(static_cast<std::uint64_t>(edit.change.index()));
    std::visit([&](const auto& change) { add(of_change, change); }, edit.change);
    Hasher h;
    h.add(std::max<std::uint64_t>(of_change.value(), 1)), h.add(static_cast<std::uint64_t>(step));
    return std::max<std::uint64_t>(h.value(), 1);
}

std::vector<std::byte> join_snapshot(const EditedBodies& bodies, std::span<const std::byte> state) {
    EditedBodies copy = bodies; // one list of members reads and writes
    std::vector<ShapeDescription> added(copy.shapes.begin() + static_cast<std::ptrdiff_t>(copy.scene_shapes),
                                        copy.shapes.end());
    ByteWriter edited;
    visit(edited, copy, added);
    const std::vector<std::byte> bytes = edited.take();
    ByteWriter out;
    out.add(kMagic), out.add(kVersion), out.add(hash_of(bytes)), out.add(bytes);
    out.add_bytes(state.data(), state.size());
    return out.take();
}

SplitSnapshot split_snapshot(std::span<const std::byte> snapshot, const EditedBodies& start) {
    SplitSnapshot out;
    out.state = snapshot;
    ByteReader in(snapshot, damaged);
    std::uint64_t magic = 0, version = 0, hash = 0;
    if (snapshot.size() < sizeof magic) return out;
    in.read(magic);
    if (magic != kMagic) return out;
    in.read(version), in.read(hash);
    if (version != kVersion) throw InputError("snapshot of another version of flotilla");
    std::vector<std::byte> bytes;
    in.read(bytes);
    if (hash != hash_of(bytes)) throw InputError("damaged snapshot: its content does not match its hash");
    ByteReader edited(std::span<const std::byte>(bytes), damaged);
    std::vector<ShapeDescription> added;
    visit(edited, out.bodies, added);
    if (!edited.rest().empty()) damaged();
    out.bodies.scene_shapes = start.scene_shapes;
    out.bodies.shapes.assign(start.shapes.begin(),
                             start.shapes.begin() + static_cast<std::ptrdiff_t>(start.scene_shapes));
    for (ShapeDescription& shape : added) out.bodies.shapes.push_back(std::move(shape));
    check(out.bodies);
    out.edited = true;
    out.state = in.rest();
    return out;
}

} // namespace flotilla
