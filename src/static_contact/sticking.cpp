// SPDX-License-Identifier: MIT
#include "static_contact/sticking.hpp"

#include "base/index.hpp"

namespace flotilla {

void LastVelocities::load(Team* team, const Model& model, const VelocityArrays& bodies,
                          std::span<const Motion> last_motion) {
    constexpr std::size_t kBodyGrain = 64; // bodies of a task
    linear.resize(model.size());
    angular.resize(model.size());
    for_each(team, "last velocities", model.size(), kBodyGrain, [&](std::size_t i) {
        const bool movable = model.bodies[i].movable();
        linear[i] = movable ? last_motion[i].velocity : bodies.velocity[i];
        angular[i] = movable ? bodies.inverse_inertia[i] * last_motion[i].momentum : bodies.angular_velocity[i];
    });
}

bool sticks(const Contact& contact, double limit, const VelocityArrays& bodies, const LastVelocities& last) {
    const auto point_velocity = [&](std::int32_t body) {
        return last.linear[at(body)] +
               cross(last.angular[at(body)], point_on(contact, body) - bodies.position[at(body)]);
    };
    const Vec3 v = point_velocity(contact.b) - point_velocity(contact.a);
    return length_sq(v - dot(v, contact.normal) * contact.normal) < limit * limit;
}

} // namespace flotilla
