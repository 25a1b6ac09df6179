// SPDX-License-Identifier: MIT
// What each edit of a World checks and does. Nothing changes before all is checked.
#include <algorithm>
#include <array>
#include <utility>

#include "api/world_impl.hpp"
#include "base/error_list.hpp"
#include "base/floating_point.hpp"
#include "base/index.hpp"
#include "base/rotation.hpp"
#include "base/text.hpp"
#include "scene/description_checks.hpp"
#include "scene/initial_overlap.hpp"
#include "scene/length_checks.hpp"
#include "state/build_model.hpp"
#include "state/rotation_step.hpp"
#include "step/scripts.hpp"

namespace flotilla {
namespace {

/// A shape as far as lengths are checked.
Shape lengths_of(const RigidShape& shape) {
    Shape out;
    out.sphere.radius = 0.5 * shape.size;
    out.extent = shape.extent;
    out.center = shape.center_of_mass;
    out.radius = shape.radius;
    out.longest_edge = shape.longest_edge;
    return out;
}

/// A description of a body that stands at a pose, and that nothing moves or locks.
BodyDescription alone_at(const Pose& pose, BodyDescription body) {
    body.position = pose.origin, body.rotation = pose.rotation;
    body.velocity = body.angular_velocity = body.force = body.torque = {};
    body.locked_translation = body.locked_rotation = {};
    body.keyframes.clear();
    return body;
}

/// Where a body's entry is in a list by place, or would be.
template <class List>
auto entry_of(List& list, std::int32_t body) {
    return std::lower_bound(list.begin(), list.end(), body, [](const auto& p, std::int32_t b) { return p.body < b; });
}

/// Of a dynamic body, what alone_at() takes from it.
EditedBodies::Kept to_keep(std::int32_t place, const BodyDescription& body) {
    EditedBodies::Kept out{place, 0, body.force, body.torque};
    for (std::size_t axis = 0; axis < 3; ++axis)
        out.locked |= (body.locked_translation[axis] ? 1U : 0U) << axis | (body.locked_rotation[axis] ? 8U : 0U)
                                                                              << axis;
    return out;
}

void give_back(const EditedBodies::Kept& kept, BodyDescription& body) {
    body.force = kept.force, body.torque = kept.torque;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        body.locked_translation[axis] = (kept.locked >> axis & 1U) != 0;
        body.locked_rotation[axis] = (kept.locked >> axis & 8U) != 0;
    }
}

void require_finite(const std::string& what, const Vec3& v, double most, const char* unit) {
    if (is_finite(v) && max_component(abs(v)) <= most) return;
    throw InputError(what + " must be finite and below " + to_text(most) + " " + unit);
}

/// What stands in for a removed shape, in the model: places of removed bodies have it.
RigidShape shape_of_nobody() {
    SceneDescription scene;
    ShapeDescription& shape = scene.shapes.emplace_back();
    shape.name = "removed";
    shape.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    shape.triangles = {{0, 1, 2}};
    return make_shape(build_scene(scene, "removed shape").shapes.front());
}

} // namespace

std::size_t World::Impl::place(BodyId body) const {
    const std::size_t i = at(body.index);
    if (body.index < 0 || i >= now.bodies.size())
        throw InputError("body " + std::to_string(body.index) + " does not exist: there are " +
                         std::to_string(now.bodies.size()));
    if (now.generation[i] != body.generation || now.present[i] == 0)
        throw InputError("body " + std::to_string(body.index) + " of generation " + std::to_string(body.generation) +
                         " was removed");
    return i;
}

PlacedShape World::Impl::placed(std::size_t body) const {
    return {&stepper->model().shape_of(body), stepper->trajectories().at_start(body).at0};
}

FilteredBodies World::Impl::filtered() const {
    if (now.bodies.empty()) return {};
    return filter_with(0, now.bodies.front());
}

BodyDescription World::Impl::as_it_stands(std::size_t body) const {
    BodyDescription out = now.bodies[body];
    const Pose& pose = stepper->state().pose[body];
    if (out.type != BodyType::kinematic) out.position = pose.origin, out.rotation = pose.rotation;
    out.velocity = out.angular_velocity = {};
    return out;
}

