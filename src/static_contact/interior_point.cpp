// SPDX-License-Identifier: MIT
// The law in cone form (De Saxce, Feng 1998): with x = (mu r_n, r_t) and y = (u_n / mu + |u_t|, u_t), which is u + mu
// |u_t| n scaled likewise, it reads x in L, y in L, x perpendicular to y, for the Lorentz cone L. But for the term
// |u_t| this is a convex second-order cone program with W = H H^T.
//
// A contact may have a bound of friction that is given, beside mu r_n: method 1 and the sweeps of 3 know it.
//
// Three methods, each begun only where those before it failed:
//  1. Semismooth Newton on the residual itself, from the best impulses known (Alart, Curnier 1991). A few steps solve
//     what is nearly solved and most problems of a few bodies. It has no guarantee from afar.
//  2. Primal-dual interior point: Mehrotra's predictor and corrector with the scaling of Nesterov and Todd. Acary,
//     Armand, Nguyen, Shpakovych (2023) solve the convex relaxation so and correct |u_t| outside; here its derivative
//     is part of the Newton matrix, which is then not symmetric. Measured on 540 random problems: 282 unsolved without
//     the derivative, 178 with it, most of them with mu >= 10. The law is not monotone, and its central path may turn
//     back: at such a fold the determinant of the Newton matrix changes its sign, its solution changes to the opposite
//     direction, and steps that only go down end there, each shorter than the one before. There the path itself is
//     followed, along its tangent in the sense that the sign says, over the fold and down again behind it. Method 1 is
//     tried on the way: the last digits are its. Where light bodies are between heavy ones it begins once more, with
//     larger impulses (kFarHeavier).
//  3. Rounds of projected Gauss-Seidel and method 1, for what the interior point does not reach: the sweeps choose
//     between sticking and opening contact by contact.
// The best impulses of all are kept throughout.
//
// Jaws that press a body nearer than its rest distance, closing walls, a wedge that locks itself: there normal impulses
// contradict each other, nothing meets the law, and the largest violation, theirs, says nothing of friction. What the
// methods leave of it is by chance: boxes slid out of jaws by a third of gravity, and fell where no impulse at all was
// as good as any. So where the methods leave a tenth of the largest velocity, or a script presses, contacts yield: u +
// E r takes the place of u. That has a solution, with friction as the law says, and the same methods find it. The
// compliance E is such that normal impulses which answer all that is left stop the largest velocity many times over:
// they hold by friction what they press, however slowly they are pressed on, and others hardly yield.
#include "static_contact/interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/inverse.hpp"
#include "static_contact/cone_solver.hpp"

