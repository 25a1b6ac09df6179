// SPDX-License-Identifier: MIT
// Hits within the step act from when they happen.
//
// An impulse of stage 1 changes velocities at x^n, wherever on the way the bodies meet: a crate that falls 4 m/s at
// 1/24 s turned round in the air, up to 17 cm above the floor, and had the energy of that height left. So a part of the
// impulse is late (Clusters::delay): velocities have it, the way of this step has not. As much is late as leaves the
// height above the place of the hit what the hit leaves of the energy: with the restitution e, the speed has e of what
// it was, and the height e^2 of the gap. A crate that falls on the floor lies on it at the end of the step (e = 0), and
// a rebound comes as high as it should: 1 m, restitution 0.3, 0.5 and 0.8, 1/24 s, 2.1, 1.31 and 1.06 times as high
// without, 1.04, 1.01 and 1.00 times with it. With e = 1 nothing is late.
//
// That height makes up for what gravity did on the way. Where loads do nothing along the normal, to two bodies that
// meet in flight, the part of the impulse that is late is the part of the step that is over: bodies are then where they
// are after a hit at that time, and keep their angular momentum.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pair/step_view.hpp"
#include "pair/worker.hpp"
#include "state/contact.hpp"
#include "state/model.hpp"

namespace flotilla {

/// Contacts at x^n, sorted by bodies, the rest distances of their pairs, m, and what they carried in the step before.
struct ContactsAtStart {
    std::span<const Contact> contacts;
    std::span<const double> rest;
    std::span<const WarmImpulse> impulses; ///< sorted by bodies
};

/// What bodies touch at x^n.
class Touching {
  public:
    void start(std::size_t bodies, const ContactsAtStart& known);
    /// Whether a part of a blow by a on b, along the unit normal from a to b, may be late for them. Never for what has
    /// infinite mass. So it is where a body touches nothing but maybe the other, or where something is late for it
    /// already; and, if the other's part is as well or the other has infinite mass, where it touches besides only what
    /// it moves along, at right angles to the blow, or, hit by what has infinite mass or is late itself, what comes
    /// along with it against the blow and carries nothing: boxes that fall one on the other. Elsewhere its contacts
    /// answer from the start of the step on.
    [[nodiscard]] std::pair<bool, bool> may_be_late(const Clusters& clusters, std::int32_t a, std::int32_t b,
                                                    const Vec3& normal) const;

  private:
    /// Whether what a body touches lets a part of a blow be late for it: for it alone, or with the other's.
    enum class Late : std::uint8_t { no, with_other, alone };
    struct Touch {
        std::int32_t other;
        bool loaded; ///< the pair carried something
        Vec3 away;   ///< unit, in which it pushes the body
    };
    [[nodiscard]] Late late_of(const Clusters& clusters, std::int32_t body, std::int32_t other, const Vec3& away) const;

    std::vector<std::size_t> first_; ///< by body, and the end of the last
    std::vector<std::size_t> next_;  ///< scratch
    std::vector<Touch> touches_;     ///< by body
};

/// Of the bodies a and b of a pair.
struct OfBoth {
    double a = 0, b = 0;
};
/// The shares of a pair's impulse that are late for its bodies, in [0, 1]. `change`: m/s, by which the impulse parts
/// the points of the hit along the normal, by what it does to each body. What loads add in the half step that follows
/// is left room for, as if the other body were held up; a gap within the rest distance is none.
[[nodiscard]] OfBoth late_shares(const StepView& view, const Touching& touching, const CandidatePair& pair,
                                 const Landing& landing, const OfBoth& change);

/// Of a hit whose velocities part: takes back as much of what is late for its bodies as keeps the way of the points
/// apart. What was late was so much where the other body was by then. Whether it could; the ends follow with evolve().
bool hasten(const StepView& view, Clusters& clusters, const CandidatePair& pair, const ContactPoint& hit,
            const Landing& landing);

} // namespace flotilla
