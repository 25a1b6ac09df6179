// SPDX-License-Identifier: MIT
#include "physics/problems/falling_cube.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "scene/scene.hpp"

namespace flotilla::physics {
namespace {

constexpr double kEdge = 0.6;                      // m
constexpr double kSoonest = 0.5 * 0.125 / 10;      // m, the lowest gap
constexpr double kCubeInertia = kEdge * kEdge / 6; // m^2, of unit mass

Quat rotation_of(int number) {
    return rotation_from_vector({0.9 * (number % 5) - 2, 0.37 * number, 1.3 * (number % 7)});
}

double gap_of(int number) { return kSoonest * (2 * (number % 10) + 1); }

using Corners = std::array<Vec3, 8>;

Corners corners(const Quat& rotation) {
    Corners out;
    for (std::size_t i = 0; i < 8; ++i)
        out[i] = 0.5 * kEdge * rotate(rotation, {i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
    return out;
}

double lowest(const Corners& c) {
    double z = 0;
    for (const Vec3& x : c) z = std::min(z, x.z);
    return z;
}

struct Cube {
    Quat rotation;
    double height = 0, velocity = -kCubeFall; // m, m/s, of its centre
    Vec3 spin{};

    [[nodiscard]] Cube after(double time) const {
        Cube out = *this;
        out.rotation = normalized(rotation_from_vector(time * spin) * rotation);
        out.height += time * velocity;
        return out;
    }
    [[nodiscard]] double speed_of(const Vec3& corner) const { return velocity + cross(spin, corner).z; }
    /// The lowest corner that is in the ground and goes on; rounding is neither.
    [[nodiscard]] std::optional<Vec3> sinking() const {
        const Corners all = corners(rotation);
        std::optional<Vec3> out;
        for (const Vec3& x : all)
            if (height + x.z < 0 && speed_of(x) < -1e-9 && (!out || x.z < out->z)) out = x;
        return out;
    }
    /// An impulse at the corner that stops it.
    void stop(const Vec3& corner) {
        const Vec3 turn = cross(corner, {0, 0, 1});
        const double impulse = -speed_of(corner) / (1 + length_sq(turn) / kCubeInertia);
        velocity += impulse;
        spin += (impulse / kCubeInertia) * turn;
    }
};

/// s, from 0 to `most`: just after the next corner has reached the ground.
std::optional<double> next_hit(const Cube& cube, double most) {
    constexpr double kLook = 5e-4; // s
    for (double t = 0; t < most; t += kLook) {
        if (!cube.after(t + kLook).sinking()) continue;
        double before = t, after = t + kLook;
        for (int i = 0; i < 50; ++i) {
            const double middle = 0.5 * (before + after);
            (cube.after(middle).sinking() ? after : before) = middle;
        }
        return after;
    }
    return std::nullopt;
}

} // namespace

SceneDescription falling_cube(const Start& start, int number) {
    SceneDescription scene = make_scene_with(start.settings, {});
    const Quat rotation = rotation_of(number);
    auto& body = add_body(scene, add_solid(scene, make_box(kEdge, kEdge, kEdge), 200), BodyType::dynamic,
                          {0, 0, gap_of(number) - lowest(corners(rotation))}, 0, 0);
    body.rotation = rotation;
    body.velocity = {0, 0, -kCubeFall};
    add_ground(scene, 20, 0, 0);
    return scene;
}

double due_rise_of_cube(int number, double duration) {
    Cube cube{rotation_of(number)};
    cube.height = gap_of(number) - lowest(corners(cube.rotation));
    while (const auto hit = next_hit(cube, duration)) {
        cube = cube.after(*hit);
        duration -= *hit;
        cube.stop(*cube.sinking());
    }
    return cube.velocity;
}

} // namespace flotilla::physics
