// SPDX-License-Identifier: MIT
#include "support/ccd_generator.hpp"

#include <cmath>
#include <limits>

namespace flotilla::test {
namespace {

using Corners = std::array<Vec3, 4>;

/// Counter-based generator (splitmix64): its stream is a function of the key alone. Below no unsequenced expression
/// draws twice, so that every compiler makes the same queries.
class Random {
  public:
    explicit Random(std::uint64_t key) : state_(key) {}

    std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31);
    }
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; } // [0, 1)
    double symmetric() { return 2 * unit() - 1; }
    int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }
    int between(int low, int high) { return low + below(high - low + 1); }
    bool chance(double p) { return unit() < p; }
    double magnitude(double low, double high) { return low * std::exp2(unit() * std::log2(high / low)); }
    double signed_magnitude(double low, double high) {
        const double m = magnitude(low, high);
        return symmetric() * m;
    }
    Vec3 point() { return {symmetric(), symmetric(), symmetric()}; }
    Vec3 point_of_size(double low, double high) {
        const double m = magnitude(low, high);
        return m * point();
    }
    Vec3 integer_point(int n) {
        return {static_cast<double>(between(-n, n)), static_cast<double>(between(-n, n)),
                static_cast<double>(between(-n, n))};
    }
    /// A barycentric share: often exactly an end, a half or a quarter.
    double share() { return chance(0.5) ? unit() : 0.25 * between(0, 4); }

  private:
    std::uint64_t state_;
};

Vec3 mix(const Vec3& a, const Vec3& b, double s) { return (1 - s) * a + s * b; }
double next_to(double x, int steps) {
    const double toward =
        steps > 0 ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
    for (int i = 0; i < std::abs(steps); ++i) x = std::nextafter(x, toward);
    return x;
}

/// Permutes and mirrors the axes: exact, so that no axis of a construction is special.
CcdQuery turned(CcdQuery q, Random& r) {
    const int turn = r.below(3), mirror = r.below(8);
    for (Corners* x : {&q.x0, &q.x1})
        for (Vec3& p : *x) {
            const std::array<double, 3> c{mirror & 1 ? -p.x : p.x, mirror & 2 ? -p.y : p.y, mirror & 4 ? -p.z : p.z};
            const auto t = static_cast<std::size_t>(turn);
            p = {c[t], c[(t + 1) % 3], c[(t + 2) % 3]};
        }
    return q;
}

/// Features that share a point up to rounding. Relations of length `reach` between their corners are kept by the
/// caller.
Corners meeting(CcdKind kind, const Vec3& p, const Vec3& q, const Vec3& s, Random& r) {
    if (kind == CcdKind::vertex_face) {
        const double u = r.share(), v = r.share();
        return {mix(p, mix(q, s, v), u), p, q, s};
    }
    // Edge p q; the other goes from s through a point of it, or ends there.
    const Vec3 on = mix(p, q, r.share());
    return {p, q, s, r.chance(0.25) ? on : on + r.unit() * (on - s)};
}

Corners meeting(CcdKind kind, Random& r) {
    const Vec3 p = r.point(), q = r.point(), s = r.point();
    return meeting(kind, p, q, s, r);
}

/// The motion with velocities v (per step) that passes through x at time t.
CcdQuery passing(const Corners& x, const Corners& v, double t) {
    CcdQuery q;
    for (std::size_t i = 0; i < 4; ++i) {
        q.x0[i] = x[i] - t * v[i];
        q.x1[i] = x[i] + (1 - t) * v[i];
    }
    return q;
}

std::size_t first_size(CcdKind kind) { return kind == CcdKind::vertex_face ? 1 : 2; }

Corners shifted_first(Corners x, CcdKind kind, const Vec3& d) {
    for (std::size_t i = 0; i < first_size(kind); ++i) x[i] += d;
    return x;
}

Vec3 miss_by(Random& r) {
    const double miss = r.chance(0.5) ? 0.0 : r.signed_magnitude(1e-16, 1e-1);
    return miss * r.point();
}

CcdQuery uniform_query(CcdKind, Random& r) {
    CcdQuery q;
    for (Corners* x : {&q.x0, &q.x1})
        for (Vec3& p : *x) p = r.point();
    return q;
}

CcdQuery aimed_query(CcdKind kind, Random& r) {
    const Corners x = meeting(kind, r);
    const Corners v{r.point(), r.point(), r.point(), r.point()};
    const Corners missing = shifted_first(x, kind, miss_by(r));
    return passing(missing, v, r.unit());
}

