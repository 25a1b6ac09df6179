// SPDX-License-Identifier: MIT
#include "static_contact/growing_program.hpp"

#include <algorithm>
#include <limits>

namespace flotilla {
namespace {

/// A bound: cups took in their last contacts in the fifth round at most.
constexpr int kMostRounds = 16;

const Vec3& arm_of(const ConeContact& c) { return c.b >= 0 ? c.arm_b : c.arm_a; }

/// What a unit of normal impulse does to a body: the change of its momentum and of its angular momentum.
ConeMotion push_of(const ConeContact& c) { return {c.normal, cross(arm_of(c), c.normal)}; }

} // namespace

void GrowingProgram::list_pairs(std::span<const ConeContact> contacts) {
    pairs_.clear();
    for (std::size_t i = 0; i < contacts.size(); ++i)
        if (i == 0 || contacts[i].a != contacts[i - 1].a || contacts[i].b != contacts[i - 1].b) pairs_.push_back(i);
    pairs_.push_back(contacts.size());
}

/// And all at which scripts press: who asks for those needs their impulses.
void GrowingProgram::choose_first(std::span<const ConeContact> contacts, std::span<const Vec3> impulses) {
    chosen_.assign(contacts.size(), 0);
    difference_.resize(contacts.size());
    for (std::size_t p = 0; p + 1 < pairs_.size(); ++p) choose_of_pair(contacts, impulses, pairs_[p], pairs_[p + 1]);
    for (std::size_t i = 0; i < contacts.size(); ++i)
        if (contacts[i].pressed) chosen_[i] = 1;
}

/// The one of the largest load; then, one by one, the one whose push differs most from those that are chosen; and some
/// by their places in the list.
void GrowingProgram::choose_of_pair(std::span<const ConeContact> contacts, std::span<const Vec3> impulses,
                                    std::size_t first, std::size_t end) {
    const std::size_t count = end - first;
    for (std::size_t k = 0; k < kContactsAtOnce; ++k) chosen_[first + count * k / kContactsAtOnce] = 1;
    double size = 0; // m^2
    std::size_t next = first;
    for (std::size_t i = first; i < end; ++i) {
        size = std::max(size, length_sq(arm_of(contacts[i])));
        if (impulses[i].x > impulses[next].x) next = i;
        difference_[i] = std::numeric_limits<double>::infinity();
    }
    const auto differs = [&](const ConeMotion& x, const ConeMotion& y) {
        return size * length_sq(x.linear - y.linear) + length_sq(x.angular - y.angular);
    };
    for (std::size_t k = 0; k < kContactsAtOnce && difference_[next] > 0; ++k) {
        chosen_[next] = 1;
        const ConeMotion push = push_of(contacts[next]);
        for (std::size_t i = first; i < end; ++i)
            difference_[i] = std::min(difference_[i], differs(push_of(contacts[i]), push));
        next =
            first + static_cast<std::size_t>(std::max_element(difference_.begin() + static_cast<std::ptrdiff_t>(first),
                                                              difference_.begin() + static_cast<std::ptrdiff_t>(end)) -
                                             (difference_.begin() + static_cast<std::ptrdiff_t>(first)));
    }
}

/// Of the estimate what others carry along their normals goes to the nearest that is chosen.
void GrowingProgram::gather_loads(std::span<const ConeContact> contacts, std::span<Vec3> impulses) {
    for (std::size_t p = 0; p + 1 < pairs_.size(); ++p) {
        part_.clear();
        for (std::size_t i = pairs_[p]; i < pairs_[p + 1]; ++i)
            if (chosen_[i] != 0) part_.push_back(i);
        for (std::size_t i = pairs_[p]; i < pairs_[p + 1]; ++i) {
            if (chosen_[i] != 0 || impulses[i] == Vec3{}) continue;
            const auto distance = [&](std::size_t k) { return length_sq(arm_of(contacts[k]) - arm_of(contacts[i])); };
            impulses[*std::ranges::min_element(part_, {}, distance)].x += impulses[i].x;
            impulses[i] = {};
        }
    }
}

ConeSolveStats GrowingProgram::solve_part(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                                          const ConeSolveOptions& options, std::span<Vec3> impulses,
                                          ConeScratch& scratch) {
    part_.clear();
    contacts_.clear();
    impulses_.clear();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (chosen_[i] == 0) continue;
        part_.push_back(i);
        contacts_.push_back(contacts[i]);
        impulses_.push_back(impulses[i]);
    }
    const ConeSolveStats stats = solve_cone_program(bodies, contacts_, options, impulses_, scratch);
    for (std::size_t k = 0; k < part_.size(); ++k) impulses[part_[k]] = impulses_[k];
    return stats;
}

/// m/s.
double GrowingProgram::largest_approach_of_others() const {
    double largest = 0;
    for (std::size_t i = 0; i < chosen_.size(); ++i)
        if (chosen_[i] == 0) largest = std::max(largest, -velocities_[i].x);
    return largest;
}

/// Of each pair the others that approach fastest, faster than `limit`.
void GrowingProgram::take_in(double limit) {
    for (std::size_t p = 0; p + 1 < pairs_.size(); ++p) {
        approaching_.clear();
        for (std::size_t i = pairs_[p]; i < pairs_[p + 1]; ++i)
            if (chosen_[i] == 0 && -velocities_[i].x > limit) approaching_.push_back(i);
        const auto fastest =
            approaching_.begin() + static_cast<std::ptrdiff_t>(std::min(kContactsAtOnce, approaching_.size()));
        std::partial_sort(approaching_.begin(), fastest, approaching_.end(), [&](std::size_t x, std::size_t y) {
            return velocities_[x].x != velocities_[y].x ? velocities_[x].x < velocities_[y].x : x < y;
        });
        for (auto i = approaching_.begin(); i != fastest; ++i) chosen_[*i] = 1;
    }
}

ConeSolveStats GrowingProgram::solve(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                                     const ConeSolveOptions& options, std::span<Vec3> impulses, ConeScratch& scratch) {
    list_pairs(contacts);
    const bool bounded =
        std::ranges::any_of(contacts, [](const ConeContact& c) { return c.bound > 0; }); // each by itself
    if (bounded || contacts.size() <= std::max(kContactsAsTheyAre, 4 * kContactsAtOnce * (pairs_.size() - 1))) {
        chosen_.assign(contacts.size(), 1);
        return solve_part(bodies, contacts, options, impulses, scratch);
    }
    choose_first(contacts, impulses);
    gather_loads(contacts, impulses);
    velocities_.resize(contacts.size());
    int iterations = 0;
    for (int round = 1;; ++round) {
        ConeSolveStats stats = solve_part(bodies, contacts, options, impulses, scratch);
        iterations += stats.iterations;
        cone_velocities(bodies, contacts, impulses, motion_, velocities_);
        const double others = largest_approach_of_others();
        // What the part leaves undone others may as well.
        const double limit = std::max({options.tolerance, stats.rounding, stats.residual});
        if (!(others > limit) || round == kMostRounds) {
            stats.iterations = iterations;
            stats.residual = std::max(stats.residual, others);
            stats.yielded = stats.yielded && !(others > limit); // else what is not taken in was not asked to yield
            stats.solved = stats.solved && others <= std::max(options.tolerance, stats.rounding);
            return stats;
        }
        take_in(limit);
    }
}

} // namespace flotilla
