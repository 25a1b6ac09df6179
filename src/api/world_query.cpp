// SPDX-License-Identifier: MIT
// Questions about a World as it stands.
#include <algorithm>
#include <cmath>
#include <limits>

#include "api/world_impl.hpp"
#include "base/floating_point.hpp"
#include "base/index.hpp"
#include "base/text.hpp"
#include "state/build_model.hpp"

namespace flotilla {
namespace {

void require_finite(const char* what, const Vec3& v) {
    if (!is_finite(v)) throw InputError(std::string(what) + " must be finite");
}

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.capacity() * sizeof(T);
}

std::size_t bytes_of(const RigidShape& shape) {
    const Bvh& bvh = shape.bvh;
    const Topology& t = shape.topology;
    return bytes_of(shape.mesh.vertices) + bytes_of(shape.mesh.triangles) + bytes_of(bvh.nodes) +
           bytes_of(bvh.triangles) + bytes_of(bvh.corners) + bytes_of(bvh.sizes) + bytes_of(t.edges) +
           bytes_of(t.triangle_edges) + bytes_of(t.vertex_owner) + bytes_of(t.edge_owner) + bytes_of(t.owned);
}

} // namespace

BodyId World::id(std::size_t index) const {
    impl_->check(index);
    if (impl_->now.present[index] == 0) throw InputError("body " + std::to_string(index) + " was removed");
    return impl_->id(index);
}

std::vector<BodyId> World::ids() const {
    std::vector<BodyId> out;
    for (std::size_t i = 0; i < size(); ++i)
        if (impl_->now.present[i] != 0) out.push_back(impl_->id(i));
    return out;
}

std::uint32_t World::generation(std::size_t index) const {
    impl_->check(index);
    return impl_->now.generation[index];
}

BodyId World::find(const std::string& name) const {
    const auto found = impl_->place_of.find(name);
    if (found == impl_->place_of.end()) throw InputError("there is no body " + in_quotes(name));
    return impl_->id(static_cast<std::size_t>(found->second));
}

std::int32_t World::find_shape(const std::string& name) const {
    const auto& shapes = impl_->now.shapes;
    std::vector<std::string_view> names;
    for (const ShapeDescription& shape : shapes) {
        if (shape.name == name && !was_removed(shape)) return static_cast<std::int32_t>(names.size());
        names.emplace_back(shape.name);
    }
    throw InputError(unknown_name("shape", name, names));
}
const ShapeDescription& World::shape(std::int32_t number) const { return impl_->shape(number); }
bool World::contains_shape(std::int32_t number) const {
    return number >= 0 && at(number) < num_shapes() && !was_removed(impl_->now.shapes[at(number)]);
}
std::size_t World::num_shapes() const { return impl_->now.shapes.size(); }

bool World::contains(BodyId body) const {
    const auto i = static_cast<std::size_t>(body.index);
    return body.index >= 0 && i < size() && impl_->now.present[i] != 0 && impl_->now.generation[i] == body.generation;
}

const std::string& World::name(BodyId body) const { return impl_->now.bodies[impl_->place(body)].name; }
const BodyDescription& World::description(BodyId body) const { return impl_->now.bodies[impl_->place(body)]; }
void World::set_user_data(BodyId body, std::uint64_t data) { impl_->now.user_data[impl_->place(body)] = data; }
std::uint64_t World::user_data(BodyId body) const { return impl_->now.user_data[impl_->place(body)]; }
Vec3 World::gravity() const { return impl_->now.gravity; }

double World::energy() const {
    const DefaultFloatingPoint environment;
    return impl_->stepper->energy();
}

std::size_t World::num_bodies() const {
    return static_cast<std::size_t>(std::count(impl_->now.present.begin(), impl_->now.present.end(), 1));
}

std::span<const Pose> World::poses() const { return impl_->stepper->state().pose; }
std::span<const Motion> World::motions() const { return impl_->stepper->state().motion; }
std::shared_ptr<const void> World::pin() const { return impl_->pin; }
std::span<const ContactState> World::contact_view() const { return *impl_->contacts(); }
std::shared_ptr<const std::vector<ContactState>> World::shared_contacts() const { return impl_->contacts(); }