CcdQuery resting_query(CcdKind kind, Random& r) {
    const Corners x = meeting(kind, r);
    const Vec3 common = 10 * r.point(), slow = r.point_of_size(1e-6, 1e-2);
    const Corners v = shifted_first({common, common, common, common}, kind, slow);
    const Corners apart = shifted_first(x, kind, r.point_of_size(1e-6, 1e-1));
    return passing(apart, v, r.unit());
}

CcdQuery sliver_query(CcdKind kind, Random& r) {
    const double width = r.magnitude(1e-17, 1e-1);
    const Vec3 p = r.point(), q = r.point();
    Corners x;
    if (kind == CcdKind::vertex_face) {
        const Vec3 on_line = mix(p, q, 3 * r.symmetric());
        x = meeting(kind, p, q, on_line + width * r.point(), r);
    } else {
        const Vec3 on = mix(p, q, r.share()), parallel = r.symmetric() * (q - p), along = parallel + width * r.point();
        x = {p, q, on - r.share() * along, on + r.share() * along};
    }
    const Vec3 common = r.point();
    const double spread = r.chance(0.5) ? 0 : 1;
    const Corners v{r.point(), common + spread * r.point(), common + spread * r.point(), common + spread * r.point()};
    const Corners missing = shifted_first(x, kind, miss_by(r));
    return passing(missing, v, r.unit());
}

/// Coordinates are multiples of 1/8, so that collinear stays collinear.
CcdQuery degenerate_query(CcdKind kind, Random& r) {
    const auto grid = [&] { return 0.125 * r.integer_point(8); };
    const auto collapse = [&](Corners& x) {
        const std::size_t first = kind == CcdKind::vertex_face ? 1 : 2;
        switch (r.below(4)) {
        case 0: x[3] = x[2]; break;
        case 1: x[first] = x[3] = x[2]; break;
        case 2: x[first] = 2 * x[2] - x[3]; break; // VF: collinear corners
        default:
            x[1] = x[first]; // EE: the first edge ends where the second starts
            x[3] = x[2];
        }
    };
    CcdQuery q{{grid(), grid(), grid(), grid()}, {grid(), grid(), grid(), grid()}};
    if (r.chance(0.7)) {
        // Exactly meeting at t = 1/2: both ends are half a step away.
        const Vec3 v = grid();
        Corners x{grid(), grid(), grid(), grid()};
        collapse(x);
        const Vec3 move = x[3] - x[0];
        for (std::size_t i = 0; i < first_size(kind); ++i) x[i] += move;
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3 w = i < first_size(kind) ? v : Vec3{};
            q.x0[i] = x[i] - w;
            q.x1[i] = x[i] + w;
        }
        if (r.chance(0.3)) q.x1[0].x = next_to(q.x1[0].x, r.between(-1, 1));
        return q;
    }
    collapse(q.x0);
    if (r.chance(0.7)) collapse(q.x1);
    return q;
}

CcdQuery coplanar_query(CcdKind kind, Random& r) {
    // Small multiples keep tilted planes exact: z = i x + j y.
    const int i = r.chance(0.5) ? 0 : r.between(-3, 3), j = r.chance(0.5) ? 0 : r.between(-3, 3);
    const bool coarse = r.chance(0.5);
    const auto in_plane = [&] {
        const double x = coarse ? r.between(-8, 8) : std::ldexp(std::round(std::ldexp(r.symmetric(), 30)), -27);
        const double y = coarse ? r.between(-8, 8) : std::ldexp(std::round(std::ldexp(r.symmetric(), 30)), -27);
        return Vec3{x, y, i * x + j * y};
    };
    CcdQuery q{{in_plane(), in_plane(), in_plane(), in_plane()}, {in_plane(), in_plane(), in_plane(), in_plane()}};
    if (r.chance(0.5)) // the second feature only translates or stands still
        for (std::size_t k = first_size(kind); k < 4; ++k) q.x1[k] = q.x0[k];
    return turned(q, r);
}

