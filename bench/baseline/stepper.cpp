// SPDX-License-Identifier: MIT
#include "stepper.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "contact_graph.hpp"
#include "impulse.hpp"

namespace flotilla::baseline {
namespace {

using Pair = std::pair<std::size_t, std::size_t>;

/// Solves one pair: interferences at the predicted poses, an impulse at the deepest point that does not separate, the
/// bodies evolved anew from the start of the step, and so on (sections 5 and 6). `extra`: m/s, gravity's part of the
/// prediction where the velocities do not have it yet. Returns whether any impulse was applied.
class PairSolver {
  public:
    PairSolver(Bodies& bodies, double dt, int iterations)
        : bodies_(bodies), dt_(dt), iterations_(iterations), changes_(bodies.all.size(), 0) {}

    bool solve(const Pair& pair, double restitution, const Vec3& extra) {
        if (is_settled(pair)) return false;
        bool any = false;
        for (int k = 0; k < iterations_; ++k) {
            if (!solve_deepest(pair, restitution, extra)) {
                settled_[pair] = {changes_[pair.first], changes_[pair.second]};
                break;
            }
            any = true;
            ++changes_[pair.first], ++changes_[pair.second];
        }
        return any;
    }

    /// After velocities were changed from outside.
    void forget_settled() { settled_.clear(); }

    [[nodiscard]] Pose predicted(std::size_t body, const Vec3& extra) const {
        const Body& b = bodies_.all[body];
        return b.movable ? moved(b, dt_, extra) : b.pose;
    }

    /// Whether any sample of one is inside the other one.
    [[nodiscard]] bool interfere(std::size_t a, const Pose& at_a, std::size_t b, const Pose& at_b) {
        find_interferences(bodies_.solid(a), at_a, bodies_.solid(b), at_b, found_);
        return !found_.empty();
    }

  private:
    /// Nothing was to be done for this pair, and neither body has changed since: there is nothing to be done now,
    /// whatever the restitution.
    [[nodiscard]] bool is_settled(const Pair& pair) const {
        const auto found = settled_.find(pair);
        return found != settled_.end() && found->second == std::pair{changes_[pair.first], changes_[pair.second]};
    }

    bool solve_deepest(const Pair& pair, double restitution, const Vec3& extra) {
        const auto [i, j] = pair;
        const Pose at_i = predicted(i, extra), at_j = predicted(j, extra);
        if (!interfere(i, at_i, j, at_j)) return false;
        Body &a = bodies_.all[i], &b = bodies_.all[j];
        const double friction = pair_friction(a, b);
        return std::any_of(found_.begin(), found_.end(), [&](const Interference& contact) {
            return apply_impulse(a, b, contact, contact.place - at_i.center, contact.place - at_j.center, restitution,
                                 friction);
        });
    }

    Bodies& bodies_;
    double dt_;
    int iterations_;
    std::vector<Interference> found_;
    std::vector<int> changes_;                    ///< impulses that each body has had
    std::map<Pair, std::pair<int, int>> settled_; ///< the changes of both bodies when nothing was left to do
};

std::vector<Pair> movable_pairs(const Bodies& bodies) {
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < bodies.all.size(); ++i)
        for (std::size_t j = i + 1; j < bodies.all.size(); ++j)
            if (bodies.all[i].movable || bodies.all[j].movable) pairs.emplace_back(i, j);
    return pairs;
}

/// Section 5. Interferences are those of x + dt (v + dt g), but the impulses act on v: a body at rest has none to
/// bounce with.
void collide(Bodies& bodies, PairSolver& solver, const std::vector<Pair>& pairs, double dt, int sweeps) {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        bool any = false;
        for (const Pair& pair : pairs) {
            const double restitution = pair_restitution(bodies.all[pair.first], bodies.all[pair.second]);
            any |= solver.solve(pair, restitution, dt * bodies.gravity);
        }
        if (!any) return;
    }
}

/// Section 6.1: each body alone is moved to its predicted pose; what it hits there is below it.
std::vector<int> levels(const Bodies& bodies, PairSolver& solver) {
    std::vector<Pair> rests_on;
    for (std::size_t i = 0; i < bodies.all.size(); ++i) {
        if (!bodies.all[i].movable) continue;
        const Pose alone = solver.predicted(i, {});
        for (std::size_t j = 0; j < bodies.all.size(); ++j)
            if (i != j && solver.interfere(i, alone, j, bodies.all[j].pose)) rests_on.emplace_back(i, j);
    }
    return contact_levels(bodies.all.size(), rests_on);
}

/// The pairs of each level: that of its higher body.
std::vector<std::vector<Pair>> pairs_by_level(const std::vector<Pair>& pairs, const std::vector<int>& level) {
    std::vector<std::vector<Pair>> out(static_cast<std::size_t>(*std::max_element(level.begin(), level.end())) + 1);
    for (const Pair& pair : pairs)
        out[static_cast<std::size_t>(std::max(level[pair.first], level[pair.second]))].push_back(pair);
    return out;
}

/// Section 6: the restitution goes from -1 towards 0, so that the weight of what lies above arrives gradually.
void contact(PairSolver& solver, const std::vector<std::vector<Pair>>& by_level, const StepOptions& options) {
    for (int k = 1; k <= options.contact_sweeps; ++k)
        for (const auto& pairs : by_level)
            for (int again = 0; again < options.level_sweeps; ++again)
                for (const Pair& pair : pairs) solver.solve(pair, -1 + 1.0 * k / options.contact_sweeps, {});
}

void freeze(Body& body) { body.inverse_mass = 0, body.inverse_inertia = {}; }

/// Section 6.2: a last sweep from the bottom up; each finished level gets infinite mass for the levels above. The
/// masses come back when the positions are advanced.
void propagate_shock(Bodies& bodies, PairSolver& solver, const std::vector<std::vector<Pair>>& by_level,
                     const std::vector<int>& level, int level_sweeps) {
    for (std::size_t l = 0; l < by_level.size(); ++l) {
        for (int again = 0; again < level_sweeps; ++again)
            for (const Pair& pair : by_level[l])
                if (bodies.all[pair.first].inverse_mass + bodies.all[pair.second].inverse_mass > 0)
                    solver.solve(pair, 0, {});
        for (std::size_t i = 0; i < level.size(); ++i)
            if (static_cast<std::size_t>(level[i]) == l) freeze(bodies.all[i]);
    }
}

} // namespace

void step(Bodies& bodies, double dt, const StepOptions& options) {
    PairSolver solver(bodies, dt, options.pair_iterations);
    const std::vector<Pair> pairs = movable_pairs(bodies);
    collide(bodies, solver, pairs, dt, options.collision_sweeps);
    for (Body& body : bodies.all)
        if (body.movable) body.velocity += dt * bodies.gravity;
    solver.forget_settled();
    const std::vector<int> level = levels(bodies, solver);
    const auto by_level = pairs_by_level(pairs, level);
    contact(solver, by_level, options);
    if (options.shock_propagation) propagate_shock(bodies, solver, by_level, level, options.level_sweeps);
    for (Body& body : bodies.all)
        if (body.movable) advance(bodies.solids[body.solid], body, dt);
}

} // namespace flotilla::baseline
