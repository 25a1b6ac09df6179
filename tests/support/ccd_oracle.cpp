// SPDX-License-Identifier: MIT
#include "support/ccd_oracle.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <stdexcept>
#include <vector>

namespace flotilla::test {
namespace {

// ---------------------------------------------------------------------------------------------------------------------
// Polynomials with integer coefficients, degree at most 3.

struct Poly {
    std::array<mpz_class, 4> c; ///< power basis, lowest first
    int degree = -1;            ///< -1: zero

    void trim() {
        degree = 3;
        while (degree >= 0 && c[static_cast<std::size_t>(degree)] == 0) --degree;
    }
    [[nodiscard]] bool is_zero() const { return degree < 0; }
    [[nodiscard]] const mpz_class& lead() const { return c[static_cast<std::size_t>(degree)]; }
};

Poly derivative(const Poly& p) {
    Poly d;
    for (std::size_t i = 1; i < 4; ++i) d.c[i - 1] = p.c[i] * static_cast<unsigned>(i);
    d.trim();
    return d;
}

/// Divides by the gcd of the coefficients, which keeps the remainder sequence below short.
void make_primitive(Poly& p) {
    mpz_class g = 0;
    for (const mpz_class& c : p.c) g = gcd(g, c);
    if (g > 1)
        for (mpz_class& c : p.c) c /= g;
}

/// Quotient and remainder of lead(b)^(deg a - deg b + 1) * a by b.
struct PseudoDivision {
    Poly quotient, remainder;
};
PseudoDivision pseudo_divide(Poly a, const Poly& b) {
    PseudoDivision out;
    const int steps = a.degree - b.degree;
    for (int shift = steps; shift >= 0; --shift) {
        const mpz_class top = a.c[static_cast<std::size_t>(b.degree + shift)];
        for (mpz_class& c : out.quotient.c) c *= b.lead();
        out.quotient.c[static_cast<std::size_t>(shift)] += top;
        for (mpz_class& c : a.c) c *= b.lead();
        for (int i = 0; i <= b.degree; ++i)
            a.c[static_cast<std::size_t>(i + shift)] -= top * b.c[static_cast<std::size_t>(i)];
    }
    a.trim();
    out.quotient.trim();
    out.remainder = std::move(a);
    return out;
}

Poly polynomial_gcd(Poly a, Poly b) {
    if (a.degree < b.degree) std::swap(a, b);
    while (!b.is_zero()) {
        make_primitive(b);
        Poly r = pseudo_divide(std::move(a), b).remainder;
        a = std::move(b);
        b = std::move(r);
    }
    return a;
}

/// p without repeated factors: the same roots, each once.
Poly square_free(const Poly& p) {
    const Poly g = polynomial_gcd(p, derivative(p));
    if (g.degree <= 0) return p;
    Poly q = pseudo_divide(p, g).quotient;
    make_primitive(q);
    return q;
}

// ---------------------------------------------------------------------------------------------------------------------
// A polynomial on the dyadic interval [k, k + 1] / 2^n in Bernstein form, scaled to integers (only signs matter).

struct Dyadic {
    mpz_class k = 0;
    unsigned n = 0;
};

using Bernstein = std::vector<mpz_class>;

Bernstein bernstein(const Poly& p, const Dyadic& at) {
    // Substitute t = (k + s) / 2^n, times 2^(n degree): Horner on the shifted coefficients, then Taylor shift by k.
    const auto d = static_cast<std::size_t>(std::max(p.degree, 0));
    std::array<mpz_class, 4> a;
    for (std::size_t i = 0; i <= d; ++i) a[i] = p.c[i] << (at.n * static_cast<unsigned>(d - i));
    for (std::size_t i = 0; i < d; ++i)
        for (std::size_t j = d; j-- > i;) a[j] += at.k * a[j + 1];
    // b_i = sum_j binomial(i, j) / binomial(d, j) a_j, times d where d < 4 makes everything an integer.
    switch (d) {
    case 0: return {a[0]};
    case 1: return {a[0], a[0] + a[1]};
    case 2: return {2 * a[0], 2 * a[0] + a[1], 2 * (a[0] + a[1] + a[2])};
    default: return {3 * a[0], 3 * a[0] + a[1], 3 * a[0] + 2 * a[1] + a[2], 3 * (a[0] + a[1] + a[2] + a[3])};
    }
}

/// De Casteljau at the middle, times 2^degree.
void split(const Bernstein& b, Bernstein& left, Bernstein& right) {
    const std::size_t d = b.size() - 1;
    left.resize(d + 1);
    right = b;
    for (std::size_t j = 0; j <= d; ++j) {
        left[j] = right[0] << (d - j);
        for (std::size_t i = 0; i + j < d; ++i) right[i] += right[i + 1];
        right[d - j] <<= d - j;
    }
}

/// Descartes: the number of roots inside the open interval is at most this, and equal where this is 0 or 1.
int sign_variations(const Bernstein& b) {
    int variations = 0, last = 0;
    for (const mpz_class& c : b) {
        const int s = sgn(c);
        if (s != 0 && last != 0 && s != last) ++variations;
        if (s != 0) last = s;
    }
    return variations;
}

/// +1 or -1 where that is the sign on the whole closed interval, else nothing.
std::optional<int> uniform_sign(const Bernstein& b) {
    const int s = sgn(b.front());
    for (const mpz_class& c : b)
        if (sgn(c) != s || s == 0) return std::nullopt;
    return s;
}

// ---------------------------------------------------------------------------------------------------------------------
// A real root of an integer polynomial in [0, 1].

class Root {
  public:
    /// The dyadic number k / 2^n itself.
    explicit Root(Dyadic at) : at_(std::move(at)), is_dyadic_(true) {}
    /// The only root of p, a simple one, inside the open interval. b is p there.
    Root(const Poly& p, Dyadic interval, Bernstein b) : at_(std::move(interval)), p_(p), b_(std::move(b)) {}

