// SPDX-License-Identifier: MIT
// Pairs of random convex bodies of few vertices that touch or nearly do, at any place of the world: rocks, boxes,
// cylinders and plates, with faces and edges that are parallel, or nearly so, or anyhow.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/rotation.hpp"
#include "mesh/convexity.hpp"
#include "mesh/primitives.hpp"
#include "proximity/contact_points.hpp"
#include "support/random.hpp"

namespace flotilla::test {

/// About one metre across.
inline TriangleMesh random_convex_mesh(Random& random) {
    switch (random.below(8)) {
    case 0: return make_box(1, 1, 1);
    case 1: return make_box(random.uniform(0.1, 2), random.uniform(0.1, 2), random.uniform(0.01, 2));
    case 2: return make_box(1, random.uniform(0.5, 1), 1, 2); // coplanar triangles, vertices inside faces
    case 3: return make_cylinder(0.5, random.uniform(0.1, 2), 3 + static_cast<int>(random.below(9)));
    case 4: return make_plate(random.uniform(0.5, 5), 5);
    case 5: return make_plate(2, 1, 3, 2);
    default: break;
    }
    TriangleMesh rock = make_sphere(0.5, static_cast<int>(random.below(2)));
    const Vec3 scale{random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1)};
    for (Vec3& v : rock.vertices) v = {scale.x * v.x, scale.y * v.y, scale.z * v.z};
    return rock;
}

inline RigidShape shape_of(TriangleMesh mesh) {
    RigidShape shape;
    shape.mesh = std::move(mesh);
    shape.topology = build_topology(shape.mesh);
    shape.bvh = build_bvh(shape.mesh);
    shape.box = bounding_box(shape.mesh);
    shape.outline = support_points(shape.mesh.vertices);
    shape.radius = bounding_radius(shape.mesh, {});
    shape.convex = is_convex(shape.mesh);
    return shape;
}

class ConvexPair {
  public:
    /// At rest, `gap` apart to a tenth where that can be had.
    ConvexPair(Random& random, double gap) {
        for (int i = 0; i < 2; ++i) model_.shapes.push_back(shape_of(random_convex_mesh(random)));
        model_.bodies.resize(2);
        model_.bodies[1].shape = 1;
        const Vec3 world = random.vec(std::pow(10, random.uniform(-1, 3)));
        const Vec3 way = random.below(2) == 0 ? Vec3{0, 0, 1} : normalized(random.vec(1));
        const Vec3 aside = random.uniform(0, 1) * random.vec(1);
        rotations_ = {random_rotation(random), random_rotation(random)};
        places_ = {world, world + 6 * way + (aside - dot(aside, way) * way)};
        double now = 20;
        ProximityScratch scratch;
        for (int i = 0; i < 12 && !(std::abs(now - gap) < 0.1 * gap); ++i) {
            trajectories_.start(model_, std::array{pose(0, {}, {}), pose(1, {}, {})});
            now = find_proximities(a(), b(), 1.1 * now, 1, {}, scratch).distance;
            const auto nearest = std::ranges::min_element(scratch.found, {}, &ProximityPoint::distance);
            if (nearest == scratch.found.end()) break;
            direction_ = nearest->normal;
            // Along any way they come nearer by no more than this.
            places_[1] += (-(now - gap) / std::max(0.1, dot(direction_, way))) * way;
        }
    }

    /// Moves both bodies by up to `far` (m), and turns them by as much (rad).
    void move(Random& random, double far) {
        for (std::size_t i = 0; i < 2; ++i) trajectories_.set_end(i, pose(i, random.vec(far), random.vec(far)), {});
    }
    /// What searches may know of the shapes; at first it is the truth.
    void set_convex(bool convex) {
        for (RigidShape& shape : model_.shapes) shape.convex = convex;
    }

    [[nodiscard]] BodyMotion a() const { return trajectories_.at_start(0); } ///< at rest at the start
    [[nodiscard]] BodyMotion b() const { return trajectories_.at_start(1); }
    [[nodiscard]] BodyMotion motion(std::size_t i) const { return trajectories_.motion(i); }
    [[nodiscard]] const Vec3& direction() const { return direction_; } ///< of a plane between them, or nearly so

  private:
    static Quat random_rotation(Random& random) {
        const auto quarters = [&] { return std::numbers::pi / 2 * static_cast<double>(random.below(4)); };
        const Quat q = rotation_from_vector({quarters(), 0, 0}) * rotation_from_vector({0, 0, quarters()});
        switch (random.below(3)) {
        case 0: return q;
        case 1: return rotation_from_vector(random.vec(std::pow(10, random.uniform(-9, -2)))) * q;
        default: return random.rotation();
        }
    }
    [[nodiscard]] Pose pose(std::size_t i, const Vec3& way, const Vec3& turn) const {
        return make_pose(model_.shapes[i], places_[i] + way, rotation_from_vector(turn) * rotations_[i]);
    }

    Model model_;
    Trajectories trajectories_;
    std::array<Vec3, 2> places_;
    std::array<Quat, 2> rotations_;
    Vec3 direction_;
};

} // namespace flotilla::test
