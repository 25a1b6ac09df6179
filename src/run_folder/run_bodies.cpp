// SPDX-License-Identifier: MIT
#include "run_folder/run_bodies.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <flotilla/error.hpp>

#include "scene/description_checks.hpp"
#include "state/keyframes.hpp"

namespace flotilla::io {
namespace {

template <class Pair>
void set(std::vector<Pair>& list, const Pair& pair, bool ignored) {
    std::erase(list, pair);
    if (ignored) list.push_back(pair);
}

NamedPair sorted(const std::string& a, const std::string& b) { return {std::min(a, b), std::max(a, b)}; }

} // namespace

std::string name_of(const Edit& edit) {
    return (edit.place.empty() ? "edit" : edit.place + ": edit") + " after step " + std::to_string(edit.step);
}

RunBodies::RunBodies(const SceneDescription& scene, std::span<const Edit> edits)
    : edits_(edits), time_step_(scene.settings.time_step), next_body_(scene.bodies.size()), bodies_(scene.bodies) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        place_of_.push_back(static_cast<std::int32_t>(i));
        body_at_.push_back(static_cast<std::int32_t>(i));
    }
    // Names of bodies and shapes that come later: as the World gives them.
    std::vector<ShapeDescription> shapes; // by number in the World, names alone; of removed ones none
    for (const ShapeDescription& shape : scene.shapes) shapes.emplace_back().name = shape.name;
    std::vector<std::uint32_t> generation(bodies_.size(), 0);
    std::vector<bool> present(bodies_.size(), true);
    std::vector<std::int32_t> shape_of(shapes.size()); // by number: the place in added_shapes_, after the scene's
    std::iota(shape_of.begin(), shape_of.end(), 0);
    const auto scene_shapes = static_cast<std::ptrdiff_t>(shapes.size());
    for (const Edit& edit : edits) {
        if (const auto* e = std::get_if<edits::AddShape>(&edit.change)) {
            added_shapes_.push_back(e->shape);
            shape_adders_.push_back(name_of(edit));
            std::string& name = added_shapes_.back().name;
            if (name.empty()) name = default_shape_name(shapes);
            const auto free = std::find_if(shapes.begin() + scene_shapes, shapes.end(),
                                           [](const ShapeDescription& s) { return s.name.empty(); });
            const auto k = static_cast<std::size_t>(free - shapes.begin());
            if (free == shapes.end()) shapes.emplace_back(), shape_of.push_back(0);
            shapes[k].name = name;
            shape_of[k] = static_cast<std::int32_t>(scene.shapes.size() + added_shapes_.size()) - 1;
        }
        if (const auto* e = std::get_if<edits::RemoveShape>(&edit.change)) {
            if (e->shape < 0 || static_cast<std::size_t>(e->shape) >= shapes.size())
                throw InputError("edits: shape " + std::to_string(e->shape) + " does not exist");
            shapes[static_cast<std::size_t>(e->shape)].name.clear();
        }
        if (const auto* e = std::get_if<edits::RemoveBody>(&edit.change)) {
            const auto i = static_cast<std::size_t>(e->body.index);
            if (i >= present.size()) throw InputError("edits: body " + std::to_string(i) + " does not exist");
            present[i] = false, ++generation[i];
        }
        if (const auto* e = std::get_if<edits::AddBody>(&edit.change)) {
            const auto i = static_cast<std::size_t>(std::find(present.begin(), present.end(), false) - present.begin());
            if (i == present.size()) present.push_back(false), generation.push_back(0);
            present[i] = true;
            bodies_.push_back(e->body);
            if (std::int32_t& shape = bodies_.back().shape;
                shape >= 0 && static_cast<std::size_t>(shape) < shape_of.size())
                shape = shape_of[static_cast<std::size_t>(shape)];
            if (bodies_.back().name.empty()) bodies_.back().name = default_body_name(i, generation[i]);
        }
    }
    place_of_.resize(bodies_.size(), -1);
    for (const BodyDescription& body : bodies_) type_.push_back(body.type), group_.push_back(body.group);
    for (const NamedPair& pair : scene.ignored_groups) set(ignored_groups_, sorted(pair.a, pair.b), true);
    const auto index = [&](const std::string& name) {
        const auto found = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                        [&](const BodyDescription& body) { return body.name == name; });
        return static_cast<std::size_t>(found - scene.bodies.begin());
    };
    for (const NamedPair& pair : scene.ignored_bodies)
        ignored_bodies_.emplace_back(std::minmax(index(pair.a), index(pair.b)));
}

