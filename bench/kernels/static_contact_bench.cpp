// SPDX-License-Identifier: MIT
// The contact solver on brick walls: bricks of 1 x 1 x 0.5 m in layers of n x n, shifted by half a brick from layer to
// layer, so that a brick rests on up to four others with four contact points each, all with friction.
//   Sweep      projected Gauss-Seidel, random tangents and pyramid; the counter per_visit_ns is one contact with its 3
//              rows
//   SweepScalar  the same without vectors, for the same bits
//   SweepDisc  the same with aligned tangents and the friction disc
//   Assemble   set-up alone (order, islands, colours, rows): per_contact_ns
//   Shock      one sweep, then shock propagation to the default tolerance: the whole solve
// Every run starts from the same state. Before anything is timed, a converged solve must carry the weight of the wall.
#include <cmath>
#include <cstdlib>

#include <benchmark/benchmark.h>

#include "static_contact/solve_contacts.hpp"

namespace flotilla {
namespace {

constexpr double kGravityStep = 9.8 / 24; // m/s, velocity that a step of 1/24 s adds

struct Wall {
    std::vector<Vec3> position, velocity, angular_velocity;
    std::vector<double> inv_mass;
    std::vector<Mat3> inv_inertia;
    std::vector<Contact> contacts;
    std::vector<Vec3> impulses;
    ContactScratch scratch;

    ContactSolveStats solve(const ContactSolveOptions& options) {
        for (std::size_t i = 0; i < velocity.size(); ++i) {
            velocity[i] = {0.01 * kGravityStep * (inv_mass[i] > 0), 0, -kGravityStep * (inv_mass[i] > 0)};
            angular_velocity[i] = {};
        }
        return solve_contacts(contacts, {position, velocity, angular_velocity, inv_mass, inv_inertia, {}, {}}, options,
                              impulses, scratch);
    }
};

void add_body(Wall& w, const Vec3& x, double inv_mass) {
    w.position.push_back(x);
    w.velocity.push_back({});
    w.angular_velocity.push_back({});
    w.inv_mass.push_back(inv_mass);
    w.inv_inertia.push_back((12 * inv_mass) * diagonal({1 / 1.25, 1 / 1.25, 1 / 2.0}));
}

// Four points, the corners of the overlap of two bricks (centres dx, dy apart) on the plane between them.
void touch(Wall& w, std::int32_t a, std::int32_t b, const Vec3& middle, double half_x, double half_y) {
    for (int corner = 0; corner < 4; ++corner) {
        const Vec3 p{middle.x + (corner & 1 ? half_x : -half_x), middle.y + (corner & 2 ? half_y : -half_y), middle.z};
        w.contacts.push_back({.a = a,
                              .b = b,
                              .point = p,
                              .normal = {0, 0, 1},
                              .friction = 0.5,
                              .feature_key = static_cast<std::uint64_t>(corner)});
    }
}

// Body 0 is the ground; layer k holds bricks of the square of n x n, or of (n-1) x (n-1) where it is shifted.
Wall make_wall(int n, int layers) {
    Wall w;
    add_body(w, {}, 0);
    std::int32_t below = 0;
    for (int k = 0, m_below = 0; k < layers; ++k) {
        const int m = k % 2 ? n - 1 : n;
        const double shift = k % 2 ? 0.5 : 0.0, z = 0.5 * k;
        const auto first = static_cast<std::int32_t>(w.position.size());
        for (int i = 0; i < m * m; ++i) {
            const int column = i % m, row = i / m;
            const Vec3 x{column + shift, row + shift, z + 0.25};
            add_body(w, x, 1.0 / 100);
            const std::int32_t body = first + i;
            if (k == 0) touch(w, 0, body, {x.x, x.y, z}, 0.5, 0.5);
            for (int j = 0; k > 0 && j < m_below * m_below; ++j) {
                const Vec3 d = w.position[static_cast<std::size_t>(below + j)] - x;
                if (std::abs(d.x) < 0.75 && std::abs(d.y) < 0.75)
                    touch(w, below + j, body, {x.x + d.x / 2, x.y + d.y / 2, z}, 0.25, 0.25);
            }
        }
        below = first;
        m_below = m;
    }
    w.impulses.resize(w.contacts.size());
    return w;
}

// The ground must carry everything.
void verify(Wall& w, benchmark::State& state) {
    const ContactSolveStats stats = w.solve({.iterations = 20000, .tolerance = 1e-7, .shock = false});
    double carried = 0, weight = 0;
    for (std::size_t k = 0; k < w.contacts.size(); ++k)
        if (w.contacts[k].a == 0) carried += w.impulses[k].z;
    for (const double inv : w.inv_mass) weight += inv > 0 ? kGravityStep / inv : 0;
    if (!(stats.residual <= 1e-7) || std::abs(carried / weight - 1) > 1e-3) state.SkipWithError("wall not carried");
}

Wall wall_for(benchmark::State& state) {
    const auto n = static_cast<int>(state.range(0)), layers = static_cast<int>(state.range(1));
    Wall w = make_wall(n, layers);
    verify(w, state);
    state.counters["contacts"] = static_cast<double>(w.contacts.size());
    return w;
}

void run(benchmark::State& state, const ContactSolveOptions& options, const char* counter) {
    Wall w = wall_for(state);
    ContactSolveStats stats;
    for (auto _ : state) stats = w.solve(options);
    const double per_solve =
        options.iterations > 0 ? static_cast<double>(stats.visits) : static_cast<double>(w.contacts.size());
    state.counters[counter] = benchmark::Counter(per_solve * 1e-9, benchmark::Counter::kIsIterationInvariantRate |
                                                                       benchmark::Counter::kInvert);
    state.counters["residual"] = stats.residual;
    state.counters["colors"] = stats.colors;
}

void BM_StaticContact_Sweep(benchmark::State& state) {
    run(state, {.iterations = 100, .tolerance = 0, .warm_start = false, .shock = false}, "per_visit_ns");
}
void BM_StaticContact_SweepScalar(benchmark::State& state) {
    ContactSolveOptions options{.iterations = 100, .tolerance = 0, .warm_start = false, .shock = false};
    options.isa = Isa::scalar;
    run(state, options, "per_visit_ns");
}
void BM_StaticContact_SweepDisc(benchmark::State& state) {
    run(state, {.iterations = 100, .tolerance = 0, .warm_start = false, .shock = false, .tangents = Tangents::aligned},
        "per_visit_ns");
}
void BM_StaticContact_Assemble(benchmark::State& state) {
    run(state, {.iterations = 0, .tolerance = 0, .warm_start = false, .shock = false}, "per_contact_ns");
}
void BM_StaticContact_Shock(benchmark::State& state) {
    run(state, {.iterations = 1, .warm_start = false}, "per_visit_ns");
}

void walls(benchmark::internal::Benchmark* b) {
    b->ArgNames({"bricks", "layers"})->Args({2, 4})->Args({6, 4})->Args({12, 8})->Unit(benchmark::kMicrosecond);
}
BENCHMARK(BM_StaticContact_Sweep)->Apply(walls);
BENCHMARK(BM_StaticContact_SweepScalar)->Apply(walls);
BENCHMARK(BM_StaticContact_SweepDisc)->Apply(walls);
BENCHMARK(BM_StaticContact_Assemble)->Apply(walls);
BENCHMARK(BM_StaticContact_Shock)->Apply(walls);

} // namespace
} // namespace flotilla