std::optional<RayHit> World::ray(const Vec3& origin, const Vec3& direction, double reach) const {
    const DefaultFloatingPoint environment;
    require_finite("the origin of a ray", origin);
    require_finite("the direction of a ray", direction);
    const double norm = length(direction);
    if (!(norm > 0) || !std::isfinite(norm))
        throw InputError("the direction of a ray must be finite and not zero, and so must its square");
    if (!(reach >= 0)) throw InputError("the reach of a ray must not be negative");
    impl_->stepper->place_changed();
    const Vec3 unit = direction / norm;
    std::optional<RayHit> best;
    for (std::size_t i = 0; i < size(); ++i) {
        if (impl_->now.present[i] == 0) continue;
        const double far = best ? best->distance : reach;
        if (!may_meet_ray(impl_->stepper->trajectories().start_box(i), origin, unit, far)) continue;
        const auto hit = first_on_ray(impl_->placed(i), origin, unit, far);
        if (!hit || (best && !(hit->distance < best->distance))) continue;
        best = {impl_->id(i), hit->triangle, hit->distance, origin + hit->distance * unit, hit->normal};
    }
    return best;
}

ClosestPoints World::closest(BodyId a, BodyId b) const {
    const DefaultFloatingPoint environment;
    const std::size_t i = impl_->place(a), k = impl_->place(b);
    if (i == k) throw InputError("the distance of a body from itself");
    impl_->stepper->place_changed();
    const ShapeDistance d = body_distance(impl_->placed(i), impl_->placed(k));
    return {d.distance, d.a, d.b, d.triangle_a, d.triangle_b};
}

std::vector<BodyId> World::overlapping(std::int32_t shape, const Vec3& position, const Quat& rotation) const {
    const DefaultFloatingPoint environment;
    BodyDescription probe;
    probe.name = "probe";
    probe.shape = shape;
    probe.position = position;
    probe.rotation = rotation;
    probe.type = BodyType::fixed; // it needs no mass
    impl_->check_description(probe, "looking at");
    probe.type = BodyType::dynamic; // it meets everybody
    std::vector<BodyId> out;
    for (const std::int32_t body : impl_->overlapping(size(), probe, {}))
        out.push_back(impl_->id(static_cast<std::size_t>(body)));
    return out;
}

std::vector<BodyId> World::bodies_in(const Vec3& lower, const Vec3& upper) const {
    const DefaultFloatingPoint environment;
    require_finite("the lower corner of a box", lower);
    require_finite("the upper corner of a box", upper);
    if (!(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z))
        throw InputError("the lower corner of a box must not be above the upper one");
    impl_->stepper->place_changed();
    std::vector<BodyId> out;
    const Box box{lower, upper};
    for (std::size_t i = 0; i < size(); ++i)
        if (impl_->now.present[i] != 0 && boxes_overlap(impl_->stepper->trajectories().start_box(i), box, 0) &&
            meets_box(impl_->placed(i), box))
            out.push_back(impl_->id(i));
    return out;
}

std::vector<NamedPair> World::ignored_groups() const { return impl_->now.ignored_groups; }
std::vector<NamedPair> World::ignored_bodies() const { return impl_->now.ignored_bodies; }

BodyContacts World::contacts_of(BodyId body) const {
    const DefaultFloatingPoint environment;
    const std::size_t i = impl_->place(body);
    const Vec3 center = impl_->stepper->state().pose[i].com;
    const double per_step = 1 / settings().time_step;
    BodyContacts out;
    for (const std::size_t k : impl_->contacts_of(i)) {
        const ContactState& c = (*impl_->contact_list)[k];
        const Vec3 force = (c.body_b == body.index ? per_step : -per_step) * c.impulse;
        out.force += force;
        const Vec3 point = c.body_b == body.index ? c.point + c.across : c.point;
        out.torque += cross(point - center, force);
        out.contacts.push_back(c);
    }
    return out;
}

MemoryUse World::memory() const {
    MemoryUse out;
    const Model& model = impl_->stepper->model();
    for (const RigidShape& shape : model.shapes) out.shapes += bytes_of(shape);
    const StepperMemory solver = impl_->stepper->memory();
    out.bodies = solver.bodies;
    out.contacts = solver.contacts + bytes_of(*impl_->contact_list) + bytes_of(impl_->contact_places) +
                   bytes_of(impl_->end_of_body);
    out.pairs = solver.pairs;
    return out;
}

} // namespace flotilla
