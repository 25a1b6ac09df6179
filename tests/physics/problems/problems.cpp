// SPDX-License-Identifier: MIT
#include "physics/problems/problems.hpp"

#include <cmath>

#include "physics/problems/impact.hpp"
#include "physics/problems/rolling.hpp"
#include "physics/problems/sliding.hpp"
#include "physics/problems/standing.hpp"
#include "physics/problems/tops.hpp"

namespace flotilla::physics {
namespace {

using List = std::vector<Problem>;

/// Of a share and an angle, relative.
double off(double share, double angle) { return std::hypot(share - 1, angle); }

void add_flight(List& list) {
    list.push_back({"projectile", "a spinning box thrown up flies for 2 s", "distance from the parabola, m", 1e-9, 2,
                    true, projectile, off_parabola});
    list.push_back({"free-top", "asymmetric top without gravity: 1.4 periods of two flips in 39.1 s",
                    "period, relative", 0.01, 55, true, asymmetric_top,
                    [](const History& h) { return std::abs(flip_period(h) / kFlipPeriod - 1); }});
    list.push_back({"symmetric-top", "symmetric top without gravity, 10 s", "direction of its axis, rad", 0.01, 10,
                    true, symmetric_top, axis_off});
}

void add_impacts(List& list) {
    for (const int percent : {50, 80}) {
        const double e = 0.01 * percent;
        list.push_back({"bounce-" + std::to_string(percent),
                        "a body on a point falls 5 m and bounces with restitution " + std::to_string(percent) + " %",
                        "height of the first three bounces, of the drop", 0.05, 1.3 * due_end_of_bouncing(e), true,
                        [=](const Start& s) { return bouncing(s, e); },
                        [=](const History& h) {
                            const Bounces b = bounces(h);
                            double worst = 0;
                            for (std::size_t i = 0; i < 3; ++i) {
                                const double rise = i < b.heights.size() ? b.heights[i] / kDrop : 0;
                                worst = std::max(worst, std::abs(rise - std::pow(e, 2.0 * static_cast<double>(i + 1))));
                            }
                            return worst;
                        }});
    }
    for (const int percent : {100, 50}) {
        const double e = 0.01 * percent;
        list.push_back({"cradle-" + std::to_string(percent),
                        "a row of five boxes hands on a blow, restitution " + std::to_string(percent) + " %",
                        "speed of the last one, of the first one's", 1e-3, 2.5, true,
                        [=](const Start& s) { return cradle(s, e); },
                        [=](const History& h) {
                            return std::abs(h.last(kCradleBodies - 1).velocity.x - due_cradle_speed(e)) / kCradleSpeed;
                        }});
    }
}

void add_sliding(List& list) {
    const Slope steep{30 * kDegree, 23 * kDegree};
    const double sliding_friction = 0.7 * std::tan(steep.angle);
    list.push_back({"slide", "a block slides down a slope of 30 degrees with 0.7 of the friction that holds it",
                    "acceleration as a vector, relative", 0.005, 1.5, true,
                    [=](const Start& s) { return block_on_slope(s, steep, sliding_friction); },
                    [=](const History& h) {
                        const Sliding found = sliding(h, steep, sliding_friction);
                        return off(found.share, found.turned);
                    }});
    const Slope slope{30 * kDegree, 0.5};
    const double barely = 0.999 * std::tan(slope.angle), held = 1.001 * std::tan(slope.angle);
    list.push_back({"slide-barely", "the same with 0.999 of that friction", "way in 2 s, relative", 0.1, 2, true,
                    [=](const Start& s) { return block_on_slope(s, slope, barely); },
                    [=](const History& h) {
                        return std::abs(way_down(h, slope) / (0.5 * slope.rate(barely) * h.end() * h.end()) - 1);
                    }});
    list.push_back({"hold", "a block on a slope of 30 degrees with 1.001 of the friction that holds it",
                    "way between 0.5 s and 2.5 s, m", 1e-6, 2.5, true,
                    [=](const Start& s) { return block_on_slope(s, slope, held); },
                    [](const History& h) { return length(h.last(0).position - h.at(0.5, 0).position); }});
    const double heading = 23 * kDegree;
    list.push_back({"thrown-block", "a block slides over the level until friction stops it",
                    "way as a vector, relative", 0.01, 2.5, true,
                    [=](const Start& s) { return thrown_block(s, heading); },
                    [=](const History& h) {
                        const Thrown found = thrown(h, heading);
                        return off(found.share, found.turned);
                    }});
}

/// Of the speed gained on a slope: where the angle grows with the square of time sides cost two thirds of what they do
/// at the last speed, the mean of 1 - t^2.
double sides_down(const Roller& roller, double slope, double time) {
    const double angle = 0.5 * kGravity * std::sin(slope) / (1 + roller.inertia) / kRollerRadius * time * time;
    return 2.0 / 3 * (1 - kept_by_facets(roller, angle));
}

void add_rolling(List& list) {
    constexpr double kSpeed = 0.5, kSlope = 5 * kDegree, kSteep = 30 * kDegree;
    list.push_back({"roll", "a cylinder rolls on the level for 2 s", "speed, relative", 0.013, 2, true,
                    [=](const Start& s) {
                        return rolling_scene(s, kCylinder, {0, 0.5, kSpeed, kSpeed / kRollerRadius});
                    },
                    [=](const History& h) { return std::abs(h.last(0).velocity.x / kSpeed - 1); }, 0,
                    1 - kept_by_facets(kCylinder, kSpeed * 2 / kRollerRadius)});
    list.push_back({"roll-down", "a cylinder rolls down a slope of 5 degrees for 2 s", "speed, relative", 0.02, 2, true,
                    [=](const Start& s) {
                        return rolling_scene(s, kCylinder, {kSlope, 0.5});
                    },
                    [=](const History& h) { return std::abs(rolled_share(h, kCylinder, kSlope) - 1); }, 0,
                    sides_down(kCylinder, kSlope, 2)});
    struct Named {
        const char *name, *what;
        const Roller* roller;
    };
    for (const Named& n : {Named{"slide-to-roll", "a cylinder", &kCylinder},
                           Named{"ball-to-roll", "a ball (of 1,280 triangles)", &kCoarseBall}}) {
        const Roller& roller = *n.roller;
        const SlideToRoll due = due_to_roll(roller);
        list.push_back({n.name, std::string(n.what) + " slides until it rolls", "speed when it rolls, relative", 0.02,
                        1.3 * due.time, true,
                        [&](const Start& s) {
                            return rolling_scene(s, roller, {0, kRollingFriction, kRollingSpeed});
                        },
                        [=](const History& h) { return std::abs(slide_to_roll(h).speed / due.speed - 1); }, 0,
                        1 - kept_by_facets(roller, 0.5 * due.speed / kRollerRadius * due.time)});
    }
    const double little = 0.7 * least_rolling_friction(kCylinder, kSteep);
    list.push_back({"slip", "a cylinder on a slope of 30 degrees with 0.7 of the friction that makes it roll",
                    "slip over speed at 0.5 s, difference", 0.01, 0.5, true,
                    [=](const Start& s) {
                        return rolling_scene(s, kCylinder, {kSteep, little});
                    },
                    [=](const History& h) { return std::abs(slip(h, kSteep) - due_slip(kCylinder, kSteep, 0.7)); }, 0,
                    sides_down(kCylinder, kSteep, 0.5)});
}

void add_swinging(List& list) {
    list.push_back({"heavy-top", "a top on its tip precesses steadily for 8 s, 15 rad/s", "direction of its axis, rad",
                    0.05, kHeavyTopTime, false, heavy_top, heavy_top_off});
    list.push_back({"tipping-block", "a block tips over its edge, 0.4 s", "place of its centre, arms", 0.01,
                    kTippingTime, true, tipping_block,
                    [](const History& h) { return tipping(h).off / std::hypot(0.1, 0.3); }});
    list.push_back({"eulers-disk", "a disk rolls around its own middle, 0.5 s",
                    "the larger of those of W^2 sin(alpha) and of sin(alpha), relative", 0.1, 0.5, false, eulers_disk,
                    [](const History& h) {
                        const Disk found = disk(h);
                        return std::max(found.worst, std::abs(found.sine - 1));
                    }});
    list.push_back({"knife-edge", "a ring swings on a knife edge, seven periods",
                    "the larger of those of period and amplitude, relative", 0.1, kRingPeriods * due_ring_period(),
                    false, ring_on_knife_edge, [](const History& h) {
                        const Swing found = swing(h);
                        return std::max(std::abs(found.kept - 1), std::abs(found.period / due_ring_period() - 1));
                    }});
    const HangingChain chain(12);
    list.push_back({"chain", "a chain of 12 links swings, 2.3 periods", "frequency, relative", 0.02,
                    2.3 * 2 * kPi / chain.frequency(), false, [=](const Start& s) { return chain.scene(s); },
                    [=](const History& h) { return std::abs(chain.found(h).frequency / chain.frequency() - 1); }});
}

void add_stacks(List& list) {
    for (const int boxes : {10, 50}) {
        const std::vector<double> equal(static_cast<std::size_t>(boxes), 1.0);
        list.push_back({"stack-" + std::to_string(boxes), std::to_string(boxes) + " boxes of 1 m stand for 5 s",
                        "farthest that one moved, edges", boxes <= 20 ? 1e-3 : 0.01, 5, true,
                        [=](const Start& s) { return resting_stack(s, equal); },
                        [](const History& h) { return h.farthest(); }});
    }
    list.push_back({"heavy-on-light", "a box of 1,000 kg on one of 1 kg, 5 s", "farthest that one moved, edges", 1e-3,
                    5, true,
                    [](const Start& s) {
                        return resting_stack(s, {1, 1000});
                    },
                    [](const History& h) { return h.farthest(); }});
}

void add_thresholds(List& list) {
    list.push_back({"arch", "seven stones in a semicircle, 5 % thicker than the least that stands, 8 s",
                    "farthest that one moved, radii", 0.002, kArchTime, true,
                    [](const Start& s) { return arch(s, 7, 1.05 * 0.0962, 1); },
                    [](const History& h) { return h.farthest() / kArchRadius; }, kArchGap});
    list.push_back({"cards", "two cards lean on each other with 1.05 of the least friction, 4 s",
                    "farthest that one moved, lengths", 1e-3, 4, true,
                    [](const Start& s) { return leaning_cards(s, 1.05); },
                    [](const History& h) { return h.farthest(); }, kCardGap});
    list.push_back({"card-house", "a house of 15 cards, 5 s", "farthest that one moved, lengths", 0.05, 5, true,
                    // Cards have no thickness: other engines' are thin boxes that fill the rest distances.
                    [](const Start& s) { return card_house(s, 3, 0.5); },
                    [](const History& h) { return h.farthest() / kCardLength; }, house_gap()});
    list.push_back({"pinched-block", "a block held between two cylinders with 1.05 of the least friction, 5 s",
                    "distance that it sank, edges", 1e-3, 5, true,
                    [](const Start& s) { return pinched_block(s, 1.05, 1.05); },
                    [](const History& h) { return std::abs(sunk(h)); }});
    const auto falls = [](double most) { return [=](const History& h) { return h.farthest() > most ? 0.0 : 1.0; }; };
    const std::string wrong = "0: it falls; 1: it stands";
    list.push_back({"arch-falls", "the same arch, 5 % thinner than the least that stands", wrong, 0.5, kArchTime, true,
                    [](const Start& s) { return arch(s, 7, 0.95 * 0.0962, 1); }, falls(kArchMoves), kArchGap});
    list.push_back({"cards-slip", "the two cards with 0.95 of the least friction", wrong, 0.5, 4, true,
                    [](const Start& s) { return leaning_cards(s, 0.95); }, falls(0.05), kCardGap});
    list.push_back({"pinched-slips", "the block between cylinders with 0.95 of the least friction at the block", wrong,
                    0.5, 3, true, [](const Start& s) { return pinched_block(s, 0.95, 2); }, falls(0.1)});
}

} // namespace

const std::vector<Problem>& problems() {
    static const List kList = [] {
        List list;
        add_flight(list);
        add_impacts(list);
        add_sliding(list);
        add_rolling(list);
        add_swinging(list);
        add_stacks(list);
        add_thresholds(list);
        return list;
    }();
    return kList;
}

const Problem* find_problem(const std::string& name) {
    for (const Problem& p : problems())
        if (p.name == name) return &p;
    return nullptr;
}

} // namespace flotilla::physics
