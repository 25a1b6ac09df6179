// SPDX-License-Identifier: MIT
// Bodies and contacts written by hand, as the contact solver wants them.
#pragma once

#include <vector>

#include "base/vec3.hpp"
#include "static_contact/solve_contacts.hpp"

namespace flotilla {

/// Bodies with contacts; `impulses` keeps the last result and is the next warm start.
struct ContactWorld {
    std::vector<Vec3> position, velocity, angular_velocity;
    std::vector<double> inv_mass;
    std::vector<Mat3> inv_inertia;
    std::vector<AxisMask> locked;
    std::vector<Contact> contacts;
    std::vector<Vec3> impulses;
    ContactScratch scratch;

    /// mass 0: infinite. `inertia` holds principal values in world axes; 0: cannot turn.
    std::int32_t add_body(double mass, const Vec3& inertia = {}, const Vec3& x = {}) {
        const auto inverse = [](double v) { return v > 0 ? 1 / v : 0.0; };
        position.push_back(x);
        velocity.push_back({});
        angular_velocity.push_back({});
        inv_mass.push_back(inverse(mass));
        inv_inertia.push_back(diagonal({inverse(inertia.x), inverse(inertia.y), inverse(inertia.z)}));
        locked.push_back(0);
        return static_cast<std::int32_t>(position.size()) - 1;
    }

    void add_contact(std::int32_t a, std::int32_t b, const Vec3& point, const Vec3& normal, double friction = 0,
                     double target = 0) {
        contacts.push_back({.a = a,
                            .b = b,
                            .point = point,
                            .normal = normal,
                            .target = target,
                            .friction = friction,
                            .feature_key = contacts.size()});
        impulses.emplace_back();
    }

    ContactBodies bodies() { return {position, velocity, angular_velocity, inv_mass, inv_inertia, locked, {}}; }

    ContactSolveStats solve(const ContactSolveOptions& options) {
        return solve_contacts(contacts, bodies(), options, impulses, scratch);
    }

    Vec3 velocity_at(std::int32_t body, const Vec3& point) const {
        const auto i = static_cast<std::size_t>(body);
        return velocity[i] + cross(angular_velocity[i], point - position[i]);
    }

    Vec3 momentum() const {
        Vec3 p;
        for (std::size_t i = 0; i < position.size(); ++i)
            if (inv_mass[i] > 0) p += velocity[i] / inv_mass[i];
        return p;
    }

    /// About the world's origin. Inertia must be diagonal.
    Vec3 angular_momentum() const {
        Vec3 l;
        for (std::size_t i = 0; i < position.size(); ++i) {
            if (!(inv_mass[i] > 0)) continue;
            l += cross(position[i], velocity[i] / inv_mass[i]) + spin(i);
        }
        return l;
    }

    double kinetic_energy() const {
        double e = 0;
        for (std::size_t i = 0; i < position.size(); ++i)
            if (inv_mass[i] > 0) e += length_sq(velocity[i]) / inv_mass[i] + dot(angular_velocity[i], spin(i));
        return e / 2;
    }

  private:
    Vec3 spin(std::size_t i) const {
        const auto part = [](double w, double inv) { return inv > 0 ? w / inv : 0.0; };
        const Mat3& j = inv_inertia[i];
        return {part(angular_velocity[i].x, j.m[0]), part(angular_velocity[i].y, j.m[4]),
                part(angular_velocity[i].z, j.m[8])};
    }
};

} // namespace flotilla