std::vector<std::int32_t> World::Impl::overlapping(std::size_t place, const BodyDescription& body,
                                                   const FilteredBodies& filter) const {
    stepper->place_changed();
    const Model& model = stepper->model();
    const RigidShape& shape = model.shapes[at(shape_of[at(body.shape)])];
    PlacedBody there;
    there.place(shape, pose_at_origin(shape, body.position, body.rotation));
    const PlacedShape mine{&shape, there.view()};
    std::vector<std::int32_t> found;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const Body& other = model.bodies[i];
        if (i == place || !other.present || (body.type != BodyType::dynamic && !other.dynamic())) continue;
        const Box& its_box = stepper->trajectories().start_box(i);
        if (!boxes_overlap(there.box, its_box, least_certified_distance(there.box, its_box))) continue;
        if (!filter.filter.empty() && place < filter.group.size() && filter.ignores(place, i)) continue;
        if (bodies_overlap(mine, placed(i))) found.push_back(static_cast<std::int32_t>(i));
    }
    return found;
}

void World::Impl::refuse_overlaps(const BodyDescription& body, std::size_t place, const FilteredBodies& filter) const {
    const std::vector<std::int32_t> others = overlapping(place, body, filter);
    if (others.empty()) return;
    std::string message;
    std::vector<OverlapError::Pair> pairs;
    const auto index = static_cast<std::int32_t>(place);
    for (const std::int32_t other : others) {
        const std::string& name = now.bodies[at(other)].name;
        message +=
            (message.empty() ? "body " : "\nbody ") + in_quotes(body.name) + " would intersect body " + in_quotes(name);
        OverlapError::Pair pair{{index, other, body.name, name}, 0};
        if (other < index) pair = {{other, index, name, body.name}, 0};
        pairs.push_back(pair);
    }
    throw OverlapError(message, std::move(pairs));
}

void World::Impl::check_description(BodyDescription& body, const char* doing) const {
    ErrorList errors(std::string(doing) + " body " + in_quotes(body.name));
    SceneDescription names; // of shapes, and whether they have a mass
    names.gravity = now.gravity;
    names.settings = settings;
    for (const ShapeDescription& shape : now.shapes) {
        names.shapes.emplace_back();
        names.shapes.back().name = shape.name;
        names.shapes.back().mass_kind = shape.mass_kind;
    }
    check_name(body.name, "", errors);
    if (body.shape >= 0 && at(body.shape) < now.shapes.size() && was_removed(now.shapes[at(body.shape)]))
        errors.add("/shape", "shape " + std::to_string(body.shape) + " was removed");
    check_body(body, names, "", errors);
    errors.throw_if_any();

    // Beside the body those that bound the lengths of the others.
    const Model& model = stepper->model();
    Scene scene;
    scene.gravity = now.gravity;
    scene.settings = settings;
    const auto add = [&](const RigidShape& shape, BodyDescription description) {
        description.shape = static_cast<std::int32_t>(scene.shapes.size());
        scene.shapes.push_back(lengths_of(shape));
        scene.bodies.push_back(std::move(description));
    };
    add(model.shapes[at(shape_of[at(body.shape)])], body);
    std::optional<std::size_t> finest, coarsest;
    for (std::size_t i = 0; i < model.size(); ++i) {
        if (!model.bodies[i].present) continue;
        if (model.bodies[i].dynamic() && (!finest || model.bodies[i].extent < model.bodies[*finest].extent)) finest = i;
        if (!coarsest || model.shape_of(i).longest_edge > model.shape_of(*coarsest).longest_edge) coarsest = i;
    }
    for (const auto& i : {finest, coarsest}) {
        if (!i) continue;
        BodyDescription other = now.bodies[*i];
        other.position = stepper->state().pose[*i].origin;
        other.rotation = stepper->state().pose[*i].rotation;
        other.velocity = {};
        add(model.shape_of(*i), other);
    }
    const RigidShape& shape = model.shapes[at(shape_of[at(body.shape)])];
    check_line(body, shape.line, "", errors);
    check_loads(body, shape, errors);
    check_lengths(scene, errors);
    errors.throw_if_any();
}

void World::Impl::check_loads(const BodyDescription& body, const RigidShape& shape, ErrorList& errors) const {
    if (body.type != BodyType::dynamic) return;
    const Vec3& m = shape.principal.moments;
    std::array moments{m.x, m.y, m.z};
    std::ranges::sort(moments);
    flotilla::check_loads(body, shape.mass, moments[shape.line == Vec3{} ? 0 : 1], settings.time_step, "", errors);
}

