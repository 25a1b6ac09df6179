// SPDX-License-Identifier: MIT
#include "audit/feature_sweep.hpp"

#include <algorithm>
#include <cmath>

namespace flotilla::audit {
namespace {

using Edge = std::array<Vec3, 2>;
using Differences = Corners; // of the four points of a pair of features

double determinant(const Vec3& x, const Vec3& y, const Vec3& z) { return dot(cross(x, y), z); }

/// See the header.
bool keeps_sign(const Differences& s, const Differences& e, const Slack& slack) {
    const std::array coefficients{
        determinant(s[0], s[1], s[2]),
        (determinant(e[0], s[1], s[2]) + determinant(s[0], e[1], s[2]) + determinant(s[0], s[1], e[2])) / 3,
        (determinant(s[0], e[1], e[2]) + determinant(e[0], s[1], e[2]) + determinant(e[0], e[1], s[2])) / 3,
        determinant(e[0], e[1], e[2])};
    std::array<double, 3> l{};
    for (std::size_t k = 0; k < 3; ++k) l[k] = 1.0001 * std::sqrt(std::max(length_sq(s[k]), length_sq(e[k])));
    // Both points may be of the body that strays farther; twice the rounding is more than its sqrt(3) over three
    // coordinates.
    const double eta = 2 * (slack.straying + slack.rounding);
    const double margin = eta * ((l[0] * l[1] + l[0] * l[2]) + l[1] * l[2]) + eta * eta * ((l[0] + l[1]) + l[2]) +
                          eta * eta * eta + 0x1p-47 * (l[0] * l[1] * l[2]);
    const auto [low, high] = std::minmax_element(coefficients.begin(), coefficients.end());
    return *low > 1.0001 * margin || *high < -1.0001 * margin;
}

bool vertex_and_face_apart(const Vec3& v_s, const Corners& f_s, const Vec3& v_m, const Corners& f_m, const Vec3& v_e,
                           const Corners& f_e, const Slack& slack) {
    const auto differences = [](const Vec3& v, const Corners& f) { return Differences{f[0] - v, f[1] - v, f[2] - v}; };
    if (keeps_sign(differences(v_s, f_s), differences(v_e, f_e), slack)) return true;
    const auto along = [&](const Vec3& d) {
        return separated(scaled(d), std::array{v_s}, f_s, std::array{v_e}, f_e, slack);
    };
    if (along(across(f_m[1] - f_m[0], f_m[2] - f_m[0]))) return true;
    for (std::size_t k = 0; k < 3; ++k) {
        const Edge edge{f_m[k], f_m[(k + 1) % 3]};
        const ClosestPoints closest = closest_points(Edge{v_m, v_m}, edge);
        const Vec3 d = closest.on_b - closest.on_a;
        if (along(d) || along(without(d, edge[1] - edge[0]))) return true;
    }
    return false;
}

bool edges_apart(const Edge& a_s, const Edge& b_s, const Edge& a_m, const Edge& b_m, const Edge& a_e, const Edge& b_e,
                 const Slack& slack) {
    const auto differences = [](const Edge& a, const Edge& b) {
        return Differences{a[1] - a[0], b[1] - b[0], b[0] - a[0]};
    };
    if (keeps_sign(differences(a_s, b_s), differences(a_e, b_e), slack)) return true;
    const auto along = [&](const Vec3& d) { return separated(scaled(d), a_s, b_s, a_e, b_e, slack); };
    const Vec3 u = a_m[1] - a_m[0], v = b_m[1] - b_m[0];
    const ClosestPoints closest = closest_points(a_m, b_m);
    const Vec3 d = closest.on_b - closest.on_a;
    return along(across(u, v)) || along(d) || along(without(d, u)) || along(without(d, v));
}

Edge edge_of(const Corners& c, std::size_t k) { return {c[k], c[(k + 1) % 3]}; }

} // namespace

FeaturePairs features_apart(FeaturePairs known, const Snapshot& s, const Snapshot& m, const Snapshot& e,
                            const Slack& slack) {
    unsigned apart = known, bit = 1;
    const auto prove = [&](auto&& proof) {
        if ((apart & bit) == 0 && proof()) apart |= bit;
        bit <<= 1;
    };
    for (std::size_t k = 0; k < 3; ++k) {
        prove([&] { return vertex_and_face_apart(s.a[k], s.b, m.a[k], m.b, e.a[k], e.b, slack); });
        prove([&] { return vertex_and_face_apart(s.b[k], s.a, m.b[k], m.a, e.b[k], e.a, slack); });
        for (std::size_t j = 0; j < 3; ++j)
            prove([&] {
                return edges_apart(edge_of(s.a, k), edge_of(s.b, j), edge_of(m.a, k), edge_of(m.b, j), edge_of(e.a, k),
                                   edge_of(e.b, j), slack);
            });
    }
    return static_cast<FeaturePairs>(apart);
}

} // namespace flotilla::audit