    /// Sign of q at this root. Exact.
    int sign(const Poly& q) {
        if (q.is_zero()) return 0;
        for (unsigned round = 0; !is_dyadic_; ++round) {
            if (const auto s = uniform_sign(bernstein(q, at_))) return *s;
            if (round == kCommonRootRound && is_root_of(q)) return 0;
            for (int i = 0; i < 8 && !is_dyadic_; ++i) bisect();
        }
        return sgn(bernstein(q, at_).front());
    }

    void refine(unsigned bits) {
        while (!is_dyadic_ && at_.n < bits) bisect();
    }

    [[nodiscard]] mpq_class lower() const { return scaled(at_.k); }
    [[nodiscard]] mpq_class upper() const { return scaled(is_dyadic_ ? at_.k : mpz_class(at_.k + 1)); }

  private:
    // Interval arithmetic settles nearly every sign at once; a common root never, so it is looked for after a few
    // rounds.
    static constexpr unsigned kCommonRootRound = 6;

    [[nodiscard]] mpq_class scaled(const mpz_class& k) const {
        mpq_class q(k, mpz_class(1) << at_.n);
        q.canonicalize();
        return q;
    }

    void bisect() {
        Bernstein left, right;
        split(b_, left, right);
        at_.k <<= 1;
        ++at_.n;
        if (left.back() == 0) {
            at_.k += 1;
            is_dyadic_ = true;
        } else if (sign_variations(left) == 1) {
            // The parent has one variation, so exactly one of the halves has one.
            b_ = std::move(left);
        } else {
            at_.k += 1;
            b_ = std::move(right);
        }
    }

    /// The gcd's roots are roots of p, and inside the interval p has this one alone, a simple one: the gcd has it
    /// exactly if its sign changes from one end to the other. Ends where p vanishes are left behind first.
    bool is_root_of(const Poly& q) {
        const Poly g = polynomial_gcd(p_, q);
        if (g.degree <= 0) return false;
        while (!is_dyadic_ && (b_.front() == 0 || b_.back() == 0)) bisect();
        const Bernstein on = bernstein(g, at_);
        return is_dyadic_ ? on.front() == 0 : sgn(on.front()) * sgn(on.back()) < 0;
    }

