// SPDX-License-Identifier: MIT
// Placing a body by the wide kernels: the bits of the plain code.
#include "mesh/placement.hpp"

#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "mesh/bvh.hpp"

namespace flotilla {
namespace {

bool same_bits(const CoarseBox& a, const CoarseBox& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Triangles at random, some coordinates zero, some tiny, some huge.
TriangleMesh random_mesh(std::mt19937_64& random, std::size_t vertices, std::size_t triangles) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    const double scales[] = {0, 1e-40, 1, 1, 1, 3e9};
    const auto number = [&] { return uniform(random) * scales[random() % 6]; };
    TriangleMesh mesh;
    for (std::size_t i = 0; i < vertices; ++i) mesh.vertices.push_back({number(), number(), number()});
    const auto vertex = [&] { return static_cast<std::int32_t>(random() % vertices); };
    for (std::size_t i = 0; i < triangles; ++i) mesh.triangles.push_back({vertex(), vertex(), vertex()});
    return mesh;
}

struct Placed {
    Box box;
    std::vector<Vec3> x;
    std::vector<CoarseBox> points, nodes;

    Placed(const TriangleMesh& mesh, const Bvh& bvh, const Vec3& position, const Quat& rotation, Isa isa)
        : x(mesh.vertices.size()), points(mesh.vertices.size()) {
        box = world_vertices(mesh.vertices, position, rotation, x, points, isa);
        refit(bvh, points, nodes, isa);
    }
};

TEST(Placement, WideKernelsGiveTheBitsOfThePlainCode) {
    if (best_isa() == Isa::scalar) GTEST_SKIP() << "no wide kernels here";
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (std::size_t n = 1; n < 60; ++n) {
        const TriangleMesh mesh = random_mesh(random, n, 2 * n);
        const Bvh bvh = build_bvh(mesh);
        const Quat turn =
            n % 7 == 0 ? Quat{} : normalized(Quat{uniform(random), uniform(random), uniform(random), uniform(random)});
        const Vec3 position = n % 5 == 0 ? Vec3{} : Vec3{uniform(random), 100 * uniform(random), uniform(random)};
        const Placed plain(mesh, bvh, position, turn, Isa::scalar), wide(mesh, bvh, position, turn, best_isa());
        std::vector<Vec3> x(n);
        world_vertices(mesh.vertices, position, turn, x);
        ASSERT_EQ(std::memcmp(x.data(), wide.x.data(), n * sizeof(Vec3)), 0) << n;
        ASSERT_EQ(std::memcmp(plain.x.data(), wide.x.data(), n * sizeof(Vec3)), 0) << n;
        ASSERT_EQ(std::memcmp(&plain.box, &wide.box, sizeof(Box)), 0) << n;
        for (std::size_t i = 0; i < n; ++i) ASSERT_TRUE(same_bits(plain.points[i], wide.points[i])) << n << ' ' << i;
        ASSERT_EQ(plain.nodes.size(), wide.nodes.size());
        for (std::size_t i = 0; i < plain.nodes.size(); ++i)
            ASSERT_TRUE(same_bits(plain.nodes[i], wide.nodes[i])) << n << ' ' << i;
    }
}

} // namespace
} // namespace flotilla