/// Description and model of a body that stays where it is.
void World::Impl::change(std::size_t body, BodyDescription description) {
    BodyDescription of_model = description;
    of_model.shape = shape_of[at(description.shape)];
    Body changed = make_body(stepper->model(), of_model);
    changed.group = stepper->model().bodies[body].group;
    const bool stops = description.type != BodyType::dynamic || !stepper->model().bodies[body].dynamic();
    keep(static_cast<std::int32_t>(body), description);
    stepper->change_body(static_cast<std::int32_t>(body), changed);
    if (stops && description.type != now.bodies[body].type) stepper->set_motion(static_cast<std::int32_t>(body), {});
    now.bodies[body] = std::move(description);
    if (now.bodies[body].type != BodyType::dynamic)
        std::erase_if(now.pushes, [&](const EditedBodies::Push& p) { return at(p.body) == body; });
    push(static_cast<std::int32_t>(body));
}

/// What a body that is dynamic no more, or is so again, is to have when it is.
void World::Impl::keep(std::int32_t body, const BodyDescription& changed) {
    const BodyDescription& before = now.bodies[at(body)];
    const auto k = entry_of(now.kept, body);
    const bool known = k != now.kept.end() && k->body == body;
    if (changed.type == BodyType::dynamic) {
        if (known) now.kept.erase(k);
    } else if (before.type == BodyType::dynamic) {
        now.kept.insert(k, to_keep(body, before));
    }
}

BodyId World::Impl::operator()(const edits::AddShape& edit) {
    ShapeDescription added = edit.shape;
    if (added.name.empty()) added.name = default_shape_name(now.shapes);
    const std::string doing = "adding shape " + in_quotes(added.name);
    if (std::any_of(now.shapes.begin(), now.shapes.end(), [&](const auto& s) { return s.name == added.name; }))
        throw InputError(doing + ": there is one of that name");
    SceneDescription alone;
    alone.settings = settings;
    alone.shapes.push_back(added);
    const Scene scene = build_scene(alone, doing);
    RigidShape shape = make_shape(scene.shapes.front());
    const auto free =
        std::find_if(now.shapes.begin() + static_cast<std::ptrdiff_t>(now.scene_shapes), now.shapes.end(), was_removed);
    const auto number = static_cast<std::int32_t>(free - now.shapes.begin());
    if (free == now.shapes.end()) {
        now.shapes.push_back(std::move(added));
        shape_of.push_back(stepper->add_shape(std::move(shape)));
    } else {
        *free = std::move(added);
        stepper->set_shape(shape_of[at(number)], std::move(shape));
    }
    return {number, 0};
}

BodyId World::Impl::operator()(const edits::RemoveShape& edit) {
    const std::string doing = "removing shape " + in_quotes(shape(edit.shape).name);
    if (at(edit.shape) < now.scene_shapes) throw InputError(doing + ": the shapes of the scene stay");
    for (std::size_t i = 0; i < now.bodies.size(); ++i)
        if (now.present[i] != 0 && now.bodies[i].shape == edit.shape)
            throw InputError(doing + ": body " + in_quotes(now.bodies[i].name) + " has it");
    stepper->set_shape(shape_of[at(edit.shape)], shape_of_nobody());
    now.shapes[at(edit.shape)] = {};
    return {};
}

BodyId World::Impl::operator()(const edits::AddBody& edit) {
    BodyDescription body = edit.body;
    const std::size_t i = at(stepper->free_place());
    if (body.name.empty()) body.name = default_body_name(i, i == now.bodies.size() ? 0 : now.generation[i]);
    if (place_of.contains(body.name))
        throw InputError("adding body " + in_quotes(body.name) + ": there is one of that name");
    check_description(body, "adding");
    if (i == now.bodies.size()) refuse_where_pinned("adding body " + in_quotes(body.name) + ": it takes a new place");
    BodyDescription of_model = body;
    of_model.shape = shape_of[at(body.shape)];
    const Model& model = stepper->model();
    const RigidShape& shape = model.shapes[at(of_model.shape)];
    Body added = make_body(model, of_model);
    Pose pose = pose_at_origin(shape, body.position, body.rotation);
    if (added.scripted()) { // keyframes count from the start of the scene
        pose = scripted_pose(shape, added, stepper->time());
        body.position = pose.origin, body.rotation = pose.rotation;
    }
    const FilteredBodies filter = filter_with(i, body);
    refuse_overlaps(body, i, filter);

    added.group = filter.group[i];
    Motion motion;
    if (added.dynamic())
        motion = {body.velocity,
                  free_part(added.locked.rotation,
                            angular_momentum(turned(shape.principal, body.rotation), body.angular_velocity))};
    stepper->add_body(added, pose, motion);
    if (added.scripted())
        body.position = body.keyframes.front().position, body.rotation = body.keyframes.front().rotation;
    describe(i, std::move(body));
    take_filter(filter);
    return id(i);
}

