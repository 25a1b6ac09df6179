// SPDX-License-Identifier: MIT
#include "collision/grounds.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "pair/impulses.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

bool stands(const StepView& view, std::int32_t body) {
    const Impulsive i = view.clusters.impulsive(body);
    return i.inverse_mass == 0 && i.inverse_inertia == Mat3{} && i.velocity == Vec3{} && i.angular_velocity == Vec3{} &&
           view.trajectories.still(at(body));
}

} // namespace

void Grounds::list(const StepView& view, std::span<const ListedPair> pairs, Team& team,
                   std::vector<std::size_t>& chunks) {
    constexpr std::size_t kGrain = 512;
    const auto lands = [&](std::size_t i) { return stands(view, pairs[i].pair.a) != stands(view, pairs[i].pair.b); };
    const auto landing = [&](std::size_t i) {
        const CandidatePair& p = pairs[i].pair;
        return stands(view, p.a) ? Landing{p.b, p.a} : Landing{p.a, p.b};
    };
    landings_.clear();
    compact_if({&team, "grounds", kGrain, chunks}, pairs.size(), lands, landings_, 0, landing);
    std::sort(landings_.begin(), landings_.end());
}

void Grounds::beside(const StepView& view, std::int32_t body, std::int32_t ground,
                     std::vector<std::int32_t>& out) const {
    out.clear();
    const auto first = std::lower_bound(landings_.begin(), landings_.end(), Landing{body, -1});
    bool known = false;
    for (auto l = first; l != landings_.end() && l->body == body; ++l) {
        known |= l->ground == ground;
        if (l->ground != ground && !view.model.ignores(body, l->ground) &&
            pair_restitution(view.model, body, l->ground) == pair_restitution(view.model, body, ground))
            out.push_back(l->ground);
    }
    if (!known) out.clear();
}

} // namespace flotilla
