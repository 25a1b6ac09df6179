// SPDX-License-Identifier: MIT
// Runs a scene and keeps what energy and momentum did in it.
//
// Energy must not grow by itself: E after any step may exceed the lowest E so far by no more than lift, what brings
// bodies from where they touch to their rest distance. The allowance is sum m |g| d_rest over the dynamic bodies,
// d_rest = size / 330 with size the diameter of the bounding sphere about the centre of mass, or the scene's own rest
// distance. What is beyond, a rise, is stated as a share of the scale: the largest of the initial kinetic energy, the
// largest kinetic energy so far and the range of the potential energy so far. An energy that explodes is its own scale,
// so a share is at most about 1; `growth` says by how much.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <flotilla/scene.hpp>

namespace flotilla::survey {

/// One row of the table. Fixed size: it travels from process to process as bytes.
struct EnergyRecord {
    std::int64_t index = -1; ///< of a random scene; -1: from a file
    std::array<char, 40> group{}, place{};
    std::array<char, 120> name{}; ///< kinds of bodies, or the file
    std::array<char, 240> failure{};

    std::int32_t bodies = 0; ///< dynamic ones
    bool scripted = false;   ///< a scripted body does work that no report counts: rises are no faults
    bool free = false;       ///< nothing of infinite mass: momentum is kept, but for what gravity adds
    double time_step = 0, gravity = 0, friction = 0, restitution = 0;

    std::int64_t steps = 0;     ///< made
    bool cut = false;           ///< ended before all steps were made, for they took too long
    double rise = 0;            ///< largest, share of the scale
    double rise_joule = 0;      ///< the same one
    std::int64_t rise_step = 0; ///< when
    double growth = 0;          ///< highest energy above the start / (initial kinetic energy + sum m |g| size)
    double scale = 0;           ///< J, at the end
    double allowance = 0;       ///< J

    double momentum_drift = 0; ///< free scenes: largest change / (sqrt(2 M E) at the start + M |g| t)
    double angular_drift =
        0; ///< free scenes without gravity: largest change / (sqrt(2 M E) * farthest point) at the start

    std::int64_t collisions = 0, contacts = 0;           ///< summed over the steps
    std::int64_t merges = 0, rung_changes = 0, held = 0; ///< summed over the steps
    std::uint32_t warnings = 0;                          ///< of all steps
    std::int64_t corrections = 0;                        ///< by the last resort, where the report counts them
    double removed = 0;                                  ///< by it, J
    double seconds = 0;                                  ///< for all steps
};

template <std::size_t N>
void set_text(std::array<char, N>& field, const std::string& text) {
    field.fill('\0');
    text.copy(field.data(), N - 1);
}

/// Runs `steps` steps on the calling thread, fewer once `max_seconds` have passed. What the World throws ends the run
/// and is kept as its failure, as is an energy that is no number.
void record_energy(const SceneDescription& scene, std::int64_t steps, double max_seconds, EnergyRecord& record);

} // namespace flotilla::survey
