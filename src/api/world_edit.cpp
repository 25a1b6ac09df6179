// SPDX-License-Identifier: MIT
// Changes of a World between steps, as its public face has them.
#include <algorithm>
#include <utility>

#include <flotilla/error.hpp>

#include "api/world_impl.hpp"
#include "base/floating_point.hpp"
#include "base/vec3.hpp"

namespace flotilla {

BodyId World::apply(const Edit& edit) {
    const DefaultFloatingPoint environment;
    Impl& w = *impl_;
    if (!w.whole) throw Error("an earlier call failed half-way: the World cannot go on, a snapshot taken before can");
    BodyId body;
    try {
        body = std::visit(w, edit.change);
    } catch (const InputError& e) {
        w.say(std::string("refused: ") + e.what());
        throw;
    } catch (const OverlapError& e) {
        w.say(std::string("refused: ") + e.what());
        throw;
    } catch (...) { // memory may be refused
        w.whole = false;
        throw;
    }
    w.now.hash = chained(w.now.hash, edit, steps());
    w.stepper->set_edits_hash(w.now.hash);
    w.contacts_of_step = -1;
    if (w.record.on) w.record.add({steps(), edit.change}, w.now.hash);
    return body;
}

std::int32_t World::add_shape(ShapeDescription shape) { return apply({0, edits::AddShape{std::move(shape)}}).index; }
void World::remove_shape(std::int32_t shape) { apply({0, edits::RemoveShape{shape}}); }
BodyId World::add_body(BodyDescription body) { return apply({0, edits::AddBody{std::move(body)}}); }
void World::remove_body(BodyId body) { apply({0, edits::RemoveBody{body}}); }
void World::set_pose(BodyId body, const Vec3& position, const Quat& rotation) {
    apply({0, edits::SetPose{body, position, rotation}});
}
void World::set_velocity(BodyId body, const Vec3& velocity, const Vec3& angular_velocity) {
    apply({0, edits::SetVelocity{body, velocity, angular_velocity}});
}
void World::set_type(BodyId body, BodyType type) { apply({0, edits::SetType{body, type}}); }
void World::set_script(BodyId body, std::vector<Keyframe> keyframes) {
    apply({0, edits::SetScript{body, std::move(keyframes)}});
}
void World::set_material(BodyId body, double friction, double restitution) {
    apply({0, edits::SetMaterial{body, friction, restitution}});
}
void World::set_force(BodyId body, const Vec3& force, const Vec3& torque) {
    apply({0, edits::SetForce{body, force, torque}});
}
void World::apply_force(BodyId body, const Vec3& force, const Vec3& point) {
    const Vec3 arm = point - impl_->stepper->state().pose[impl_->place(body)].com;
    apply({0, edits::ApplyForce{body, force, cross(arm, force)}});
}
void World::apply_torque(BodyId body, const Vec3& torque) { apply({0, edits::ApplyForce{body, {}, torque}}); }
void World::apply_impulse(BodyId body, const Vec3& impulse, const Vec3& point) {
    const Vec3 arm = point - impl_->stepper->state().pose[impl_->place(body)].com;
    apply({0, edits::ApplyImpulse{body, impulse, cross(arm, impulse)}});
}
void World::set_gravity(const Vec3& gravity) { apply({0, edits::SetGravity{gravity}}); }
void World::set_group(BodyId body, const std::string& group) { apply({0, edits::SetGroup{body, group}}); }
void World::ignore_groups(const std::string& a, const std::string& b, bool ignored) {
    apply({0, edits::IgnoreGroups{a, b, ignored}});
}
void World::ignore_pair(BodyId a, BodyId b, bool ignored) { apply({0, edits::IgnorePair{a, b, ignored}}); }
void World::wake(BodyId body) { apply({0, edits::Wake{body}}); }

void World::set_force_callback(std::function<void(World&)> callback) { impl_->force_callback = std::move(callback); }
void World::set_observer(std::function<bool(Phase)> observer) { impl_->observer = std::move(observer); }
void World::set_log(std::function<void(const std::string&)> log) { impl_->log = std::move(log); }
void World::record_edits(bool record) {
    if (record && !impl_->record.leads_to(impl_->now.hash)) impl_->record.begin(impl_->now.hash);
    impl_->record.on = record;
}
const std::vector<Edit>& World::recorded_edits() const {
    if (impl_->record.broken)
        throw Error("the recorded edits do not lead here: the World was restored to a snapshot with others "
                    "(record_edits() begins anew)");
    return impl_->record.edits;
}

void EditRecord::begin(std::uint64_t hash) {
    edits.clear(), hashes.clear();
    start = hash;
    broken = false;
}

bool EditRecord::leads_to(std::uint64_t hash) const { return !broken && !edits.empty() && hashes.back() == hash; }

void EditRecord::add(const Edit& edit, std::uint64_t hash) {
    if (broken) return;
    edits.push_back(edit), hashes.push_back(hash);
}

void EditRecord::go_to(std::uint64_t hash) {
    if (!on && edits.empty()) return;
    const auto last = std::find(hashes.begin(), hashes.end(), hash);
    broken = last == hashes.end() && hash != start;
    if (broken) return;
    const auto kept = last == hashes.end() ? 0 : last - hashes.begin() + 1;
    edits.resize(static_cast<std::size_t>(kept)), hashes.resize(static_cast<std::size_t>(kept));
}

} // namespace flotilla
