// SPDX-License-Identifier: MIT
// The law in cone form (De Saxce, Feng 1998): with x = (mu r_n, r_t) and y = (u_n / mu + |u_t|, u_t), which is u + mu
// |u_t| n scaled likewise, it reads x in L, y in L, x perpendicular to y, for the Lorentz cone L. But for the term
// |u_t| this is a convex second-order cone program with W = H H^T.
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
//     tried on the way: the last digits are its.
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
#include "static_contact/body_system.hpp"
#include "static_contact/lorentz_cone.hpp"

namespace flotilla {

struct ConeScratch::Storage {
    ConeProgram program; ///< of the bodies
    BodySystem system;
    std::vector<ConeDiagonal> w;
    std::vector<ConeMotion> motion;
    std::vector<Vec3> best;               ///< N s: the best impulses so far
    std::vector<Vec3> rigid;              ///< N s: those of contacts that do not yield
    std::vector<Vec3> r, u, c, du;        ///< present impulses and velocities, and the step dr = c - B du
    std::vector<Mat3> b;                  ///< B of body_system.hpp
    std::vector<Vec3> x, y, infeasible;   ///< iterate of the interior point; y(u) - y
    std::vector<Vec3> dx, dy, dx_0, dy_0; ///< its direction, and the path's tangent
    std::vector<NesterovTodd> scaling;

    void resize(std::size_t n) {
        for (auto* const v : {&r, &u, &c, &du, &x, &y, &infeasible, &dx, &dy, &dx_0, &dy_0}) v->assign(n, {});
        b.assign(n, {});
        scaling.assign(n, {});
    }
};

ConeScratch::ConeScratch() : storage_(std::make_unique<Storage>()) {}
ConeScratch::~ConeScratch() = default;
ConeScratch::ConeScratch(ConeScratch&&) noexcept = default;
ConeScratch& ConeScratch::operator=(ConeScratch&&) noexcept = default;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon(); // of velocities, as a share of W |r|

// In x and y a friction mu stretches the normal direction by 1/mu. Below this the contact is solved without friction,
// and what it lacks, mu r_n, is left to the Newton steps, for which any mu is the same.
constexpr double kLeastConeFriction = 1e-6;

// Share of W_ii by which a closed contact yields to its impulse within one Newton step. It keeps redundant contacts
// solvable, and as the next steps correct r it leaves no error. Larger values make the load of a heavy body on a column
// of light ones converge slowly (1e-9: not to 1e-6 for a mass ratio of 1e9), smaller ones drown free motions in
// rounding.
constexpr double kCompliance = 1e-11;

constexpr int kFirstNewtonSteps = 6, kNewtonSteps = 6;
constexpr int kNewtonPatience = 3; // steps without gain

constexpr double kFirstHandOver = 1e-4; // of the largest velocity: residual at which method 2 first tries method 1
constexpr double kNextHandOver = 0.3;   // of the residual at the try before
constexpr double kHandOverGain = 10; // by which each of its steps then divides the residual: most tries cost one step

constexpr double kStayInside = 0.99; // share of the way to the cone's edge
constexpr double kShortStep = 0.3;   // steps shorter than this leave the way down for the path
constexpr double kAhead = 0.5;       // share of the way to the cone's edge that a step along the path takes
constexpr int kStall = 20;           // iterations without progress after which method 2 is given up

// A residual, as a share of the largest velocity, that methods 2 and 3 get below only by chance. Where a contact
// neither carries nor parts, its impulse and its velocity both are as the square root of their product, and the
// products end at the rounding, 2^-52. Many bodies at rest hold such contacts, and with the impulses of the step before
// are nearer to the solution than that.
constexpr double kInteriorFloor = 0x1p-26;
// Floors: problems of stacks and walls at rest end between half of one and three. Who asks there for less than four is
// given what Newton's steps reach within them.
constexpr double kOutOfReach = 4;

constexpr int kRounds = 10, kSweepsPerRound = 400;
// Between closing walls no impulses meet the law: a residual above this share of the largest velocity, of which a round
// leaves more than that other, is not worth another one.
constexpr double kHopeless = 0.1, kRoundGains = 0.8;
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

Vec3 cut_to_cone(const Vec3& r, double friction) {
    if (!(r.x > 0)) return {};
    const double bound = friction * r.x, size = tangential_length(r);
    // What was cut before stays as it is.
    return size > (1 + kRounding) * bound ? Vec3{r.x, bound / size * r.y, bound / size * r.z} : r;
}

// (I + B E)^-1 B
Mat3 softened(const Mat3& b, const Vec3& compliance) {
    return transpose(inverse_of_transpose(identity() + b * diagonal(compliance))) * b;
}

class Solver {
  public:
    Solver(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts, const ConeProgram& program,
           const ConeSolveOptions& options, ConeScratch::Storage& storage)
        : bodies_(bodies),
          contacts_(contacts),
          p_(program),
          options_(options),
          s_(storage),
          most_iterations_(options.max_iterations) {}

