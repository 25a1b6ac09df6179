// SPDX-License-Identifier: MIT
#include "collision/grounds.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "pair/impulses.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

bool stands(const StepView& view, std::int32_t body) {
    const Cluster& cluster = view.clusters[view.clusters.of(at(body))];
    if (!cluster.infinite() || !view.trajectories.still(at(body))) return false;
    const Impulsive i = view.clusters.impulsive(view.clusters.of(at(body)));
    return i.inverse_inertia == Mat3{} && i.velocity == Vec3{} && i.angular_velocity == Vec3{};
}

} // namespace

void Grounds::add(const StepView& view, std::span<const ListedPair> pairs, Team& team,
                  std::vector<std::size_t>& chunks) {
    constexpr std::size_t kGrain = 512;
    const auto lands = [&](std::size_t i) { return stands(view, pairs[i].pair.a) != stands(view, pairs[i].pair.b); };
    const auto support = [&](std::size_t i) {
        const CandidatePair& p = pairs[i].pair;
        return stands(view, p.a) ? Support{p.b, p.a} : Support{p.a, p.b};
    };
    const std::size_t before = supports_.size();
    compact_if({&team, "grounds", kGrain, chunks}, pairs.size(), lands, supports_, before, support);
    if (supports_.size() == before) return;
    std::sort(supports_.begin(), supports_.end());
    supports_.erase(std::unique(supports_.begin(), supports_.end()), supports_.end());
}

void Grounds::beside(const StepView& view, std::int32_t a, std::int32_t b, std::vector<std::int32_t>& out) const {
    out.clear();
    const auto infinite = [&](std::int32_t body) { return view.clusters[view.clusters.of(at(body))].infinite(); };
    if (!infinite(a) && !infinite(b)) return;
    const std::int32_t body = infinite(a) ? b : a, ground = infinite(a) ? a : b;
    const double restitution = pair_restitution(view.model, body, ground);
    bool known = false;
    const auto first = std::lower_bound(supports_.begin(), supports_.end(), Support{body, -1});
    for (auto s = first; s != supports_.end() && s->body == body; ++s) {
        known |= s->ground == ground;
        if (s->ground != ground && pair_restitution(view.model, body, s->ground) == restitution)
            out.push_back(s->ground);
    }
    if (!known) out.clear();
}

} // namespace flotilla