    Dyadic at_;
    bool is_dyadic_ = false;
    Poly p_;
    Bernstein b_;
};

/// Appends the roots inside the open interval in ascending order; false where `depth` halvings do not isolate them,
/// which without a limit can happen only to repeated roots.
bool isolate_inside(const Poly& p, const Bernstein& b, const Dyadic& at, unsigned depth, std::vector<Root>& roots) {
    const int variations = sign_variations(b);
    if (variations == 0) return true;
    if (variations == 1) {
        roots.emplace_back(p, at, b);
        return true;
    }
    if (at.n >= depth) return false;
    Bernstein left, right;
    split(b, left, right);
    const Dyadic low{at.k << 1, at.n + 1}, high{(at.k << 1) + 1, at.n + 1};
    if (!isolate_inside(p, left, low, depth, roots)) return false;
    if (right.front() == 0) roots.emplace_back(high);
    return isolate_inside(p, right, high, depth, roots);
}

/// Appends all roots in [0, 1] in ascending order. Precondition: p is not zero.
void isolate(Poly p, std::vector<Root>& roots) {
    constexpr unsigned kTryDepth = 24;
    const std::size_t before = roots.size();
    for (const unsigned depth : {kTryDepth, std::numeric_limits<unsigned>::max()}) {
        if (depth != kTryDepth) p = square_free(p);
        const Bernstein b = bernstein(p, {});
        if (b.front() == 0) roots.emplace_back(Dyadic{0, 0});
        if (p.degree > 0 && isolate_inside(p, b, {}, depth, roots)) {
            if (b.back() == 0) roots.emplace_back(Dyadic{1, 0});
            return;
        }
        if (p.degree <= 0) return;
        roots.erase(roots.begin() + static_cast<std::ptrdiff_t>(before), roots.end());
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// The query in integers.

/// A vector linear in t: a + b t, coordinates scaled by one power of two for the whole query.
struct LinearVector {
    std::array<mpz_class, 3> a, b;
};

int lowest_bit(double x) {
    int exponent = 0;
    const double m = std::frexp(std::fabs(x), &exponent); // in [1/2, 1)
    const auto integer = static_cast<std::uint64_t>(std::ldexp(m, 53));
    return exponent - 53 + std::countr_zero(integer);
}

mpz_class to_integer(double x, int unit_exponent) {
    int exponent = 0;
    mpz_class z(std::ldexp(std::frexp(x, &exponent), 53));
    const int shift = exponent - 53 - unit_exponent;
    if (shift >= 0) return z << static_cast<unsigned>(shift);
    return z >> static_cast<unsigned>(-shift); // exact: unit_exponent is at most the lowest bit
}

struct Point {
    std::array<mpz_class, 3> x0, x1;
};

std::array<Point, 4> integer_points(const CcdQuery& q) {
    int unit = std::numeric_limits<int>::max();
    for (const auto* points : {&q.x0, &q.x1})
        for (const Vec3& p : *points)
            for (int c = 0; c < 3; ++c) {
                const double x = component(p, c);
                if (!std::isfinite(x)) throw std::invalid_argument("exact_ccd: coordinate is not finite");
                if (x != 0) unit = std::min(unit, lowest_bit(x));
            }
    std::array<Point, 4> points;
    for (std::size_t i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c) {
            const auto k = static_cast<std::size_t>(c);
            if (const double x = component(q.x0[i], c); x != 0) points[i].x0[k] = to_integer(x, unit);
            if (const double x = component(q.x1[i], c); x != 0) points[i].x1[k] = to_integer(x, unit);
        }
    return points;
}

LinearVector difference(const Point& p, const Point& q) {
    LinearVector w;
    for (std::size_t c = 0; c < 3; ++c) {
        w.a[c] = p.x0[c] - q.x0[c];
        w.b[c] = p.x1[c] - q.x1[c] - w.a[c];
    }
    return w;
}

LinearVector operator-(const LinearVector& v, const LinearVector& w) {
    LinearVector d;
    for (std::size_t c = 0; c < 3; ++c) {
        d.a[c] = v.a[c] - w.a[c];
        d.b[c] = v.b[c] - w.b[c];
    }
    return d;
}

void add_product(Poly& p, std::size_t power, const mpz_class& x, const mpz_class& y) {
    mpz_addmul(p.c[power].get_mpz_t(), x.get_mpz_t(), y.get_mpz_t());
}
void subtract_product(Poly& p, std::size_t power, const mpz_class& x, const mpz_class& y) {
    mpz_submul(p.c[power].get_mpz_t(), x.get_mpz_t(), y.get_mpz_t());
}

/// Component `axis` of v x w.
Poly cross_component(const LinearVector& v, const LinearVector& w, std::size_t axis) {
    const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
    Poly p;
    add_product(p, 0, v.a[i], w.a[j]);
    subtract_product(p, 0, v.a[j], w.a[i]);
    add_product(p, 1, v.a[i], w.b[j]);
    add_product(p, 1, v.b[i], w.a[j]);
    subtract_product(p, 1, v.a[j], w.b[i]);
    subtract_product(p, 1, v.b[j], w.a[i]);
    add_product(p, 2, v.b[i], w.b[j]);
    subtract_product(p, 2, v.b[j], w.b[i]);
    p.trim();
    return p;
}

Poly dot_product(const LinearVector& v, const LinearVector& w) {
    Poly p;
    for (std::size_t i = 0; i < 3; ++i) {
        add_product(p, 0, v.a[i], w.a[i]);
        add_product(p, 1, v.a[i], w.b[i]);
        add_product(p, 1, v.b[i], w.a[i]);
        add_product(p, 2, v.b[i], w.b[i]);
    }
    p.trim();
    return p;
}

Poly determinant(const LinearVector& u, const LinearVector& v, const LinearVector& w) {
    Poly p;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Poly n = cross_component(v, w, axis);
        for (std::size_t i = 0; i < 3; ++i) {
            add_product(p, i, u.a[axis], n.c[i]);
            add_product(p, i + 1, u.b[axis], n.c[i]);
        }
    }
    p.trim();
    return p;
}

/// A point and a segment, or one end of an edge and the other edge, as difference vectors v = p - q0, w = p - q1. With
/// n = v x w: p is on the segment exactly if n = 0 and v . w <= 0, whatever the segment's length.
struct PointSegment {
    std::array<Poly, 3> n;
    Poly dot;

    PointSegment(const LinearVector& v, const LinearVector& w)
        : n{cross_component(v, w, 0), cross_component(v, w, 1), cross_component(v, w, 2)}, dot(dot_product(v, w)) {}

    [[nodiscard]] bool touches(Root& t) const {
        return std::all_of(n.begin(), n.end(), [&](const Poly& p) { return t.sign(p) == 0; }) && t.sign(dot) <= 0;
    }
};

/// All polynomials in t whose signs say whether the features meet.
class Contact {
  public:
    Contact(CcdKind kind, const CcdQuery& query) : kind_(kind) {
        const auto x = integer_points(query);
        if (kind == CcdKind::vertex_face) {
            w_ = {difference(x[0], x[1]), difference(x[0], x[2]), difference(x[0], x[3]), {}};
            volume_ = determinant(w_[0], w_[1], w_[2]);
        } else {
            w_ = {difference(x[0], x[2]), difference(x[0], x[3]), difference(x[1], x[2]), difference(x[1], x[3])};
            volume_ = determinant(w_[0], w_[1], w_[2]);
        }
    }

    /// Zero exactly where the four points are coplanar.
    [[nodiscard]] const Poly& volume() const { return volume_; }

    /// Do the closed features meet at t? Precondition: the four points are coplanar at t.
    [[nodiscard]] bool touches(Root& t) {
        prepare();
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (const int s = t.sign(normal_[axis]); s != 0) return overlap_along(axis, s, t);
        // Degenerate triangle: the union of its edges. Parallel or degenerate edges: where they meet at all, an end of
        // one lies on the other.
        return std::any_of(pairs_.begin(), pairs_.end(), [&](const PointSegment& p) { return p.touches(t); });
    }

    /// Every time in [0, 1] where the answer of touches() can change while the four points stay coplanar: roots of any
    /// polynomial that it reads, and t = 0. In no particular order.
    [[nodiscard]] std::vector<Root> events() {
        prepare();
        std::vector<Root> roots{Root(Dyadic{0, 0})};
        const auto add = [&](const Poly& p) {
            if (p.degree > 0) isolate(p, roots);
        };
        for (const Poly& p : normal_) add(p);
        for (const PointSegment& pair : pairs_) {
            for (const Poly& p : pair.n) add(p);
            add(pair.dot);
        }
        return roots;
    }

  private:
    /// Only queries that reach a coplanar time need these.
    void prepare() {
        if (!pairs_.empty()) return;
        if (kind_ == CcdKind::vertex_face) {
            for (const auto& [i, j] : {std::pair{0U, 1U}, {1U, 2U}, {2U, 0U}}) pairs_.emplace_back(w_[i], w_[j]);
            prepare_normal(w_[0] - w_[1], w_[0] - w_[2]);
        } else {
            for (const auto& [i, j] : {std::pair{0U, 1U}, {2U, 3U}, {0U, 2U}, {1U, 3U}})
                pairs_.emplace_back(w_[i], w_[j]);
            prepare_normal(w_[2] - w_[0], w_[0] - w_[1]);
        }
    }
    void prepare_normal(const LinearVector& u, const LinearVector& v) {
        for (std::size_t axis = 0; axis < 3; ++axis) normal_[axis] = cross_component(u, v, axis);
    }

    /// The features in the plane with normal_[axis] of sign s != 0, seen along that axis.
    [[nodiscard]] bool overlap_along(std::size_t axis, int s, Root& t) const {
        const auto side = [&](std::size_t pair) { return t.sign(pairs_[pair].n[axis]); };
        if (kind_ == CcdKind::vertex_face)
            return s * side(0) >= 0 && s * side(1) >= 0 && s * side(2) >= 0; // barycentric coordinates times the area
        // The lines cross in one point: the ends of each edge must not be on the same open side of the other line.
        return side(0) * side(1) <= 0 && side(2) * side(3) <= 0;
    }

    CcdKind kind_;
    std::array<LinearVector, 4> w_;
    Poly volume_;
    std::array<Poly, 3> normal_;
    std::vector<PointSegment> pairs_; ///< VF: p and edge i; EE: a0 b, a1 b, a b0, a b1
};

/// The points are coplanar at single times only: the first of them where the features meet.
OracleToi first_of_roots(Contact& contact, unsigned bits) {
    std::vector<Root> roots;
    isolate(contact.volume(), roots);
    for (Root& t : roots)
        if (contact.touches(t)) {
            t.refine(bits);
            return {true, t.lower(), t.upper()};
        }
    return {};
}

/// The points are coplanar at all times. The set of contact times is closed and its indicator is constant between
/// events, so the first contact is an event. The enclosures of the earliest events may overlap; the minimum of the
/// lower ends and the minimum of the upper ends enclose the minimum all the same.
OracleToi first_of_events(Contact& contact, unsigned bits) {
    struct Event {
        mpq_class lower;
        Root t;
    };
    std::vector<Root> roots = contact.events();
    std::vector<Event> events;
    for (Root& t : roots) {
        t.refine(20);
        events.push_back({t.lower(), std::move(t)});
    }
    std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.lower < b.lower; });
    OracleToi best;
    for (auto& [start, t] : events) {
        if (best.hit && start >= best.upper) break;
        if (!contact.touches(t)) continue;
        t.refine(bits);
        const mpq_class lower = t.lower(), upper = t.upper();
        if (!best.hit || lower < best.lower) best.lower = lower;
        if (!best.hit || upper < best.upper) best.upper = upper;
        best.hit = true;
    }
    return best;
}

// ---------------------------------------------------------------------------------------------------------------------
// Bounds in extended precision (64-bit significand on x86-64).

struct VecL {
    long double x = 0, y = 0, z = 0;
};
VecL operator+(const VecL& a, const VecL& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
VecL operator-(const VecL& a, const VecL& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
VecL operator*(long double s, const VecL& a) { return {s * a.x, s * a.y, s * a.z}; }
long double dot(const VecL& a, const VecL& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
VecL cross(const VecL& a, const VecL& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
long double largest(const VecL& a) { return std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}); }

/// The difference vectors of a query and their separation along the way.
class Sweep {
  public:
    Sweep(CcdKind kind, const CcdQuery& q) : kind_(kind), count_(kind == CcdKind::vertex_face ? 3 : 4) {
        const auto subtract = [](const Vec3& a, const Vec3& b) {
            return VecL{static_cast<long double>(a.x) - static_cast<long double>(b.x),
                        static_cast<long double>(a.y) - static_cast<long double>(b.y),
                        static_cast<long double>(a.z) - static_cast<long double>(b.z)};
        };
        for (std::size_t k = 0; k < count_; ++k) {
            const std::size_t i = kind == CcdKind::vertex_face ? 0 : k / 2;
            const std::size_t j = kind == CcdKind::vertex_face ? k + 1 : 2 + k % 2;
            w0_[k] = subtract(q.x0[i], q.x0[j]);
            w1_[k] = subtract(q.x1[i], q.x1[j]);
            scale_ = std::max({scale_, largest(w0_[k]), largest(w1_[k])});
        }
        // Every w(t) below carries at most 4 roundings relative to scale_, a dot product with a unit vector 5 more per
        // component, a convex combination 8: 64 roundings cover each sum of them with room to spare.
        error_ = 64 * std::numeric_limits<long double>::epsilon() * scale_;
    }

    /// No rounding error of this class exceeds this, m.
    [[nodiscard]] long double error() const { return error_; }

    /// Lower bound of the distance on [t0, t1] from a unit vector d: the distance is at least d . F for every F in the
    /// convex hull of the w, each d . w is linear in t, so its ends bound it. True for any d.
    [[nodiscard]] long double gap(const VecL& d, long double t0, long double t1) const {
        long double least = HUGE_VALL;
        for (std::size_t k = 0; k < count_; ++k) least = std::min({least, dot(d, at(k, t0)), dot(d, at(k, t1))});
        return least - error_;
    }

    /// The shortest vector from the second feature to the first at t, as far as extended precision finds it. Its length
    /// is an upper bound of the distance up to error(): the vector joins two points of the features in any case.
    [[nodiscard]] VecL shortest(long double t) const {
        std::array<VecL, 4> w;
        for (std::size_t k = 0; k < count_; ++k) w[k] = at(k, t);
        VecL best = w[0];
        const auto offer = [&](const VecL& v) {
            if (dot(v, v) < dot(best, best)) best = v;
        };
        if (kind_ == CcdKind::vertex_face) {
            for (std::size_t k = 0; k < 3; ++k) offer(nearest_on_segment(w[k], w[(k + 1) % 3]));
            offer_plane(w[0], w[1] - w[0], w[2] - w[0], true, offer);
        } else {
            offer(nearest_on_segment(w[0], w[1]));
            offer(nearest_on_segment(w[2], w[3]));
            offer(nearest_on_segment(w[0], w[2]));
            offer(nearest_on_segment(w[1], w[3]));
            offer_plane(w[0], w[2] - w[0], w[1] - w[0], false, offer);
        }
        return best;
    }

  private:
    [[nodiscard]] VecL at(std::size_t k, long double t) const { return (1 - t) * w0_[k] + t * w1_[k]; }

    static VecL nearest_on_segment(const VecL& a, const VecL& b) {
        const VecL e = b - a;
        const long double ee = dot(e, e);
        if (!(ee > 0)) return a;
        const long double s = std::clamp(-dot(a, e) / ee, 0.0L, 1.0L);
        return (1 - s) * a + s * b;
    }

    /// The foot of the origin on a + s u + r v, where it is inside the triangle or the parallelogram.
    template <class Offer>
    static void offer_plane(const VecL& a, const VecL& u, const VecL& v, bool triangle, const Offer& offer) {
        const VecL n = cross(u, v);
        const long double nn = dot(n, n);
        if (!(nn > 0)) return;
        const long double s = dot(n, cross(v, a)) / nn, r = dot(n, cross(a, u)) / nn;
        if (s >= 0 && r >= 0 && s <= 1 && r <= 1 && (!triangle || s + r <= 1)) offer(a + s * u + r * v);
    }

    CcdKind kind_;
    std::size_t count_;
    std::array<VecL, 4> w0_, w1_;
    long double scale_ = 0, error_ = 0;
};

long double length(const VecL& v) { return std::sqrt(dot(v, v)); }

/// Unit to rounding. Dividing by the length after the largest component keeps the squares of tiny vectors from
/// vanishing.
VecL unit(const VecL& v) {
    const long double m = largest(v);
    if (!(m > 0)) return {};
    const VecL scaled{v.x / m, v.y / m, v.z / m};
    return (1 / length(scaled)) * scaled;
}

/// True only if the features certainly stay apart on [t0, t1]; gives up early, the exact arithmetic takes over.
bool prove_apart(const Sweep& sweep, long double t0, long double t1, int depth) {
    const VecL d = unit(sweep.shortest((t0 + t1) / 2));
    if (sweep.gap(d, t0, t1) > 0) return true;
    if (depth == 0 || !(sweep.gap(d, (t0 + t1) / 2, (t0 + t1) / 2) > 0)) return false;
    const long double mid = (t0 + t1) / 2;
    return prove_apart(sweep, t0, mid, depth - 1) && prove_apart(sweep, mid, t1, depth - 1);
}

struct Interval {
    long double t0, t1, lower;
    bool operator<(const Interval& o) const { return lower > o.lower; } // smallest lower bound on top
};

} // namespace

OracleToi exact_ccd(CcdKind kind, const CcdQuery& query, unsigned bits, OracleFilter filter) {
    if (filter == OracleFilter::on && prove_apart(Sweep(kind, query), 0, 1, 4)) return {};
    Contact contact(kind, query);
    return contact.volume().is_zero() ? first_of_events(contact, bits) : first_of_roots(contact, bits);
}

bool is_late(CcdKind kind, const CcdQuery& query, const OracleToi& truth, double reported) {
    // A double in [0, 1] is a dyadic number of at most 1074 bits: refined that far, an enclosure either leaves it
    // outside or has met it exactly.
    const mpq_class time(reported);
    if (time <= truth.lower) return false;
    if (time > truth.upper) return true;
    const OracleToi fine = exact_ccd(kind, query, 1100, OracleFilter::off);
    return time > fine.lower;
}

DistanceRange min_distance(CcdKind kind, const CcdQuery& query, const DistanceGoal& goal) {
    const Sweep sweep(kind, query);
    std::priority_queue<Interval> open;
    DistanceRange range{0, HUGE_VALL};
    const auto push = [&](long double t0, long double t1) {
        const VecL v = sweep.shortest((t0 + t1) / 2);
        range.upper = std::min(range.upper, length(v) + sweep.error());
        open.push({t0, t1, std::max(sweep.gap(unit(v), t0, t1), 0.0L)});
    };
    range.upper = std::min(length(sweep.shortest(0)), length(sweep.shortest(1))) + sweep.error();
    push(0, 1);
    for (int evaluations = 1;; evaluations += 2) {
        const Interval worst = open.top();
        range.lower = std::min(worst.lower, range.upper);
        const bool done = range.upper - range.lower <= goal.tolerance || range.lower > goal.above ||
                          range.upper <= goal.below || evaluations >= goal.budget;
        if (done) return range;
        open.pop();
        const long double mid = (worst.t0 + worst.t1) / 2;
        push(worst.t0, mid);
        push(mid, worst.t1);
    }
}

} // namespace flotilla::test