    ConeSolveStats run(std::span<Vec3> impulses);

  private:
    std::size_t size() const { return p_.contacts.size(); }
    double friction(std::size_t i) const { return p_.contacts[i].friction; }
    bool movable(std::size_t i) const { return s_.w[i].normal > 0; }
    bool has_friction(std::size_t i) const { return friction(i) > 0 && s_.w[i].tangential > 0; }
    bool has_cone(std::size_t i) const { return friction(i) > kLeastConeFriction && s_.w[i].tangential > 0; }
    Vec3 yields(std::size_t i, const Vec3& r) const { // m/s
        if (!movable(i)) return {};
        return {compliance_ * r.x, slip_ * r.y, slip_ * r.z};
    }
    double limit() const { return std::max(options_.tolerance, stats_.rounding); }
    bool exhausted() const {
        const int iterations = stats_.iterations - before_;
        return iterations >= most_iterations_ ||
               (iterations >= options_.most_beyond && stats_.residual <= options_.enough);
    }
    bool done() const { return stats_.residual <= limit() || exhausted(); }

    bool finite_input() const;
    double largest_velocity() const;
    double least_diagonal() const;
    double consider(double as_good = 0);
    double not_worth_more() const;
    bool factorise();
    bool solve();

    bool newton(int max_steps, double gain);
    void linearise(std::size_t i);
    void linearise_sliding(std::size_t i, const Vec3& z, double size);

    void interior();
    void set_start();
    double measure();
    bool stalled();
    bool step();
    bool step_down();
    bool step_along(int sign);
    void advance(double length);
    void prepare_blocks();
    bool direction(double target, double share, bool second_order);
    double step_length() const;
    double product_after(double length) const;
    double scaled_dot(const std::vector<Vec3>& dx, const std::vector<Vec3>& dy) const;
    Vec3 impulse(std::size_t i, const Vec3& x) const;
    Mat3 velocity_map(std::size_t i) const;

    void sweep(int count);
    void find();
    bool pressed() const;
    bool loaded() const;
    bool yield(std::span<const Vec3> estimate, int most_iterations);
    void keep_rigid(const ConeSolveStats& rigid);
    bool yield_to_script(std::span<const Vec3> estimate);
    bool in_need() const {
        const bool more = stats_.residual > std::max(limit(), options_.enough);
        return more && options_.polish == 0 && std::isfinite(stats_.residual);
    }

    std::span<const ConeBody> bodies_;
    std::span<const ConeContact> contacts_;
    const ConeProgram& p_;
    ConeSolveOptions options_;
    ConeScratch::Storage& s_;
    ConeSolveStats stats_;

    double at_start_ = 0;   // m/s: residual of the estimate
    double rounding_ = 0;   // m/s: what rounding may do to the velocities of the present impulses
    double speed_ = 0;      // m/s: largest |q|
    double compliance_ = 0; // 1/kg: contacts yield so much to their normal impulses
    double slip_ = 0;       // 1/kg: and so much to friction
    int before_ = 0;        // factorisations of contacts that did not
    int most_iterations_;

