// SPDX-License-Identifier: MIT
// Method 1 of interior_point.cpp.
#include <algorithm>
#include <cmath>

#include "static_contact/cone_solver.hpp"

namespace flotilla {
namespace {

// Share of W_ii by which a closed contact yields to its impulse within one Newton step. It keeps redundant contacts
// solvable, and as the next steps correct r it leaves no error. Larger values make the load of a heavy body on a column
// of light ones converge slowly (1e-9: not to 1e-6 for a mass ratio of 1e9), smaller ones drown free motions in
// rounding.
constexpr double kCompliance = 1e-11;

constexpr int kNewtonPatience = 3; // steps without gain

} // namespace

// Method 1, from r. Full steps only: where they do not lead down at once they often do after some more, and the best of
// them is kept. Within rounding it goes on while it gains, and the last step counts: an error common to a whole column
// of bodies, far below the rounding of each of its contacts, is still an error of the column's load, which the residual
// does not show. A step that does not divide the residual by `gain` is the last. Returns whether it finished.
bool ConeSolver::newton(int max_steps, double gain) {
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
void ConeSolver::linearise(std::size_t i) {
    const Vec3 &r = s_.r[i], &u = s_.u[i];
    const ConeDiagonal& w = s_.w[i];
    s_.b[i] = {};
    s_.c[i] = -r;
    if (!movable(i)) return;
    const bool closed = r.x - u.x / w.normal > 0;
    if (!closed && given(i) == 0) return;
    if (closed) {
        s_.b[i].m[0] = 1 / (kCompliance * w.normal);
        s_.c[i].x = -s_.b[i].m[0] * u.x;
    }
    if (!has_friction(i)) return;
    const Vec3 z{0, r.y - u.y / w.tangential, r.z - u.z / w.tangential};
    const double size = tangential_length(z);
    if (size > friction(i) * r.x + given(i)) {
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
void ConeSolver::linearise_sliding(std::size_t i, const Vec3& z, double size) {
    const double mu = friction(i), bound = mu * s_.r[i].x + given(i), k = bound / size;
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

} // namespace flotilla