CcdQuery parallel_query(CcdKind kind, Random& r) {
    const Vec3 p = r.integer_point(4), along = r.integer_point(3), offset = r.chance(0.4) ? Vec3{} : r.integer_point(3);
    const Vec3 drift = r.chance(0.5) ? r.chance(0.5) ? along : -along : r.integer_point(3);
    const double start = 0.25 * r.between(-8, 8), extent = 0.25 * r.between(0, 8);
    Corners x;
    if (kind == CcdKind::vertex_face)
        x = {p + start * along + offset, p, p + along, p + r.integer_point(3)};
    else
        x = {p + start * along + offset, p + (start + extent) * along + offset, p, p + along};
    const Corners v = shifted_first({}, kind, r.chance(0.5) ? drift : drift - offset);
    CcdQuery q = passing(x, v, r.chance(0.5) ? 0 : 0.5);
    if (r.chance(0.25)) q.x1[0].y = next_to(q.x1[0].y, r.between(-2, 2));
    return q;
}

CcdQuery one_ulp_query(CcdKind kind, Random& r) {
    const double height = r.chance(0.5) ? r.symmetric() : r.signed_magnitude(1, 1e6);
    const double start = height + r.magnitude(1e-6, 10), end = next_to(height, r.between(-1, 1));
    const double lift = r.chance(0.5) ? 0 : r.symmetric(); // of the far corner: tilted or level
    CcdQuery q;
    if (kind == CcdKind::vertex_face) {
        // The foot (1/4, 1/4) is inside; the corner f2 carries the tilt, and a level corner the foot on an edge.
        const Vec3 f0{0, 0, height}, f1{1, 0, height}, f2{0, 1, height + lift};
        const Vec3 foot{0.25, lift == 0 ? 0.25 : 0, 0};
        q = {{Vec3{foot.x, foot.y, start}, f0, f1, f2}, {Vec3{foot.x, foot.y, end}, f0, f1, f2}};
    } else {
        const Vec3 b0{0, -1, height - lift}, b1{0, 1, height + lift};
        q = {{Vec3{-1, 0, start}, Vec3{1, 0, start}, b0, b1}, {Vec3{-1, 0, end}, Vec3{1, 0, end}, b0, b1}};
    }
    if (r.chance(0.3)) std::swap(q.x0, q.x1);
    return turned(q, r);
}

CcdQuery grazing_query(CcdKind kind, Random& r) {
    const double lift = r.chance(0.4) ? 0 : r.signed_magnitude(1e-16, 1e-3);
    CcdQuery q;
    if (kind == CcdKind::vertex_face) {
        // Signed volume (n t - 1)^2 + lift: the plane of the triangle tilts while the vertex falls.
        const double n = r.chance(0.5) ? r.between(2, 9) : r.magnitude(1.5, 10);
        const Vec3 o{}, x{1, 0, 0};
        q = {{Vec3{0.25, 0, 1 + lift}, o, x, {0, 1, 0}}, {Vec3{0.25, 1, 1 - 2 * n + lift}, o, x, {0, 1, -n * n}}};
    } else {
        // The end of one edge passes the line of the other as it comes through its plane.
        const double t = r.chance(0.5) ? 0.5 : r.unit(), slope = r.symmetric();
        const Vec3 end{r.symmetric(), lift, 0}, far_end{r.symmetric(), 1 + r.unit(), slope};
        const Vec3 v{0, 0, r.chance(0.5) ? 2.0 : -1 - r.unit()};
        q = passing({Vec3{-1, 0, 0}, Vec3{1, 0, 0}, end, far_end}, {Vec3{}, Vec3{}, v, v}, t);
    }
    return turned(q, r);
}

/// Meets exactly at the end `contact`; the other end is anywhere.
CcdQuery contact_at(CcdKind kind, Corners CcdQuery::*contact, Corners CcdQuery::*other, Random& r) {
    // Shares that are multiples of 1/4 of such numbers stay exact, on the fine grid without their normals being so.
    const int fineness = r.chance(0.5) ? 4 : 44;
    const auto coordinate = [&] { return std::ldexp(std::round(std::ldexp(r.symmetric(), fineness)), -fineness); };
    const auto grid = [&] { return Vec3{coordinate(), coordinate(), coordinate()}; };
    Corners x{grid(), grid(), grid(), grid()};
    const double s = 0.25 * r.between(0, 4), t = 0.25 * r.between(0, 4);
    if (kind == CcdKind::vertex_face) {
        x[0] = mix(x[1], mix(x[2], x[3], t), s);
    } else {
        const Vec3 move = mix(x[2], x[3], s) - mix(x[0], x[1], t);
        x[0] += move;
        x[1] += move;
    }
    CcdQuery q;
    q.*contact = x;
    if (r.chance(0.5)) {
        q.*other = shifted_first(x, kind, r.point_of_size(1e-3, 2));
    } else {
        for (std::size_t i = 0; i < 4; ++i) (q.*other)[i] = x[i] + r.point_of_size(1e-3, 2);
    }
    if (r.chance(0.3)) {
        // A miss, barely or by rounding: the first feature is moved away by little.
        const Vec3 d = r.point_of_size(1e-17, 1e-2);
        for (std::size_t i = 0; i < first_size(kind); ++i) (q.*contact)[i] += d;
    }
    return q;
}