    // of method 2
    double product_ = 0;       // J: sum of x . y
    double first_product_ = 0; // J: at the start
    double target_ = 0;        // J: the central path's for each contact
    double best_progress_ = 0; // smallest so far
    int without_progress_ = 0; // iterations
    int first_sign_ = 0;       // of the determinant where the path begins
};

bool Solver::finite_input() const {
    for (const ConeProgram::Contact& c : p_.contacts)
        if (!is_finite(c.q) || !std::isfinite(c.friction)) return false;
    for (const ConeProgram::Entry& e : p_.entries)
        if (!is_finite(e.h)) return false;
    for (const ConeDiagonal& w : s_.w) // a mass that is not finite has no entries, but shows here
        if (!std::isfinite(w.normal) || !std::isfinite(w.tangential)) return false;
    return true;
}

double Solver::largest_velocity() const {
    double largest = 0;
    for (std::size_t i = 0; i < size(); ++i)
        if (movable(i)) largest = std::max(largest, length(p_.contacts[i].q));
    return largest;
}

// 1/kg: of the contacts' normal directions, that of the heaviest bodies.
double Solver::least_diagonal() const {
    double least = kInfinity;
    for (std::size_t i = 0; i < size(); ++i)
        if (movable(i)) least = std::min(least, s_.w[i].normal);
    return least;
}

// Cuts r to the cones, sets u and returns the residual; keeps r where it is better, or the last that is no worse than
// `as_good` and than the rounding of the best.
double Solver::consider(double as_good) {
    for (std::size_t i = 0; i < size(); ++i)
        s_.r[i] = movable(i) ? cut_to_cone(s_.r[i], has_friction(i) ? friction(i) : 0) : Vec3{};
    if (bodies_.empty()) {
        s_.system.gather(s_.r);
        for (std::size_t i = 0; i < size(); ++i) s_.u[i] = p_.contacts[i].q + s_.system.spread(i);
    } else {
        cone_velocities(bodies_, contacts_, s_.r, s_.motion, s_.u);
    }
    double residual = 0, load = 0;
    for (std::size_t i = 0; i < size(); ++i) {
        s_.u[i] += yields(i, s_.r[i]);
        const double violation = cone_violation(s_.w[i], friction(i), s_.r[i], s_.u[i]);
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
double Solver::not_worth_more() const {
    const double floor = kInteriorFloor * speed_;
    const bool out_of_reach = options_.rests && options_.enough < kOutOfReach * floor;
    return out_of_reach ? kOutOfReach * floor : std::min(options_.enough, floor);
}

// Of a step dr = c - B du, where du is of the bodies and of what contacts yield, E dr: the same step is
// dr = M c - M B du of the bodies alone, with M = (I + B E)^-1 = I - (M B) E.
bool Solver::factorise() {
    ++stats_.iterations;
    if (compliance_ > 0)
        for (std::size_t i = 0; i < size(); ++i)
            if (s_.b[i].m[0] > 0) s_.b[i] = softened(s_.b[i], yields(i, {1, 1, 1}));
    return s_.system.factorise(s_.b);
}

bool Solver::solve() {
    if (compliance_ > 0)
        for (std::size_t i = 0; i < size(); ++i) s_.c[i] -= s_.b[i] * yields(i, s_.c[i]);
    return s_.system.solve(s_.c, s_.du);
}

// Method 1, from r. Full steps only: where they do not lead down at once they often do after some more, and the best of
// them is kept. Within rounding it goes on while it gains, and the last step counts: an error common to a whole column
// of bodies, far below the rounding of each of its contacts, is still an error of the column's load, which the residual
// does not show. A step that does not divide the residual by `gain` is the last. Returns whether it finished.
bool Solver::newton(int max_steps, double gain) {
    double best = consider();
    int without_gain = 0;
    for (int k = 0; k < max_steps && stats_.residual > options_.tolerance && !exhausted(); ++k) {
        for (std::size_t i = 0; i < size(); ++i) linearise(i);
        if (!factorise() || !solve()) break;
        for (std::size_t i = 0; i < size(); ++i) s_.r[i] += s_.c[i] - s_.b[i] * s_.du[i];
        const double residual = consider(at_start_);
        if (!std::isfinite(residual)) break;
        if (gain * residual > best) break;
        without_gain = residual < 0.9 * best ? 0 : without_gain + 1;
        if (without_gain > kNewtonPatience) break;
        best = std::min(best, residual);
    }
    return done();
}

// dr = c - B du of a contact in the state that the projections of the residual show: open (r = 0), sticking (u = 0) or
// sliding. u = 0 is relaxed to u + e W dr = 0.
void Solver::linearise(std::size_t i) {
    const Vec3 &r = s_.r[i], &u = s_.u[i];
    const ConeDiagonal& w = s_.w[i];
    s_.b[i] = {};
    s_.c[i] = -r;
    if (!movable(i) || !(r.x - u.x / w.normal > 0)) return;
    s_.b[i].m[0] = 1 / (kCompliance * w.normal);
    s_.c[i].x = -s_.b[i].m[0] * u.x;
    if (!has_friction(i)) return;
    const Vec3 z{0, r.y - u.y / w.tangential, r.z - u.z / w.tangential};
    const double size = tangential_length(z);
    if (size > friction(i) * r.x) {
        linearise_sliding(i, z, size);
        return;
    }
    const double stiffness = 1 / (kCompliance * w.tangential);
    s_.b[i].m[4] = s_.b[i].m[8] = stiffness;
    s_.c[i].y = -stiffness * u.y;
    s_.c[i].z = -stiffness * u.z;
}

// r_t = mu r_n d, d = z/|z|, z = r_t - u_t / W_t. With k = mu r_n / |z| < 1 and P = I - d d^T its linearisation is
//     (I - k P) dr_t = mu r_n d - r_t + mu d dr_n - k P du_t / W_t,   (I - k P)^-1 = d d^T + P / (1 - k).
void Solver::linearise_sliding(std::size_t i, const Vec3& z, double size) {
    const double mu = friction(i), bound = mu * s_.r[i].x, k = bound / size;
    const double inverse = 1 / std::max(1 - k, kCompliance);
    const double d1 = z.y / size, d2 = z.z / size;
    const double g1 = bound * d1 - s_.r[i].y, g2 = bound * d2 - s_.r[i].z, along = g1 * d1 + g2 * d2;
    Vec3& c = s_.c[i];
    c.y = along * d1 + inverse * (g1 - along * d1) + mu * d1 * c.x;
    c.z = along * d2 + inverse * (g2 - along * d2) + mu * d2 * c.x;
    const double f = k * inverse / s_.w[i].tangential;
    Mat3& b = s_.b[i];
    b.m[3] = mu * d1 * b.m[0];
    b.m[6] = mu * d2 * b.m[0];
    b.m[4] = f * (d2 * d2);
    b.m[5] = b.m[7] = -f * (d1 * d2);
    b.m[8] = f * (d1 * d1);
}

// r of x. Contacts without cone have no friction here.
Vec3 Solver::impulse(std::size_t i, const Vec3& x) const {
    return has_cone(i) ? Vec3{x.x / friction(i), x.y, x.z} : Vec3{x.x, 0, 0};
}

// T = dy/du, with the derivative of |u_t|.
Mat3 Solver::velocity_map(std::size_t i) const {
    if (!has_cone(i)) return {{1, 0, 0, 0, 0, 0, 0, 0, 0}};
    Mat3 t = diagonal({1 / friction(i), 1, 1});
    const double slip = tangential_length(s_.u[i]);
    if (slip > 0) {
        t.m[1] = s_.u[i].y / slip;
        t.m[2] = s_.u[i].z / slip;
    }
    return t;
}

// Both x and y on the cone's axis; each contact alone stops the largest velocity. Nearer to what the sweeps found the
// path is worse, and with targets that know the masses, stacks whose bodies differ by 1e9 are.
void Solver::set_start() {
    for (std::size_t i = 0; i < size(); ++i) {
        if (!movable(i)) continue;
        const double mu = has_cone(i) ? friction(i) : 1;
        s_.x[i] = {mu * speed_ / std::max(s_.w[i].normal, s_.w[i].tangential), 0, 0};
        s_.y[i] = {std::max(1.0, 1 / mu) * speed_, 0, 0};
    }
    first_product_ = product_after(0);
    best_progress_ = kInfinity;
    without_progress_ = 0;
    first_sign_ = 0;
}

// Method 2.
void Solver::interior() {
    set_start();
    double hand_over = kFirstHandOver * speed_;
    while (!done()) {
        const double residual = measure();
        if (!std::isfinite(residual) || done()) return;
        if (residual < hand_over) {
            hand_over = kNextHandOver * residual;
            if (newton(kNewtonSteps, kHandOverGain)) return;
            measure();
        }
        if (stalled() || !step()) return;
    }
}

// Sets r, u and the infeasibility from x and y; returns the residual.
double Solver::measure() {
    for (std::size_t i = 0; i < size(); ++i) s_.r[i] = impulse(i, s_.x[i]);
    const double residual = consider();
    for (std::size_t i = 0; i < size(); ++i) {
        const Vec3& u = s_.u[i];
        const Vec3 y = has_cone(i) ? Vec3{u.x / friction(i) + tangential_length(u), u.y, u.z} : Vec3{u.x, 0, 0};
        s_.infeasible[i] = y - s_.y[i];
    }
    product_ = product_after(0);
    target_ = product_ / static_cast<double>(size());
    return residual;
}

// Impulses that grow until their rounding is more than the best residual answer a problem without solution.
bool Solver::stalled() {
    if (rounding_ > stats_.residual) return true;
    double infeasible = 0;
    for (std::size_t i = 0; i < size(); ++i)
        if (movable(i)) infeasible = std::max(infeasible, length(s_.infeasible[i]));
    const double progress = infeasible / speed_ + product_ / first_product_;
    if (progress < 0.7 * best_progress_) {
        best_progress_ = progress;
        without_progress_ = 0;
        return false;
    }
    return ++without_progress_ > kStall;
}

// The tangent of the path through the present point: it takes products and infeasibility to zero together.
bool Solver::step() {
    prepare_blocks();
    if (!factorise() || !direction(0, 1, false)) return false;
    if (first_sign_ == 0) first_sign_ = s_.system.determinant_sign();
    const int sign = first_sign_ * s_.system.determinant_sign();
    return (sign > 0 && step_down()) || step_along(sign);
}

// One predictor and corrector. |u_t| is not convex, and the corrector's second order can point out of the cone at once:
// a short step is tried again without it. False where that is short as well.
bool Solver::step_down() {
    const double reached = product_after(std::min(1.0, step_length())) / product_;
    const double centring = std::clamp(reached * reached * reached, 1e-6, 1.0);
    s_.dx_0 = s_.dx;
    s_.dy_0 = s_.dy;
    for (const bool second_order : {true, false}) {
        const double target = second_order ? centring : std::max(centring, 0.5);
        if (!direction(target, 1 - target, second_order)) return false;
        const double length = std::min(1.0, kStayInside * step_length());
        if (!(length > kShortStep)) continue;
        advance(length);
        return true;
    }
    s_.dx = s_.dx_0;
    s_.dy = s_.dy_0;
    return false;
}

// Along the tangent, towards smaller products or, behind a fold, larger ones; and towards the path, at right angles to
// the tangent: near a fold the Newton step to given products is nearly the tangent and has no bound.
bool Solver::step_along(int sign) {
    s_.dx_0.swap(s_.dx);
    s_.dy_0.swap(s_.dy);
    if (!direction(1, 0, false)) return false;
    const double share = scaled_dot(s_.dx, s_.dy) / scaled_dot(s_.dx_0, s_.dy_0);
    for (std::size_t i = 0; i < size(); ++i) {
        s_.dx[i] -= share * s_.dx_0[i];
        s_.dy[i] -= share * s_.dy_0[i];
    }
    const double to_path = std::min(1.0, kStayInside * step_length());
    s_.dx_0.swap(s_.dx);
    s_.dy_0.swap(s_.dy);
    for (auto* const d : {&s_.dx, &s_.dy})
        for (Vec3& v : *d) v = sign * v;
    const double ahead = std::min(1.0, kAhead * step_length());
    for (std::size_t i = 0; i < size(); ++i) {
        s_.dx[i] = ahead * s_.dx[i] + to_path * s_.dx_0[i];
        s_.dy[i] = ahead * s_.dy[i] + to_path * s_.dy_0[i];
    }
    const double length = std::min(1.0, kStayInside * step_length());
    advance(length);
    return length > 0;
}

void Solver::advance(double length) {
    for (std::size_t i = 0; i < size(); ++i) {
        if (!movable(i)) continue;
        s_.x[i] += length * s_.dx[i];
        s_.y[i] += length * s_.dy[i];
    }
}

// r = S x with S = diag(1/mu, 1, 1), and W^2 dx + dy = W d (the caller's d), dy = T du + infeasibility, so that
//     dr = S (W^-1 d - W^-2 infeasibility) - S W^-2 T du.
void Solver::prepare_blocks() {
    for (std::size_t i = 0; i < size(); ++i) {
        s_.b[i] = {};
        if (!movable(i)) continue;
        s_.scaling[i] = NesterovTodd::of(s_.x[i], s_.y[i]);
        const Mat3 product = s_.scaling[i].inverse_square() * velocity_map(i);
        s_.b[i] = has_cone(i) ? diagonal({1 / friction(i), 1, 1}) * product : diagonal({product.m[0], 0, 0});
    }
}

// The direction that takes x o y to the given share of the present product, in scaled form
//     l o d = target e - l o l - (W^-1 dy_0) o (W dx_0),   l = W x = W^-1 y,
// and removes `share` of the infeasibility. Without second order its last term is left out. Sets dx and dy.
bool Solver::direction(double target, double share, bool second_order) {
    for (std::size_t i = 0; i < size(); ++i) {
        s_.c[i] = {};
        if (!movable(i)) continue;
        const NesterovTodd& w = s_.scaling[i];
        const Vec3 l = w.apply(s_.x[i]);
        Vec3 right = Vec3{target * target_, 0, 0} - jordan_product(l, l);
        if (second_order) right = right - jordan_product(w.apply_inverse(s_.dy_0[i]), w.apply(s_.dx_0[i]));
        s_.dx[i] = w.apply_inverse(jordan_quotient(right, l)) - w.inverse_square() * (share * s_.infeasible[i]);
        s_.c[i] = impulse(i, s_.dx[i]);
    }
    if (!solve()) return false;
    for (std::size_t i = 0; i < size(); ++i) {
        if (!movable(i)) continue;
        const Vec3 dy = velocity_map(i) * (s_.du[i] + yields(i, s_.c[i] - s_.b[i] * s_.du[i]));
        s_.dx[i] -= s_.scaling[i].inverse_square() * dy;
        s_.dy[i] = dy + share * s_.infeasible[i];
    }
    return true;
}

// To the edge of the nearest cone; 0 where it is no number.
double Solver::step_length() const {
    double length = kInfinity;
    for (std::size_t i = 0; i < size(); ++i) {
        if (!movable(i)) continue;
        for (const double edge : {step_to_edge(s_.x[i], s_.dx[i]), step_to_edge(s_.y[i], s_.dy[i])}) {
            if (std::isnan(edge)) return 0;
            length = std::min(length, edge);
        }
    }
    return length;
}

double Solver::product_after(double length) const {
    double product = 0;
    for (std::size_t i = 0; i < size(); ++i)
        if (movable(i)) product += dot(s_.x[i] + length * s_.dx[i], s_.y[i] + length * s_.dy[i]);
    return product;
}

// Of the direction with dx_0 and dy_0, in the metric in which the cone's edge is as far as the products are large.
double Solver::scaled_dot(const std::vector<Vec3>& dx, const std::vector<Vec3>& dy) const {
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i) {
        if (!movable(i)) continue;
        const NesterovTodd& w = s_.scaling[i];
        sum += dot(w.apply(dx[i]), w.apply(s_.dx_0[i])) + dot(w.apply_inverse(dy[i]), w.apply_inverse(s_.dy_0[i]));
    }
    return sum;
}

// Method 3: visits as in local_contact.hpp, from r.
void Solver::sweep(int count) {
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
                r = cut_to_cone({r.x, r.y - u.y / tangential, r.z - u.z / tangential}, friction(i));
                u = u_before + s_.b[i] * (r - before);
            }
            s_.r[i] = r;
            s_.system.add(i, r - before);
        }
}

