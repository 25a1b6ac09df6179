// SPDX-License-Identifier: MIT
#include "step/certificate.hpp"

#include "base/index.hpp"

namespace flotilla {
namespace {

bool certified(const StepData& data, const CandidatePair& p) {
    const PairRecord* record = data.pairs.find(p.a, p.b);
    if (record != nullptr && proved(data, *record)) return true;                           // way b
    if (data.trajectories.still(at(p.a)) && data.trajectories.still(at(p.b))) return true; // way d
    const std::int32_t c = data.clusters.of(at(p.a));
    return c == data.clusters.of(at(p.b)) && data.clusters[c].internal_proved; // way c
}

} // namespace

void certify(StepData& data) {
    constexpr std::size_t kGrain = 256;
    const std::vector<CandidatePair>& pairs = swept_pairs(data, false); // way a: all others
    data.lists.flags.resize(pairs.size());
    data.team.for_each("certify", pairs.size(), kGrain,
                       [&](std::size_t i, int) { data.lists.flags[i] = certified(data, pairs[i]) ? 1 : 0; });
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (data.lists.flags[i] == 0) throw CertificateError(pairs[i]);
}

} // namespace flotilla
