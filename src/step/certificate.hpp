// SPDX-License-Identifier: MIT
// The end-of-step check: every pair is proved apart in one of the four ways of DESIGN 4.2, and no other.
#pragma once

#include <exception>

#include "pair/step_data.hpp"

namespace flotilla {

/// Thrown where the end of a step could not be proved free of intersections: the first pair of bodies without a proof.
struct CertificateError : std::exception {
    explicit CertificateError(const CandidatePair& bodies) : pair(bodies) {}
    CandidatePair pair;
};

/// Throws CertificateError.
void certify(StepData& data);

} // namespace flotilla
