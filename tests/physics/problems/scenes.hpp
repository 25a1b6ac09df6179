// SPDX-License-Identifier: MIT
// Scenes built in code, for the tests of the physics and for what measures them. SI units.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <flotilla/scene.hpp>

#include "base/rotation.hpp"
#include "base/vec3.hpp"
#include "mesh/primitives.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::physics {

using scenario::add_body;
using scenario::add_shape;
using scenario::kGravity;
using scenario::kPi;

inline constexpr double kDegree = kPi / 180;

/// A preset and a time step.
struct Run {
    std::string preset = "balanced";
    int rate = 24; ///< steps a second

    [[nodiscard]] double dt() const { return 1.0 / rate; }
    [[nodiscard]] std::string name() const { return preset + "_dt" + std::to_string(rate); }
    /// Of the preset, sleeping off: rest and creep are then the solver's own doing.
    [[nodiscard]] Settings settings() const;
};

/// `settings` with the gravity of scenes, or without.
[[nodiscard]] SceneDescription make_scene_with(const Settings& settings, const Vec3& gravity = {0, 0, -kGravity});
/// A solid of `density` kg/m^3; the mesh must be closed.
std::int32_t add_solid(SceneDescription& scene, TriangleMesh mesh, double density);
/// A fixed square plate of `size` m in the plane z = 0.
BodyDescription& add_ground(SceneDescription& scene, double size, double friction = 0.1, double restitution = 0.1);
/// The distance at which a body of this mesh comes to rest on a fixed one, and a rounding more: size / 330.
[[nodiscard]] double rest_gap(const TriangleMesh& mesh);
/// Six faces on eight corners: the first four around one face, the others opposite to them.
[[nodiscard]] TriangleMesh make_hexahedron(const std::array<Vec3, 8>& corners);
/// A flat ring in the plane z = 0 without thickness.
[[nodiscard]] TriangleMesh make_annulus(double inner, double outer, int segments);
/// A ring about z of flat sides: the middles of its inner ones are at `radius`.
[[nodiscard]] TriangleMesh make_hoop(double radius, double thickness, double height, int sides);
/// The same scene `factor` times as large, with speeds that grow like the square root: gravity makes both move alike in
/// time sqrt(factor) as long. The time step is not changed.
[[nodiscard]] SceneDescription scaled(SceneDescription scene, double factor);
/// Numbers in [-1, 1) that depend on nothing but the order of calls.
class Numbers {
  public:
    explicit Numbers(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15u + 1) {}
    double next();
    Vec3 vector() {
        const double x = next(), y = next(), z = next();
        return {x, y, z};
    }
    Quat rotation() { return normalized(Quat{next(), next(), next(), next()}); }

  private:
    std::uint64_t state_;
};

} // namespace flotilla::physics
