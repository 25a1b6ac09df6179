// SPDX-License-Identifier: MIT
// What a motion is judged by, whoever made it: the states of all bodies at equal steps. SI units.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <flotilla/settings.hpp>
#include <flotilla/world.hpp>

#include "physics/problems/scenes.hpp"

namespace flotilla::physics {

/// How a problem begins.
struct Start {
    Settings settings;
    /// Bodies that touch begin at the rest distance that flotilla keeps; else, for engines whose solids touch, a
    /// millionth of it within each other, so that rounding does not choose which corners do.
    bool apart = true;

    Start(const Settings& s, bool keep_apart = true) : settings(s), apart(keep_apart) {} // NOLINT: implicit on purpose
    [[nodiscard]] double gap(const TriangleMesh& mesh) const { return apart ? rest_gap(mesh) : -1e-6 * rest_gap(mesh); }
    [[nodiscard]] double gap(double rest_distance) const {
        return apart ? 1.0001 * rest_distance : -1e-6 * rest_distance;
    }
};

struct Instant {
    double time = 0; ///< s
    std::vector<BodyState> bodies;
};

class History {
  public:
    explicit History(double dt) : dt_(dt) {}
    void add(Instant instant) { instants_.push_back(std::move(instant)); }

    [[nodiscard]] double dt() const { return dt_; }
    [[nodiscard]] const std::vector<Instant>& instants() const { return instants_; }
    [[nodiscard]] double end() const { return instants_.back().time; }
    /// Of a body at the start, at the end, and at the first instant from `time` on (to half a step).
    [[nodiscard]] const BodyState& first(std::size_t body) const { return instants_.front().bodies[body]; }
    [[nodiscard]] const BodyState& last(std::size_t body) const { return instants_.back().bodies[body]; }
    [[nodiscard]] const BodyState& at(double time, std::size_t body) const {
        const auto found = std::find_if(instants_.begin(), instants_.end(),
                                        [&](const Instant& i) { return i.time >= time - 0.5 * dt_; });
        return (found == instants_.end() ? instants_.back() : *found).bodies[body];
    }
    /// m, the farthest that any centre of mass is from its start at the end.
    [[nodiscard]] double farthest() const {
        double most = 0;
        for (std::size_t i = 0; i < instants_.front().bodies.size(); ++i)
            most = std::max(most, length(last(i).center_of_mass - first(i).center_of_mass));
        return most;
    }

  private:
    double dt_; ///< s
    std::vector<Instant> instants_;
};

/// Times at which a quantity changes its sign, on straight lines between instants.
class Crossings {
  public:
    explicit Crossings(double first) : before_(first) {}
    /// Whether it did.
    bool add(double time, double value, double dt) {
        const bool crosses = value * before_ < 0;
        if (crosses) times_.push_back(time - dt * value / (value - before_));
        before_ = value;
        return crosses;
    }
    [[nodiscard]] std::size_t count() const { return times_.size(); }
    [[nodiscard]] double time(std::size_t i) const { return i < times_.size() ? times_[i] : 0; }
    /// s, of the mean oscillation; 0 where there is none.
    [[nodiscard]] double period() const {
        return count() > 1 ? 2 * (times_.back() - times_.front()) / static_cast<double>(count() - 1) : 0;
    }

  private:
    double before_;
    std::vector<double> times_;
};

} // namespace flotilla::physics
