// SPDX-License-Identifier: MIT
#include "step/certificate.hpp"

#include <string>

namespace flotilla {
namespace {

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

bool certified(const StepData& data, const CandidatePair& p) {
    if (proved(data, p.a, p.b)) return true;                                               // way b
    if (data.trajectories.still(at(p.a)) && data.trajectories.still(at(p.b))) return true; // way d
    const std::int32_t c = data.clusters.of(at(p.a));
    return c == data.clusters.of(at(p.b)) && data.clusters[c].internal_proved; // way c
}

} // namespace

void certify(StepData& data) {
    for (const CandidatePair& p : swept_pairs(data, false)) // way a: all others
        if (!certified(data, p))
            throw CertificateError("step " + std::to_string(data.state.step + 1) + ": bodies " + std::to_string(p.a) +
                                   " and " + std::to_string(p.b) + " could not be proved apart");
}

} // namespace flotilla
