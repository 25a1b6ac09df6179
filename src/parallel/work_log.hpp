// SPDX-License-Identifier: MIT
// What the divided work of a step consists of (division.hpp), whoever does it: from a log of one rank follows what any
// number of ranks would do and say (src/mpi/cost_model.hpp). Times are of the thread's processor time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace flotilla {

/// Something that the owner of a body does.
struct LoggedItem {
    std::int32_t body = -1;
    std::int64_t ns = 0;
};
/// Items side by side, and what is told to all afterwards.
struct LoggedLoop {
    std::vector<LoggedItem> items;
    std::size_t bytes = 0;
};

/// Tasks wave by wave, in each the clusters that it uses (-1: none).
struct LoggedSweep {
    struct Task {
        std::size_t wave = 0;
        std::array<std::int32_t, 2> clusters{};
        std::int64_t ns = 0;
    };
    std::vector<Task> tasks;
    std::size_t changed = 0;       ///< clusters with other end states than before the sweep
    std::size_t cluster_bytes = 0; ///< of a cluster that is handed on
    std::size_t bytes = 0;         ///< that are told to all afterwards
};

/// Contact sweeps over packets of several colours.
struct LoggedContacts {
    struct Packet {
        std::int32_t color = 0, payer = -1;
        std::vector<std::int32_t> bodies; ///< movable
        std::int64_t rows = 0;
    };
    std::vector<Packet> packets;
    std::int64_t sweeps = 0, sweep_ns = 0;           ///< ns of all sweeps together
    std::int64_t evaluations = 0, evaluation_ns = 0; ///< likewise
    std::size_t body_bytes = 0;                      ///< of a body that is handed on
    std::size_t impulse_bytes = 0;                   ///< told to all at the end; 0: nothing is
};

using LoggedSection = std::variant<LoggedLoop, LoggedSweep, LoggedContacts>;

struct WorkLog {
    std::vector<LoggedSection> sections; ///< of the step under way, in their order
    std::vector<LoggedItem> items;       ///< of the section under way
    std::int64_t own_ns = 0;             ///< that it took to write all this, as far as that is much
};

} // namespace flotilla