std::span<const Edit> RunBodies::advance(std::int64_t step) {
    const std::size_t first = made_;
    placed_.clear();
    for (; made_ < edits_.size() && edits_[made_].step <= step; ++made_) make(edits_[made_]);
    return edits_.subspan(first, made_ - first);
}

std::size_t RunBodies::body_of(BodyId id) const {
    const bool there = id.index >= 0 && static_cast<std::size_t>(id.index) < body_at_.size() && body_at(id.index) >= 0;
    if (!there) throw InputError("edits: body " + std::to_string(id.index) + " is not there");
    return static_cast<std::size_t>(body_at(id.index));
}

/// Where the World puts a body that comes after a step.
RunBodies::Placed RunBodies::start_of(std::size_t i, std::int64_t step) const {
    const BodyDescription& body = bodies_[i];
    if (body.type != BodyType::kinematic || body.keyframes.empty()) return {i, body.position, body.rotation};
    const KeyframePlace place = keyframe_place(body.keyframes, static_cast<double>(step) * time_step_);
    return {i, place.position, place.rotation};
}

void RunBodies::make(const Edit& edit) {
    if (std::holds_alternative<edits::AddBody>(edit.change)) {
        const auto free = std::find(body_at_.begin(), body_at_.end(), -1);
        const auto place = static_cast<std::int32_t>(free - body_at_.begin());
        if (free == body_at_.end()) body_at_.push_back(-1);
        body_at_[static_cast<std::size_t>(place)] = static_cast<std::int32_t>(next_body_);
        place_of_[next_body_] = place;
        placed_.push_back(start_of(next_body_++, edit.step));
    } else if (const auto* removed = std::get_if<edits::RemoveBody>(&edit.change)) {
        const std::size_t body = body_of(removed->body);
        place_of_[body] = -1;
        body_at_[static_cast<std::size_t>(removed->body.index)] = -1;
        std::erase_if(ignored_bodies_, [&](const auto& p) { return p.first == body || p.second == body; });
    } else if (const auto* pose = std::get_if<edits::SetPose>(&edit.change)) {
        placed_.push_back({body_of(pose->body), pose->position, pose->rotation});
    } else if (const auto* type = std::get_if<edits::SetType>(&edit.change)) {
        type_[body_of(type->body)] = type->type;
    } else if (const auto* script = std::get_if<edits::SetScript>(&edit.change)) {
        type_[body_of(script->body)] = BodyType::kinematic;
    } else if (const auto* group = std::get_if<edits::SetGroup>(&edit.change)) {
        group_[body_of(group->body)] = group->group;
    } else if (const auto* groups = std::get_if<edits::IgnoreGroups>(&edit.change)) {
        set(ignored_groups_, sorted(groups->a, groups->b), groups->ignored);
    } else if (const auto* pair = std::get_if<edits::IgnorePair>(&edit.change)) {
        set(ignored_bodies_, {std::minmax(body_of(pair->a), body_of(pair->b))}, pair->ignored);
    }
}

bool RunBodies::ignored(std::size_t a, std::size_t b) const {
    const auto has = [](const auto& list, const auto& pair) {
        return std::find(list.begin(), list.end(), pair) != list.end();
    };
    if (!group_[a].empty() && !group_[b].empty() && has(ignored_groups_, sorted(group_[a], group_[b]))) return true;
    return has(ignored_bodies_, std::pair<std::size_t, std::size_t>(std::minmax(a, b)));
}

} // namespace flotilla::io
