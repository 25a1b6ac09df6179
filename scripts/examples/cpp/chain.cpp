// SPDX-License-Identifier: MIT
// A chain of ribbon rings hangs from a fixed one; prints what each ring pulls at the one above, beside the weight that
// hangs below. usage: chain LINKS
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/world.hpp>

namespace {

constexpr double kRadius = 0.05, kWidth = 0.02, kDensity = 20; // m, m, kg/m^2
constexpr int kSegments = 16;

/// A ribbon closed to a ring about z.
flotilla::ShapeDescription ring() {
    flotilla::ShapeDescription shape{.name = "ring"};
    for (const double z : {-kWidth / 2, kWidth / 2})
        for (int k = 0; k < kSegments; ++k) {
            const double angle = 2 * std::numbers::pi * k / kSegments;
            shape.vertices.push_back({kRadius * std::cos(angle), kRadius * std::sin(angle), z});
        }
    for (int k = 0; k < kSegments; ++k) {
        const int next = (k + 1) % kSegments;
        shape.triangles.push_back({k, next, next + kSegments});
        shape.triangles.push_back({k, next + kSegments, k + kSegments});
    }
    shape.mass_kind = flotilla::MassKind::surface_density;
    shape.mass_value = kDensity;
    return shape;
}

double mass_of_ring() { return kDensity * kWidth * kSegments * 2 * kRadius * std::sin(std::numbers::pi / kSegments); }

flotilla::SceneDescription make_chain(int links) {
    flotilla::SceneDescription scene;
    scene.settings.time_step = 1.0 / 120;
    scene.shapes = {ring()};
    const double half = std::sqrt(0.5), pitch = 2 * kRadius - 1.1 * kWidth;
    for (int k = 0; k < links; ++k) {
        flotilla::BodyDescription body{.name = "link" + std::to_string(k)};
        if (k == 0) body.type = flotilla::BodyType::fixed;
        body.position = {0, 0, -k * pitch};
        body.rotation = k % 2 == 0 ? flotilla::Quat{half, half, 0, 0} : flotilla::Quat{half, 0, half, 0};
        scene.bodies.push_back(body);
    }
    return scene;
}

int hang(int links) {
    flotilla::World world(make_chain(links));
    while (world.time() < 3) world.step();
    std::vector<double> pull(world.size());
    for (const flotilla::ContactState& c : world.contacts())
        if (c.body_b == c.body_a + 1)
            pull[static_cast<std::size_t>(c.body_b)] += c.impulse.z / world.settings().time_step;
    bool as_it_should = true;
    std::printf("link  pull, N  weight below, N\n");
    for (int k = 1; k < links; ++k) {
        const double weight = 9.8 * mass_of_ring() * (links - k), pulled = pull[static_cast<std::size_t>(k)];
        std::printf("%4d  %7.4f  %7.4f\n", k, pulled, weight);
        as_it_should = as_it_should && std::abs(pulled - weight) <= 0.02 * weight;
    }
    return as_it_should ? 0 : 1;
}

} // namespace

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: chain LINKS\n");
        return 2;
    }
    try {
        return hang(std::atoi(arguments[1]));
    } catch (const flotilla::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