CcdQuery fast_query(CcdKind kind, Random& r) {
    const double speed = r.magnitude(1e2, 1e8);
    const Corners x = meeting(kind, r);
    const Vec3 common = speed * r.point();
    Corners v = shifted_first({}, kind, common);
    if (r.chance(0.5))
        for (Vec3& each : v) {
            const double own = r.chance(0.5) ? speed : 1.0;
            each += own * r.point();
        }
    const Vec3 miss = r.chance(0.5) ? miss_by(r) : 2 * r.point();
    return passing(shifted_first(x, kind, miss), v, r.unit());
}

CcdQuery denormal_query(CcdKind, Random& r) {
    const double smallest = std::numeric_limits<double>::denorm_min();
    const double grain = std::ldexp(smallest, r.between(0, 60));
    const bool among_ordinary = r.chance(0.5);
    CcdQuery q;
    for (Corners* x : {&q.x0, &q.x1})
        for (Vec3& p : *x) {
            p = grain * r.integer_point(4);
            if (among_ordinary) {
                const Vec3 ordinary = r.integer_point(2);
                (r.below(2) == 0 ? p.x : p.y) += ordinary.x;
                if (r.chance(0.3)) p.z += ordinary.z;
            }
        }
    return turned(q, r);
}

CcdQuery lattice_query(CcdKind, Random& r) {
    const int n = r.between(1, 3);
    CcdQuery q;
    for (std::size_t i = 0; i < 4; ++i) {
        q.x0[i] = r.integer_point(n);
        q.x1[i] = r.chance(0.3) ? q.x0[i] : r.integer_point(n);
    }
    return q;
}

CcdQuery still_query(CcdKind kind, Random& r) {
    Corners x;
    if (r.chance(0.5)) {
        x = lattice_query(kind, r).x0;
    } else {
        x = meeting(kind, r);
        x = shifted_first(x, kind, miss_by(r));
    }
    return {x, x};
}

CcdQuery far_away_query(CcdKind kind, Random& r, std::uint64_t index) {
    const auto base = static_cast<QueryClass>(r.below(static_cast<int>(QueryClass::far_away)));
    CcdQuery q = make_query(base, index);
    const double distance = r.magnitude(1, 1e6);
    const Vec3 offset = distance * (kind == CcdKind::vertex_face ? r.point() : r.integer_point(1));
    for (Corners* x : {&q.x0, &q.x1})
        for (Vec3& p : *x) p += offset;
    return q;
}

} // namespace

CcdQuery make_query(QueryClass query_class, std::uint64_t index) {
    const CcdKind kind = kind_of(index);
    Random r((static_cast<std::uint64_t>(query_class) << 56) ^ (index * 0xd1342543de82ef95U));
    switch (query_class) {
    case QueryClass::uniform: return uniform_query(kind, r);
    case QueryClass::aimed: return aimed_query(kind, r);
    case QueryClass::resting: return resting_query(kind, r);
    case QueryClass::sliver: return sliver_query(kind, r);
    case QueryClass::degenerate: return degenerate_query(kind, r);
    case QueryClass::coplanar: return coplanar_query(kind, r);
    case QueryClass::parallel: return parallel_query(kind, r);
    case QueryClass::far_away: return far_away_query(kind, r, index);
    case QueryClass::one_ulp: return one_ulp_query(kind, r);
    case QueryClass::grazing: return grazing_query(kind, r);
    case QueryClass::at_start: return contact_at(kind, &CcdQuery::x0, &CcdQuery::x1, r);
    case QueryClass::at_end: return contact_at(kind, &CcdQuery::x1, &CcdQuery::x0, r);
    case QueryClass::fast: return fast_query(kind, r);
    case QueryClass::denormal: return denormal_query(kind, r);
    case QueryClass::lattice: return lattice_query(kind, r);
    case QueryClass::still: return still_query(kind, r);
    }
    return {};
}

} // namespace flotilla::test
