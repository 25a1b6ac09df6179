// SPDX-License-Identifier: MIT
// Method 2 of interior_point.cpp.
#include <algorithm>
#include <cmath>

#include "static_contact/cone_solver.hpp"

namespace flotilla {
namespace {

constexpr int kNewtonSteps = 6; // at a hand-over

constexpr double kFirstHandOver = 1e-4; // of the largest velocity: residual at which method 2 first tries method 1
constexpr double kNextHandOver = 0.3;   // of the residual at the try before
constexpr double kHandOverGain = 10; // by which each of its steps then divides the residual: most tries cost one step

constexpr double kStayInside = 0.99; // share of the way to the cone's edge
constexpr double kShortStep = 0.3;   // steps shorter than this leave the way down for the path
constexpr double kAhead = 0.5;       // share of the way to the cone's edge that a step along the path takes
constexpr int kStall = 20;           // iterations without progress after which method 2 is given up

} // namespace

// r of x. Contacts without cone have no friction here.
Vec3 ConeSolver::impulse(std::size_t i, const Vec3& x) const {
    return has_cone(i) ? Vec3{x.x / friction(i), x.y, x.z} : Vec3{x.x, 0, 0};
}

// T = dy/du, with the derivative of |u_t|.
Mat3 ConeSolver::velocity_map(std::size_t i) const {
    if (!has_cone(i)) return {{1, 0, 0, 0, 0, 0, 0, 0, 0}};
    Mat3 t = diagonal({1 / friction(i), 1, 1});
    const double slip = tangential_length(s_.u[i]);
    if (slip > 0) {
        t.m[1] = s_.u[i].y / slip;
        t.m[2] = s_.u[i].z / slip;
    }
    return t;
}

// 1/kg, of the heaviest body, or where bodies are not known of what contacts show of it.
double ConeSolver::least_inv_mass() const {
    double least = kInfinity;
    for (const ConeBody& body : bodies_)
        if (body.inv_mass > 0) least = std::min(least, body.inv_mass);
    return std::isfinite(least) ? least : least_diagonal();
}

// Both x and y on the cone's axis; each contact alone stops the largest velocity, or that of a body of `inv_mass` where
// that is given. Nearer to what the sweeps found the path is worse, and with targets that know the masses, stacks whose
// bodies differ by 1e9 are.
void ConeSolver::set_start(double inv_mass) {
    for (std::size_t i = 0; i < size(); ++i) {
        if (!movable(i)) continue;
        const double mu = has_cone(i) ? friction(i) : 1;
        const double mass = inv_mass > 0 ? inv_mass : std::max(s_.w[i].normal, s_.w[i].tangential);
        s_.x[i] = {mu * speed_ / mass, 0, 0};
        s_.y[i] = {std::max(1.0, 1 / mu) * speed_, 0, 0};
    }
    first_product_ = product_after(0);
    best_progress_ = kInfinity;
    without_progress_ = 0;
    first_sign_ = 0;
}

// Method 2.
void ConeSolver::interior(double inv_mass) {
    set_start(inv_mass);
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
double ConeSolver::measure() {
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
bool ConeSolver::stalled() {
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
bool ConeSolver::step() {
    prepare_blocks();
    if (!factorise() || !direction(0, 1, false)) return false;
    if (first_sign_ == 0) first_sign_ = s_.system.determinant_sign();
    const int sign = first_sign_ * s_.system.determinant_sign();
    return (sign > 0 && step_down()) || step_along(sign);
}

// One predictor and corrector. |u_t| is not convex, and the corrector's second order can point out of the cone at once:
// a short step is tried again without it. False where that is short as well.
bool ConeSolver::step_down() {
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
bool ConeSolver::step_along(int sign) {
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

void ConeSolver::advance(double length) {
    for (std::size_t i = 0; i < size(); ++i) {
        if (!movable(i)) continue;
        s_.x[i] += length * s_.dx[i];
        s_.y[i] += length * s_.dy[i];
    }
}

// r = S x with S = diag(1/mu, 1, 1), and W^2 dx + dy = W d (the caller's d), dy = T du + infeasibility, so that
//     dr = S (W^-1 d - W^-2 infeasibility) - S W^-2 T du.
void ConeSolver::prepare_blocks() {
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
bool ConeSolver::direction(double target, double share, bool second_order) {
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
double ConeSolver::step_length() const {
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

double ConeSolver::product_after(double length) const {
    double product = 0;
    for (std::size_t i = 0; i < size(); ++i)
        if (movable(i)) product += dot(s_.x[i] + length * s_.dx[i], s_.y[i] + length * s_.dy[i]);
    return product;
}

// Of the direction with dx_0 and dy_0, in the metric in which the cone's edge is as far as the products are large.
double ConeSolver::scaled_dot(const std::vector<Vec3>& dx, const std::vector<Vec3>& dy) const {
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i) {
        if (!movable(i)) continue;
        const NesterovTodd& w = s_.scaling[i];
        sum += dot(w.apply(dx[i]), w.apply(s_.dx_0[i])) + dot(w.apply_inverse(dy[i]), w.apply_inverse(s_.dy_0[i]));
    }
    return sum;
}

} // namespace flotilla