FilteredBodies World::Impl::filter_with(std::size_t place, const BodyDescription& body) const {
    if (now.ignored_groups.empty() && now.ignored_bodies.empty())
        return {{}, std::vector<std::int32_t>(std::max(now.bodies.size(), place + 1), -1)};
    std::vector<BodyDescription> bodies = now.bodies;
    bodies.resize(std::max(bodies.size(), place + 1));
    bodies[place] = body;
    return make_filter(bodies, now.ignored_groups, now.ignored_bodies);
}

/// A filter that says the same of everybody who is there changes nothing, and wakes nobody.
void World::Impl::take_filter(const FilteredBodies& filter, std::span<const std::int32_t> whose) {
    const Model& model = stepper->model();
    const auto same_group = [&](const Body& b) {
        return b.group == filter.group[static_cast<std::size_t>(&b - model.bodies.data())];
    };
    if (filter.filter == model.filter && std::all_of(model.bodies.begin(), model.bodies.end(), same_group)) return;
    stepper->set_filter(filter, whose);
}

/// Notes a body that came to a place.
void World::Impl::describe(std::size_t place, BodyDescription body) {
    if (place == now.bodies.size()) {
        now.bodies.emplace_back();
        now.present.push_back(0);
        now.generation.push_back(0);
        now.user_data.push_back(0);
    }
    place_of.emplace(body.name, static_cast<std::int32_t>(place));
    now.bodies[place] = std::move(body);
    now.present[place] = 1;
    now.user_data[place] = 0;
}

BodyId World::Impl::operator()(const edits::RemoveBody& edit) {
    const std::size_t i = place(edit.body);
    const std::string name = now.bodies[i].name;
    stepper->remove_body(edit.body.index);
    place_of.erase(name);
    now.present[i] = 0;
    ++now.generation[i];
    const std::int32_t shape = now.bodies[i].shape;
    now.bodies[i] = {};
    now.bodies[i].shape = shape;
    now.bodies[i].type = BodyType::fixed;
    std::erase_if(now.ignored_bodies, [&](const NamedPair& p) { return p.a == name || p.b == name; });
    std::erase_if(now.pushes, [&](const EditedBodies::Push& p) { return p.body == edit.body.index; });
    std::erase_if(now.kept, [&](const EditedBodies::Kept& k) { return k.body == edit.body.index; });
    take_filter(filtered());
    return {};
}

BodyId World::Impl::operator()(const edits::SetPose& edit) {
    const std::size_t i = place(edit.body);
    BodyDescription body = now.bodies[i];
    if (body.type == BodyType::kinematic)
        throw InputError("body " + in_quotes(body.name) + " is kinematic: its script says where it is");
    body.position = edit.position;
    body.rotation = edit.rotation;
    body.velocity = {};
    body.angular_velocity = {};
    check_description(body, "placing");
    refuse_overlaps(body, i, filtered());
    stepper->place_body(edit.body.index, pose_at_origin(stepper->model().shape_of(i), body.position, body.rotation));
    now.bodies[i].position = body.position;
    now.bodies[i].rotation = body.rotation;
    return edit.body;
}

BodyId World::Impl::operator()(const edits::SetVelocity& edit) {
    const std::size_t i = place(edit.body);
    BodyDescription body = as_it_stands(i);
    body.velocity = edit.velocity;
    body.angular_velocity = edit.angular_velocity;
    check_description(body, "setting the velocity of");
    const Quat& rotation = stepper->state().pose[i].rotation;
    stepper->set_motion(edit.body.index,
                        make_motion(stepper->model(), i, rotation, edit.velocity, edit.angular_velocity));
    return edit.body;
}

