// SPDX-License-Identifier: MIT
#include "step/certificate.hpp"

#include "base/index.hpp"

namespace flotilla {
namespace {

bool certified(const StepView& view, const PairTable& records, const CandidatePair& p) {
    const PairRecord* record = records.find(p.a, p.b);
    if (record != nullptr && apart(view.trajectories, *record)) return true;               // way b
    if (view.trajectories.still(at(p.a)) && view.trajectories.still(at(p.b))) return true; // way d
    const std::int32_t c = view.clusters.of(at(p.a));
    return c == view.clusters.of(at(p.b)) && view.clusters[c].internal_proved; // way c
}

} // namespace

void certify(const StepView& view, PairBook& book, Team& team) {
    constexpr std::size_t kGrain = 256;
    const std::vector<CandidatePair>& pairs = swept_pairs(view, book, team, ListReach::separation); // way a: all others
    std::vector<std::uint8_t>& flags = book.lists.certified;
    flags.resize(pairs.size());
    team.for_each("certify", pairs.size(), kGrain,
                  [&](std::size_t i, int) { flags[i] = certified(view, book.table, pairs[i]) ? 1 : 0; });
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (flags[i] == 0) throw CertificateError(pairs[i]);
}

} // namespace flotilla