// The three methods, from the best impulses.
void Solver::find() {
    s_.r = s_.best;
    newton(kFirstNewtonSteps, options_.polish);
    const double near = not_worth_more();
    const auto far = [&] { return options_.polish == 0 && !done() && stats_.residual > near; };
    if (far()) {
        interior();
        s_.r = s_.best;
        newton(options_.max_iterations, 0); // loads of a heavy body on light ones end slowly, but they end
    }
    // What moves meets another problem in the next step.
    const auto goes_on = [&] { return far() && (options_.rests || stats_.residual > options_.enough); };
    for (int round = 0; round < kRounds && goes_on(); ++round) {
        const double before = stats_.residual;
        s_.r = s_.best;
        sweep(kSweepsPerRound);
        newton(kNewtonSteps, 0);
        if (stats_.residual > std::max(kHopeless * speed_, kRoundGains * before)) break;
    }
}

bool Solver::pressed() const {
    return std::ranges::any_of(p_.contacts, [](const ConeProgram::Contact& c) { return c.pressed; });
}

// Whether contacts of scripts have the load of those that yield: more than where nothing contradicts them.
bool Solver::loaded() const {
    const double load = kYielded * kMostLoad * speed_ / least_diagonal();
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i)
        if (p_.contacts[i].pressed) sum += s_.best[i].x;
    return sum > load;
}

