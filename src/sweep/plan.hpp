// SPDX-License-Identifier: MIT
// Which runs a campaign consists of: every point (a choice of settings) from every start (a scene, or a seed of it).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <flotilla/scene_file.hpp>
#include <flotilla/sweep.hpp>

namespace flotilla::sweep {

inline constexpr std::string_view kPreset = "preset", kSeed = "seed", kTimeStep = "time_step";

struct Start {
    std::string name;
    std::filesystem::path file;        ///< that runs read; of a scene of the library, to be written by the campaign
    bool generated = false;            ///< by the library
    std::string text;                  ///< JSON
    std::optional<std::uint64_t> seed; ///< of the scene of the library, and the setting of that name
};

struct Point {
    std::string label; ///< "preset=preview time_step=0.01", for people
    std::string name;  ///< the same as a part of a file name
    std::vector<std::string> values;
    SceneFileOptions options; ///< without a start's seed
    bool reference = false;   ///< what others are compared with
    bool own = false;         ///< it is no member of the product
};

struct Member {
    SweepMember run;
    std::size_t point = 0, start = 0;
    std::uint64_t input = 0; ///< checksum of all that its results depend on
};

struct Plan {
    std::vector<SweepAxis> axes; ///< without seeds, values as settings print them
    std::vector<Start> starts;
    std::vector<Point> points;      ///< the first axis changes slowest; a reference of its own comes last
    std::vector<Member> members;    ///< start by start, so that the first of them already shows a whole front
    std::size_t base = 0;           ///< the point whose values are those without `vary`, or the first ones
    double duration = 0;            ///< s
    std::string title;              ///< the first scene, and how many others
    std::vector<std::string> notes; ///< what the user should know before the runs

    [[nodiscard]] std::optional<std::size_t> reference() const;
};

/// Throws InputError with everything that is wrong.
[[nodiscard]] Plan make_plan(const SweepOptions& options);

/// The scene that a member simulates.
[[nodiscard]] SceneDescription scene_of(const Plan& plan, const Member& member);

} // namespace flotilla::sweep