namespace flotilla {

ConeScratch::ConeScratch() : storage_(std::make_unique<Storage>()) {}
ConeScratch::~ConeScratch() = default;
ConeScratch::ConeScratch(ConeScratch&&) noexcept = default;
ConeScratch& ConeScratch::operator=(ConeScratch&&) noexcept = default;

namespace {

constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon(); // of velocities, as a share of W |r|

// A residual, as a share of the largest velocity, that methods 2 and 3 get below only by chance. Where a contact
// neither carries nor parts, its impulse and its velocity both are as the square root of their product, and the
// products end at the rounding, 2^-52. Many bodies at rest hold such contacts, and with the impulses of the step before
// are nearer to the solution than that.
constexpr double kInteriorFloor = 0x1p-26;
// Floors: problems of stacks and walls at rest end between half of one and three. Who asks there for less than four is
// given what Newton's steps reach within them.
constexpr double kOutOfReach = 4;

constexpr int kRounds = 10, kSweepsPerRound = 400, kStepsPerRound = 6;
// Between closing walls no impulses meet the law: a residual above this share of the largest velocity, of which a round
// leaves more than that other, is not worth another one.
constexpr double kHopeless = 0.1, kRoundGains = 0.8;

// Where the heaviest body asks for so many times the impulse that a contact's own bodies do, with their levers, those
// of method 2 do not grow in time from the latter: products come down far ahead of the infeasibility, and steps end at
// the cones' edges. Begun with what stops the heaviest it finds solutions, but some of them of impulses that balance
// each other: it comes second.
constexpr double kFarHeavier = 32;

Vec3 cut_to_cone(const Vec3& r, double friction, double given) {
    const double normal = std::max(r.x, 0.0);
    if (!(normal > 0) && given == 0) return {};
    const double bound = friction * normal + given, size = tangential_length(r);
    // What was cut before stays as it is.
    return size > (1 + kRounding) * bound ? Vec3{normal, bound / size * r.y, bound / size * r.z}
                                          : Vec3{normal, r.y, r.z};
}

// (I + B E)^-1 B
Mat3 softened(const Mat3& b, const Vec3& compliance) {
    return transpose(inverse_of_transpose(identity() + b * diagonal(compliance))) * b;
}

} // namespace

bool ConeSolver::finite_input() const {
    for (const ConeProgram::Contact& c : p_.contacts)
        if (!is_finite(c.q) || !std::isfinite(c.friction) || !std::isfinite(c.bound)) return false;
    for (const ConeProgram::Entry& e : p_.entries)
        if (!is_finite(e.h)) return false;
    for (const ConeDiagonal& w : s_.w) // a mass that is not finite has no entries, but shows here
        if (!std::isfinite(w.normal) || !std::isfinite(w.tangential)) return false;
    return true;
}

double ConeSolver::largest_velocity() const {
    double largest = 0;
    for (std::size_t i = 0; i < size(); ++i)
        if (movable(i)) largest = std::max(largest, length(p_.contacts[i].q));
    return largest;
}

// 1/kg: of the contacts' normal directions, that of the heaviest bodies.
double ConeSolver::least_diagonal() const {
    double least = kInfinity;
    for (std::size_t i = 0; i < size(); ++i)
        if (movable(i)) least = std::min(least, s_.w[i].normal);
    return least;
}

// 1/kg: of contacts, that of the lightest bodies.
double ConeSolver::largest_diagonal() const {
    double largest = 0;
    for (std::size_t i = 0; i < size(); ++i)
        if (movable(i)) largest = std::max(largest, std::max(s_.w[i].normal, s_.w[i].tangential));
    return largest;
}

// Cuts r to the cones, sets u and returns the residual; keeps r where it is better, or the last that is no worse than
// `as_good` and than the rounding of the best.
double ConeSolver::consider(double as_good) {
    for (std::size_t i = 0; i < size(); ++i)
        s_.r[i] = movable(i) ? cut_to_cone(s_.r[i], has_friction(i) ? friction(i) : 0, has_friction(i) ? given(i) : 0)
                             : Vec3{};
    if (bodies_.empty()) {
        s_.system.gather(s_.r);
        for (std::size_t i = 0; i < size(); ++i) s_.u[i] = p_.contacts[i].q + s_.system.spread(i);
    } else {
        cone_velocities(bodies_, contacts_, s_.r, s_.motion, s_.u);
    }
    double residual = 0, load = 0;
    for (std::size_t i = 0; i < size(); ++i) {
        s_.u[i] += yields(i, s_.r[i]);
        const double violation = cone_violation(s_.w[i], friction(i), s_.r[i], s_.u[i], given(i));
        if (!std::isfinite(violation)) return kInfinity;
        residual = std::max(residual, violation);
        load = std::max(load, std::max(s_.w[i].normal, s_.w[i].tangential) * length(s_.r[i]));
    }
    rounding_ = kRounding * load;
    if (residual < stats_.residual || residual <= std::min(as_good, stats_.rounding)) {
        stats_.residual = residual;
        stats_.rounding = rounding_;
        s_.best = s_.r;
    }
    return residual;
}

// m/s: a residual that methods 2 and 3 are not begun for.
double ConeSolver::not_worth_more() const {
    const double floor = kInteriorFloor * speed_;
    const bool out_of_reach = options_.rests && options_.enough < kOutOfReach * floor;
    return out_of_reach ? kOutOfReach * floor : std::min(options_.enough, floor);
}

// Of a step dr = c - B du, where du is of the bodies and of what contacts yield, E dr: the same step is
// dr = M c - M B du of the bodies alone, with M = (I + B E)^-1 = I - (M B) E.
bool ConeSolver::factorise() {
    ++stats_.iterations;
    if (compliance_ > 0)
        for (std::size_t i = 0; i < size(); ++i)
            if (s_.b[i].m[0] > 0) s_.b[i] = softened(s_.b[i], yields(i, {1, 1, 1}));
    return s_.system.factorise(s_.b);
}

bool ConeSolver::solve() {
    if (compliance_ > 0)
        for (std::size_t i = 0; i < size(); ++i) s_.c[i] -= s_.b[i] * yields(i, s_.c[i]);
    return s_.system.solve(s_.c, s_.du);
}

// Method 3: visits as in local_contact.hpp, from r.
void ConeSolver::sweep(int count) {
    s_.system.gather(s_.r);
    for (std::size_t i = 0; i < size(); ++i) {
        s_.b[i] = s_.system.own_block(i);
        s_.b[i] = s_.b[i] + diagonal(yields(i, {1, 1, 1}));
    }
    for (int k = 0; k < count; ++k)
        for (std::size_t i = 0; i < size(); ++i) {
            if (!movable(i)) continue;
            const ConeDiagonal& w = s_.w[i];
            const double normal = w.normal + compliance_, tangential = w.tangential + slip_;
            const Vec3 before = s_.r[i];
            const Vec3 u_before = p_.contacts[i].q + s_.system.spread(i) + yields(i, before);
            Vec3 r = before, u = u_before;
            for (int visit = 0; visit < 3; ++visit) {
                r.x = std::max(r.x - u.x / normal, 0.0);
                u = u_before + s_.b[i] * (r - before);
                if (!has_friction(i)) break;
                r = cut_to_cone({r.x, r.y - u.y / tangential, r.z - u.z / tangential}, friction(i), given(i));
                u = u_before + s_.b[i] * (r - before);
            }
            s_.r[i] = r;
            s_.system.add(i, r - before);
        }
}

// The best impulses may balance each other, of which sweeps take back next to nothing; those that begin without any
// have none of that. What is no solution either is not kept.
void ConeSolver::begin_anew() {
    const ConeSolveStats before = stats_;
    s_.before = s_.best;
    s_.r.assign(size(), {});
    sweep(kSweepsPerRound);
    newton(kStepsPerRound, 0);
    if (stats_.residual <= options_.enough) return;
    stats_.residual = before.residual;
    stats_.rounding = before.rounding;
    s_.best = s_.before;
}

// The three methods, from the best impulses.
void ConeSolver::find() {
    s_.r = s_.best;
    newton(kFirstNewtonSteps, options_.polish);
    const double near = not_worth_more();
    const auto far = [&] { return options_.polish == 0 && !done() && stats_.residual > near; };
    if (far()) {
        if (!options_.newton) {
            interior();
            const bool unsolved = options_.enough > 0 && stats_.residual > options_.enough;
            if (far() && unsolved && compliance_ == 0 && kFarHeavier * least_inv_mass() < largest_diagonal())
                interior(least_inv_mass());
        }
        s_.r = s_.best;
        newton(options_.max_iterations, 0); // loads of a heavy body on light ones end slowly, but they end
    }
    // What moves meets another problem in the next step.
    const auto goes_on = [&] {
        return far() && !options_.newton && (options_.rests || stats_.residual > options_.enough);
    };
    const bool unsolved = options_.enough > 0 && stats_.residual > options_.enough;
    if (goes_on() && unsolved && compliance_ == 0 && !pressed()) begin_anew();
    for (int round = 0; round < kRounds && goes_on(); ++round) {
        const double before = stats_.residual;
        s_.r = s_.best;
        sweep(kSweepsPerRound);
        newton(kStepsPerRound, 0);
        if (!(stats_.residual < before)) break; // the next round would be the same
        if (stats_.residual > std::max(kHopeless * speed_, kRoundGains * before)) break;
    }
}

ConeSolveStats ConeSolver::run(std::span<Vec3> impulses) {
    s_.resize(size());
    s_.best.assign(size(), {});
    stats_.residual = kInfinity;
    if (finite_input()) {
        s_.system.analyse(p_);
        speed_ = largest_velocity();
        consider();
        std::copy(impulses.begin(), impulses.end(), s_.r.begin());
        consider();
        at_start_ = stats_.residual;
        const bool presses = pressed() && options_.polish == 0;
        if (!presses || !yield_to_script(impulses)) {
            find();
            const bool contradicts = presses || stats_.residual > kHopeless * speed_;
            if (contradicts && in_need() && !options_.newton) yield(impulses, options_.max_iterations);
        }
    }
    stats_.solved = stats_.residual <= limit();
    std::copy(s_.best.begin(), s_.best.end(), impulses.begin());
    return stats_;
}

ConeSolveStats solve_cone_program(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                                  const ConeSolveOptions& options, std::span<Vec3> impulses, ConeScratch& scratch) {
    ConeScratch::Storage& s = scratch.storage();
    build_cone_program(bodies, contacts, s.program, s.w);
    return ConeSolver(bodies, contacts, s.program, options, s).run(impulses);
}

ConeSolveStats solve_cone_program(const ConeProgram& program, const ConeSolveOptions& options, std::span<Vec3> impulses,
                                  ConeScratch& scratch) {
    ConeScratch::Storage& s = scratch.storage();
    set_diagonals(program, s.w);
    return ConeSolver({}, {}, program, options, s).run(impulses);
}

} // namespace flotilla
