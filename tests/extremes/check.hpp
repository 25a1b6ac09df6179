// SPDX-License-Identifier: MIT
// Runs a cell of the matrix and asks for every promise after every step.
#pragma once

#include <string>

#include "extremes/cells.hpp"

namespace flotilla::extremes {

enum class Verdict {
    pass,
    held,    ///< kept every promise, and reported bodies that the failsafe held or scripts that it delayed
    refused, ///< with a message
    broken,  ///< a promise
    unended, ///< stopped by its time, which limits of sweeps that the scene sets itself allow it to exceed
};

struct Outcome {
    Verdict verdict = Verdict::pass;
    std::string message;     ///< of a refusal, or what was broken and in which step
    int steps = 0;           ///< made
    double seconds = 0;      ///< of processor time, of one run on one thread, without the audit
    double slowest_step = 0; ///< the same
    double rise = 0;         ///< of energy in a step, as a share of the energy of motion, or of what lift may be in all
    bool late = false;       ///< ended by its time, and nothing else is known of it
    double drift = 0;        ///< of linear momentum where nothing acts from outside, as a share of all |m v|
};

struct CheckOptions {
    int steps = 10;
    bool repeated = true;    ///< run again and on three threads as well, where the hash of every state must be the same
    double seconds = 1e30;   ///< of processor time, after which no further step begins
    GravityOfStep gravity{}; ///< set before every step; empty: it stays
};
/// Steps of any scene. What the scene's own reader refuses, and what intersects at the start, is refused.
[[nodiscard]] Outcome run_scene(const SceneDescription& scene, const CheckOptions& options);

[[nodiscard]] Outcome run_cell(const Cell& cell, int steps);

} // namespace flotilla::extremes
