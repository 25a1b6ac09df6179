// SPDX-License-Identifier: MIT
// The independent proof that no two bodies intersect, at a frame and between two frames (G1 and G2).
//
// It shares with the solver the exact triangle predicate, the one function that places vertices, and what both are
// written in: vectors and rotations (base), TriangleMesh, a parallel loop. Its hierarchy, its broad phase and its sweep
// test are its own. Pairs of two infinite-mass bodies are left out, as in G1.
//
// Between frames every vertex moves on a path (Motion): a straight segment, or the turning motion of its body. The
// proof (audit/sweep) bisects time until a plane separates the two triangles over the whole interval.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "audit/box_tree.hpp"
#include "mesh/triangle_mesh.hpp"

namespace flotilla::audit {

struct Shape {
    TriangleMesh mesh;   ///< scaled, mesh coordinates
    Vec3 center_of_mass; ///< mesh coordinates
    BoxTree tree;
    double radius = 0; ///< m, of the ball about the centre of mass that holds the mesh
};
[[nodiscard]] Shape make_shape(TriangleMesh mesh, const Vec3& center_of_mass);

struct Body {
    std::int32_t shape = 0;
    bool infinite_mass = false;
};

struct Scene {
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::function<bool(std::size_t, std::size_t)> ignored; ///< pairs that may meet; empty: none
    [[nodiscard]] bool ignores(std::int32_t a, std::int32_t b) const {
        return ignored && ignored(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    }
    [[nodiscard]] const Shape& shape_of(std::size_t body) const {
        return shapes[static_cast<std::size_t>(bodies[body].shape)];
    }
};

struct Pose {
    Vec3 position; ///< of the mesh's origin
    Quat rotation;
    bool present = true; ///< else the body has no vertices and takes part in nothing
    friend bool operator==(const Pose&, const Pose&) = default;
};

/// A pose that places nothing: not finite, or a rotation farther than 1e-6 from unit length.
struct BadPose {
    std::int32_t body = 0;
    std::string reason;
};

/// The bodies of one frame in the world. A body with a bad pose has no vertices and takes part in nothing.
struct Placement {
    std::vector<Pose> poses;
    std::vector<std::vector<Vec3>> vertices;
    std::vector<std::vector<Bounds>> boxes; ///< of the tree's nodes
    std::vector<BadPose> bad;
    [[nodiscard]] bool is_placed(std::size_t body) const { return !boxes[body].empty(); }
};
[[nodiscard]] Placement place(const Scene& scene, std::span<const Pose> poses, int threads);

/// Two bodies of a frame that intersect.
struct Intersection {
    std::int32_t body_a = 0, body_b = 0;         ///< a < b
    std::int32_t triangle_a = 0, triangle_b = 0; ///< the first pair
    std::int64_t triangle_pairs = 0;             ///< all of them
    Vec3 place;                                  ///< m, middle of the common part of the first pair's boxes
};
struct StateReport {
    std::int64_t pairs = 0; ///< body pairs whose boxes overlap
    std::int64_t triangle_pairs = 0;
    std::vector<Intersection> intersections; ///< sorted by (a, b)
};
[[nodiscard]] StateReport check_state(const Scene& scene, const Placement& placement, int threads);

/// How vertices move from one frame to the next.
enum class Motion : std::uint8_t {
    linear, ///< on a straight segment
    rigid,  ///< centre of mass on a straight segment, orientation R(t w) q
};

/// Two bodies that are not proved apart on the way.
struct Passage {
    std::int32_t body_a = 0, body_b = 0;
    std::int32_t triangle_a = 0, triangle_b = 0;
    bool crossing = false; ///< they intersect at `time`; otherwise no proof was found around it
    double time = 0;       ///< [0, 1], between the frames
    Vec3 place;
};
struct MotionReport {
    std::int64_t pairs = 0; ///< body pairs whose swept boxes overlap
    std::int64_t triangle_pairs = 0;
    std::vector<Passage> passages;  ///< the first of each body pair, sorted by (a, b)
    std::vector<BadPose> bad_paths; ///< Motion::rigid: the turn does not lead to the next frame's rotation
};
/// `turns` holds the rotation vector (rad) of every body over the interval; used by Motion::rigid only.
[[nodiscard]] MotionReport check_motion(const Scene& scene, const Placement& from, const Placement& to, Motion motion,
                                        std::span<const Vec3> turns, int threads);

struct SmallestDistance {
    double distance = 0; ///< m; infinity where there is no pair
    std::int32_t body_a = -1, body_b = -1;
};
/// The smallest distance of two bodies, of equal ones that of the first pair by (a, b). In double arithmetic: a
/// measurement, not a proof. Only distances below `bound` (m) are looked for: where there is none the result is
/// infinite.
[[nodiscard]] SmallestDistance smallest_distance(const Scene& scene, const Placement& placement, int threads,
                                                 double bound = std::numeric_limits<double>::infinity());

} // namespace flotilla::audit