// The methods where contacts yield, by so much that impulses which answer what is left stop the heaviest body at the
// largest velocity many times over. Keeps the result where that is nearly solved; whether it is.
bool Solver::yield(std::span<const Vec3> estimate, int most_iterations) {
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

void Solver::keep_rigid(const ConeSolveStats& rigid) {
    stats_.residual = rigid.residual;
    stats_.rounding = rigid.rounding;
    stats_.yielded = false;
    s_.best = s_.rigid;
}

// What a script presses on mostly has no solution: contacts yield at once, and what rests and is not found so within
// some factorisations either is left. Returns whether that is all.
bool Solver::yield_to_script(std::span<const Vec3> estimate) {
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

ConeSolveStats Solver::run(std::span<Vec3> impulses) {
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
            if (contradicts && in_need()) yield(impulses, options_.max_iterations);
        }
    }
    stats_.solved = stats_.residual <= limit();
    std::copy(s_.best.begin(), s_.best.end(), impulses.begin());
    return stats_;
}

} // namespace

ConeSolveStats solve_cone_program(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                                  const ConeSolveOptions& options, std::span<Vec3> impulses, ConeScratch& scratch) {
    ConeScratch::Storage& s = scratch.storage();
    build_cone_program(bodies, contacts, s.program, s.w);
    return Solver(bodies, contacts, s.program, options, s).run(impulses);
}

ConeSolveStats solve_cone_program(const ConeProgram& program, const ConeSolveOptions& options, std::span<Vec3> impulses,
                                  ConeScratch& scratch) {
    ConeScratch::Storage& s = scratch.storage();
    set_diagonals(program, s.w);
    return Solver({}, {}, program, options, s).run(impulses);
}

} // namespace flotilla