BodyId World::Impl::operator()(const edits::SetType& edit) {
    const std::size_t i = place(edit.body);
    BodyDescription body = now.bodies[i];
    if (edit.type == BodyType::kinematic)
        throw InputError("body " + in_quotes(body.name) + " becomes kinematic by a script (set_script)");
    if (edit.type == body.type) return edit.body;
    body = alone_at(stepper->state().pose[i], std::move(body));
    body.type = edit.type;
    const auto kept = entry_of(now.kept, edit.body.index);
    if (body.type == BodyType::dynamic && kept != now.kept.end() && kept->body == edit.body.index)
        give_back(*kept, body);
    check_description(body, "setting the type of");
    // Bodies of infinite mass may intersect each other.
    if (edit.type == BodyType::dynamic) refuse_overlaps(body, i, filtered());
    change(i, std::move(body));
    return edit.body;
}

BodyId World::Impl::operator()(const edits::SetScript& edit) {
    const std::size_t i = place(edit.body);
    BodyDescription body = now.bodies[i];
    const double time = stepper->time();
    for (const Keyframe& k : edit.keyframes)
        if (!(k.time > time))
            throw InputError("script of body " + in_quotes(body.name) + ": a keyframe at " + to_text(k.time) +
                             " s is not later than the time, " + to_text(time) + " s");
    const Pose& pose = stepper->state().pose[i];
    body = alone_at(pose, std::move(body));
    body.type = BodyType::kinematic;
    body.keyframes = {{0, pose.origin, pose.rotation}};
    if (time > 0) body.keyframes.push_back({time, pose.origin, pose.rotation});
    body.keyframes.insert(body.keyframes.end(), edit.keyframes.begin(), edit.keyframes.end());
    check_description(body, "setting the script of");
    change(i, std::move(body));
    return edit.body;
}

BodyId World::Impl::operator()(const edits::SetMaterial& edit) {
    const std::size_t i = place(edit.body);
    BodyDescription body = as_it_stands(i);
    body.friction = edit.friction;
    body.restitution = edit.restitution;
    check_description(body, "setting the material of");
    body = now.bodies[i]; // a hinge goes on turning from where it was placed
    body.friction = edit.friction;
    body.restitution = edit.restitution;
    change(i, std::move(body));
    return edit.body;
}

void World::Impl::require_dynamic(std::size_t body) const {
    if (!stepper->model().bodies[body].dynamic())
        throw InputError("body " + in_quotes(now.bodies[body].name) + " is not dynamic: nothing pushes it");
}

BodyId World::Impl::operator()(const edits::SetForce& edit) {
    const std::size_t i = place(edit.body);
    require_dynamic(i);
    BodyDescription body = as_it_stands(i);
    body.force = edit.force;
    body.torque = edit.torque;
    check_description(body, "setting the force on");
    if (const auto p = entry_of(now.pushes, edit.body.index); p != now.pushes.end() && p->body == edit.body.index) {
        body.force += p->force, body.torque += p->torque;
        ErrorList errors("setting the force on body " + in_quotes(body.name) + ", with what pushes it in this step");
        check_loads(body, stepper->model().shape_of(i), errors);
        errors.throw_if_any();
    }
    now.bodies[i].force = edit.force;
    now.bodies[i].torque = edit.torque;
    stepper->wake(edit.body.index);
    push(edit.body.index);
    return edit.body;
}

BodyId World::Impl::operator()(const edits::ApplyForce& edit) {
    const std::size_t i = place(edit.body);
    require_dynamic(i);
    auto p = entry_of(now.pushes, edit.body.index);
    const bool known = p != now.pushes.end() && p->body == edit.body.index;
    const Vec3 force = known ? p->force + edit.force : edit.force,
               torque = known ? p->torque + edit.torque : edit.torque;
    const std::string on = " on body " + in_quotes(now.bodies[i].name);
    require_finite("the force" + on, force, kMaxForce, "N");
    require_finite("the torque" + on + " (about its centre of mass)", torque, kMaxForce, "N m");
    BodyDescription pushed = now.bodies[i];
    pushed.force += force, pushed.torque += torque;
    ErrorList errors("pushing body " + in_quotes(pushed.name));
    check_loads(pushed, stepper->model().shape_of(i), errors);
    errors.throw_if_any();
    if (!known) p = now.pushes.insert(p, {edit.body.index, 0, {}, {}});
    p->force = force;
    p->torque = torque;
    stepper->wake(edit.body.index);
    push(edit.body.index);
    return edit.body;
}

