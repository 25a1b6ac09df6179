// SPDX-License-Identifier: MIT
// Contacts that yield (interior_point.cpp).
#include <algorithm>

#include "static_contact/cone_solver.hpp"

namespace flotilla {
namespace {

// How many times over impulses that contradict each other stop the heaviest body at the largest velocity: as much as
// friction asks for whose coefficient is a hundredth. The larger, the harder is the problem: at 2^10 rows of six boxes
// between a script and a wall were left unsolved.
constexpr double kMostLoad = 0x1p6;
constexpr double kYielded = 1.0 / 16; // of that: more than a script presses with where nothing yields
// What the contacts of a chain of bodies lack together one may lack alone, or the last that sweeps visit, twice.
constexpr double kOneSided = 2;
constexpr double kYieldingLeaves = 1.0 / 16; // of the residual without: less is nearly solved
// How much contacts yield to friction, of how much they do to normal impulses. With none the methods seldom end where
// several bodies are pressed: they turn a little, what sticks may not slip for it, and friction answers with all that
// it has.
constexpr double kSlip = 1.0 / 64;
constexpr int kPressedIterations = 24; // of contacts that yield to a script

} // namespace

bool ConeSolver::pressed() const {
    return std::ranges::any_of(p_.contacts, [](const ConeProgram::Contact& c) { return c.pressed; });
}

// Whether contacts of scripts have the load of those that yield: more than where nothing contradicts them.
bool ConeSolver::loaded() const {
    const double load = kYielded * kMostLoad * speed_ / least_diagonal();
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i)
        if (p_.contacts[i].pressed) sum += s_.best[i].x;
    return sum > load;
}

// The methods where contacts yield, by so much that impulses which answer what is left stop the heaviest body at the
// largest velocity many times over. Keeps the result where that is nearly solved; whether it is.
bool ConeSolver::yield(std::span<const Vec3> estimate, int most_iterations) {
    const ConeSolveStats rigid = stats_;
    s_.rigid = s_.best;
    compliance_ = rigid.residual / (kMostLoad * speed_) * least_diagonal();
    slip_ = kSlip * compliance_;
    before_ = stats_.iterations;
    most_iterations_ = most_iterations;
    stats_.residual = kInfinity;
    std::copy(estimate.begin(), estimate.end(), s_.r.begin());
    newton(kFirstNewtonSteps, 0);
    if (!done()) find();
    const bool solved = stats_.residual <= std::max(limit(), kYieldingLeaves * rigid.residual);
    stats_.yielding_left = stats_.residual;
    compliance_ = slip_ = 0;
    before_ = 0;
    most_iterations_ = options_.max_iterations;
    stats_.residual = kInfinity;
    s_.r = s_.best;
    consider();
    stats_.yielded = solved && stats_.residual <= kOneSided * (1 + p_.num_columns / 6) * rigid.residual;
    if (!stats_.yielded) keep_rigid(rigid);
    return solved;
}

void ConeSolver::keep_rigid(const ConeSolveStats& rigid) {
    stats_.residual = rigid.residual;
    stats_.rounding = rigid.rounding;
    stats_.yielded = false;
    s_.best = s_.rigid;
}

// What a script presses on mostly has no solution: contacts yield at once, and what rests and is not found so within
// some factorisations either is left. Returns whether that is all.
bool ConeSolver::yield_to_script(std::span<const Vec3> estimate) {
    s_.r = s_.best;
    newton(kFirstNewtonSteps, 0);
    if (!in_need()) return false;
    const ConeSolveStats rigid = stats_;
    const int left = options_.max_iterations - stats_.iterations;
    const bool solved = yield(estimate, std::min(kPressedIterations, left));
    if (stats_.yielded && loaded()) return true;
    if (stats_.yielded) keep_rigid(rigid);
    return !solved && options_.rests;
}

} // namespace flotilla
