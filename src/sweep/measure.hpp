// SPDX-License-Identifier: MIT
// What a run folder says about a run, in numbers that can be compared: those of sweep_metrics().
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <flotilla/scene.hpp>
#include <flotilla/types.hpp>

#include "scene/scene.hpp"

namespace flotilla::sweep {

/// Positions in sweep_metrics().
enum Metric : std::size_t { position, rotation, height, energy, support, load, creep, residual, rest_time, kMetrics };

/// What the runs of one start share: no setting changes it.
struct Problem {
    explicit Problem(const SceneDescription& start);

    Scene scene;
    std::vector<std::size_t> moving; ///< bodies of finite mass
    double mass = 0;                 ///< kg, of all of these
    double size = 0;                 ///< m, their mean
    Vec3 up{0, 0, 1};                ///< unit, against gravity
    double gravity = 0;              ///< m/s^2
    double start_energy = 0;         ///< J, kinetic and potential

    [[nodiscard]] double mass_of(std::size_t body) const;
    /// What a metric goes by in this scene: the size, the weight, the speed of a fall by the size. `duration`: s, of
    /// the runs.
    [[nodiscard]] double scale_of(std::size_t metric, double duration) const;
};

struct Measures {
    double cost = 0;            ///< s, wall time of all steps
    std::vector<double> values; ///< by metric; nan where it has none
};

/// Of a finished run. `scene`: as it ran, settings included. `reference`: the folder of the run to compare poses
/// with; empty: none. IoError where the folder cannot be read.
[[nodiscard]] Measures measure(const Problem& problem, const SceneDescription& scene,
                               const std::filesystem::path& folder, const std::filesystem::path& reference);

/// The first time from which `kinetic` (J, one value a step, at `times`) stays at or below `threshold`; nan where it
/// does not.
[[nodiscard]] double time_to_rest(std::span<const double> times, std::span<const double> kinetic, double threshold);

} // namespace flotilla::sweep