/// Tells the solver what acts on a body in the next step.
void World::Impl::push(std::int32_t body) {
    Vec3 force = now.bodies[at(body)].force, torque = now.bodies[at(body)].torque;
    if (const auto p = entry_of(now.pushes, body); p != now.pushes.end() && p->body == body)
        force += p->force, torque += p->torque;
    stepper->set_force(body, force, torque);
}

void World::Impl::clear_pushes() {
    const std::vector<EditedBodies::Push> made = std::exchange(now.pushes, {});
    for (const EditedBodies::Push& p : made) push(p.body);
}

BodyId World::Impl::operator()(const edits::ApplyImpulse& edit) {
    const std::size_t i = place(edit.body);
    const Body& body = stepper->model().bodies[i];
    require_dynamic(i);
    const std::string on = " on body " + in_quotes(now.bodies[i].name);
    require_finite("impulse" + on, edit.impulse, kMaxForce, "N s");
    require_finite("angular impulse" + on, edit.angular_impulse, kMaxForce, "N m s");
    Motion motion = stepper->state().motion[i];
    motion.velocity += body.inverse_mass * free_part(body.locked.translation, edit.impulse);
    motion.momentum += free_part(body.locked.rotation, edit.angular_impulse);
    const Vec3 omega = angular_velocity(stepper->model(), i, stepper->state().pose[i].rotation, motion.momentum);
    require_finite("the velocity after the impulse" + on, motion.velocity, kMaxCoordinate, "m/s");
    require_finite("the angular velocity after the impulse" + on, omega, kMaxAngularVelocity, "rad/s");
    stepper->set_motion(edit.body.index, motion);
    return edit.body;
}

BodyId World::Impl::operator()(const edits::SetGravity& edit) {
    require_finite("gravity", edit.gravity, kMaxGravity, "m/s^2");
    now.gravity = edit.gravity;
    stepper->set_gravity(edit.gravity);
    return {};
}

/// Bodies that were let through each other and shall meet must be apart where they are. `body`: it is about its pairs
/// alone.
void World::Impl::check_filter(const FilteredBodies& filter, const std::string& doing,
                               std::optional<std::size_t> body) const {
    stepper->place_changed();
    const Model& model = stepper->model();
    const auto check_pair = [&](std::size_t i, std::size_t k) {
        const bool meet = model.bodies[i].present && model.bodies[k].present &&
                          (model.bodies[i].dynamic() || model.bodies[k].dynamic());
        if (i == k || !meet || !model.ignores(static_cast<std::int32_t>(i), static_cast<std::int32_t>(k)) ||
            filter.ignores(i, k) || !bodies_overlap(placed(i), placed(k)))
            return;
        const BodyNames names =
            pair(static_cast<std::int32_t>(std::min(i, k)), static_cast<std::int32_t>(std::max(i, k)));
        throw OverlapError(doing + ": bodies " + in_quotes(names.name_a) + " and " + in_quotes(names.name_b) +
                               " intersect",
                           {{names, 0}});
    };
    if (model.filter.empty()) return; // everybody met
    for (std::size_t i = 0; i < model.size(); ++i) {
        if (body)
            check_pair(*body, i);
        else
            for (std::size_t k = i + 1; k < model.size(); ++k) check_pair(i, k);
    }
}

BodyId World::Impl::operator()(const edits::SetGroup& edit) {
    const std::size_t i = place(edit.body);
    const std::string doing = "group of body " + in_quotes(now.bodies[i].name);
    if (!edit.group.empty()) {
        ErrorList errors(doing);
        check_name(edit.group, "", errors);
        errors.throw_if_any();
    }
    BodyDescription body = now.bodies[i];
    body.group = edit.group;
    const FilteredBodies filter = filter_with(i, body);
    check_filter(filter, doing, i);
    now.bodies[i].group = edit.group;
    take_filter(filter, {{edit.body.index}});
    return edit.body;
}

