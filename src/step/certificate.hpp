// SPDX-License-Identifier: MIT
// The end-of-step check: every pair is proved apart in one of the four ways of DESIGN 4.2, and no other.
#pragma once

#include <stdexcept>

#include "pair/step_data.hpp"

namespace flotilla {

/// A step whose end could not be proved free of intersections. It never leaves silently.
class CertificateError : public std::logic_error {
  public:
    using std::logic_error::logic_error;
};

/// Throws CertificateError with the pair that has no proof.
void certify(StepData& data);

} // namespace flotilla