namespace {

std::vector<NamedPair> with_pair(std::vector<NamedPair> list, const std::string& a, const std::string& b,
                                 bool ignored) {
    const NamedPair pair{std::min(a, b), std::max(a, b)};
    std::erase_if(list, [&](const NamedPair& p) { return p == pair || p == NamedPair{pair.b, pair.a}; });
    if (ignored) list.push_back(pair);
    return list;
}

} // namespace

BodyId World::Impl::operator()(const edits::IgnoreGroups& edit) {
    if (edit.a.empty() || edit.b.empty()) throw InputError("a group to be ignored needs a name");
    std::vector<NamedPair> groups = with_pair(now.ignored_groups, edit.a, edit.b, edit.ignored);
    const FilteredBodies filter = make_filter(now.bodies, groups, now.ignored_bodies);
    check_filter(filter, "groups " + in_quotes(edit.a) + " and " + in_quotes(edit.b), {});
    now.ignored_groups = std::move(groups);
    std::vector<std::int32_t> whose;
    for (std::size_t i = 0; i < now.bodies.size(); ++i)
        if (stepper->model().bodies[i].dynamic() && (now.bodies[i].group == edit.a || now.bodies[i].group == edit.b))
            whose.push_back(static_cast<std::int32_t>(i));
    take_filter(filter, whose);
    return {};
}

BodyId World::Impl::operator()(const edits::IgnorePair& edit) {
    const std::size_t a = place(edit.a), b = place(edit.b);
    if (a == b) throw InputError("body " + in_quotes(now.bodies[a].name) + " cannot meet itself");
    std::vector<NamedPair> pairs = with_pair(now.ignored_bodies, now.bodies[a].name, now.bodies[b].name, edit.ignored);
    const FilteredBodies filter = make_filter(now.bodies, now.ignored_groups, pairs);
    check_filter(filter, "a pair that shall meet", a);
    now.ignored_bodies = std::move(pairs);
    std::vector<std::int32_t> whose;
    for (const std::size_t i : {a, b})
        if (stepper->model().bodies[i].dynamic()) whose.push_back(static_cast<std::int32_t>(i));
    take_filter(filter, whose);
    return {};
}

BodyId World::Impl::operator()(const edits::Wake& edit) {
    (void)place(edit.body);
    stepper->wake(edit.body.index);
    return edit.body;
}

namespace {

void set_bodies(const EditedBodies& edited, std::span<const std::int32_t> shapes, Model& model) {
    model.bodies.clear();
    for (std::size_t i = 0; i < edited.bodies.size(); ++i) {
        BodyDescription body = edited.bodies[i];
        body.shape = shapes[at(body.shape)];
        model.bodies.push_back(edited.present[i] != 0 ? make_body(model, body) : absent_body(model, body.shape));
    }
    for (const EditedBodies::Push& p : edited.pushes) {
        model.bodies[at(p.body)].force += p.force;
        model.bodies[at(p.body)].torque += p.torque;
    }
    const FilteredBodies filtered = make_filter(edited.bodies, edited.ignored_groups, edited.ignored_bodies);
    model.filter = filtered.filter;
    for (std::size_t i = 0; i < model.size(); ++i) model.bodies[i].group = filtered.group[i];
    model.gravity = edited.gravity;
    model.list_active();
}

} // namespace

void World::Impl::take_edits(const EditedBodies& edited, std::vector<std::int32_t>& shapes, Model& model) const {
    for (std::size_t k = edited.scene_shapes; k < edited.shapes.size(); ++k) {
        if (was_removed(edited.shapes[k])) {
            shapes.push_back(static_cast<std::int32_t>(model.shapes.size()));
            model.shapes.push_back(shape_of_nobody());
            continue;
        }
        SceneDescription alone;
        alone.settings = settings;
        alone.shapes.push_back(edited.shapes[k]);
        const Scene scene = build_scene(alone, "damaged snapshot");
        shapes.push_back(static_cast<std::int32_t>(model.shapes.size()));
        model.shapes.push_back(make_shape(scene.shapes.front()));
    }
    set_bodies(edited, shapes, model);
}

void World::Impl::undo_edits(Model& model) const {
    const auto in_scene = shape_of.begin() + static_cast<std::ptrdiff_t>(start.scene_shapes);
    const auto last = std::max_element(shape_of.begin(), in_scene);
    model.shapes.resize(last == in_scene ? 0 : at(*last) + 1);
    set_bodies(start, {shape_of.data(), start.scene_shapes}, model);
}

} // namespace flotilla
