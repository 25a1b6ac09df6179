// SPDX-License-Identifier: MIT
// Directional conservative advancement, written once for every vector width.
//
// Idea: conservative advancement (Mirtich 1996) with a direction in place of a bound on the speed. With
//     w_k(t) = p(t) - f_k(t), k = 1..3        (vertex p, triangle f)
//     w_k(t) = a_i(t) - b_j(t), k = (i, j)    (edges a, b)
// the vector between any point of the one feature and any point of the other is a convex combination of the w_k(t). So
// for any vector d the features are at least min_k d.w_k(t) / |d| apart, and each d.w_k is LINEAR in t: g_k(t) = (1-t)
// g_k0 + t g_k1. At time t take d towards the closest points, advance to the first t' at which some g_k falls to the
// separation, repeat. Every interval advanced over is proved; how good d is decides only how many iterations it takes
// and how many misses are reported as hits. Comparisons are written so that NaN means "not proved".
//
// The vector d is used as it comes, without normalising: the test is g_k >= (separation) |d|.
//
// Rounding. u = 2^-53; W = max |component of any w_k(0), w_k(1)|; the coordinates given are exact, so only differences
// of them enter, and the bound does not grow with the distance from the origin. Write G for exact and g for computed
// values of d.w_k at t = 0 and t = 1, where d is the computed (and from then on exact) vector; l for the computed |d|,
// s for the separation.
//  (1) l = |d| (1 + e), |e| <= 2.6u: a sum of squares (relative error 3u) under a root (half of it, plus u).
//  (2) |g - G| <= 7.1 u W |d|: each component of w is off by at most u W and |d|_1 <= sqrt(3) |d|, which gives 1.74 u W
//      |d|; three products and two sums give 3.01u sum |d_i w_i| <= 3.01u |d| |w| <= 5.3 u W |d|.
//  (3) The value at t is tested as g0 + t (g1 - g0) >= h l, h = s + err. |g| <= 1.74 W |d|, so the difference and the
//      product are off by at most 3.5 u W |d| each and the sum by 1.75 u W |d|: 8.8 u W |d| together.
//  (4) A falling line reaches h l at t' = (g0 - h l)/(g0 - g1), computed to a relative 3.1u, which moves the value by
//      3.1u (g0 - h l) <= 5.4 u W |d|. A line with g1 >= h l and a value >= h l at t stays so up to t = 1.
//  (5) h and its product with l are off by a relative 4.7u, and h <= 1.75 W wherever anything is proved: 8.3 u W |d|.
// On an interval whose ends were found by (3) and (4) the exact distance is thus at least s + err - (7.1 + 8.8 + 8.3) u
// W > s + err - 25 u W. With err = 64 u 2^ceil(log2 W) + tiny this exceeds s strictly, with more than half of err to
// spare. Tiny covers underflow: |d| > 2^-250, so tiny |d| > 2^-1050, above the sum of all underflow errors. Queries
// with W > 2^80 are hits; nothing overflows in what is left.
//
// W here replaces the largest coordinate M of the plain bound (W <= 2M): as good near the origin, and much tighter for
// small features far away from it.
#pragma once

#include <cstddef>

#include "geometry/ccd_hits.hpp"
#include "geometry/corner_pack.hpp"
#include "geometry/pack_vec.hpp"

namespace flotilla {
namespace {

inline constexpr double kErrFactor = 0x1p-47;    // 64 u
inline constexpr double kTiny = 0x1p-800;        // covers underflow
inline constexpr double kLargest = 0x1p80;       // larger differences count as hits
inline constexpr double kHuge = 0x1p300;         // above every finite product
inline constexpr double kLeastSquare = 0x1p-500; // a direction shorter than 2^-250 is none
inline constexpr double kSlackOfErr = 1024;      // beside kSlackOfSeparation: a multiple of err
inline constexpr int kMaxIterations = 2048;      // only grazing motion comes near it

template <class P>
inline PackVec<P> add_scaled(const PackVec<P>& a, P s, const PackVec<P>& b) {
    return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
template <class P>
inline P max_abs(const PackVec<P>& a) {
    return max(max(abs(a.x), abs(a.y)), abs(a.z));
}

/// The differences w_k at t = 0 and t = 1.
template <class P, CcdKind kKind>
struct Differences {
    static constexpr std::size_t kCount = kKind == CcdKind::vertex_face ? 3 : 4;
    PackVec<P> w0[kCount], w1[kCount];
};

/// A pack of queries, each whole in memory.
template <class P>
struct WholeQueries {
    const double* query[P::kWidth];
};
/// The corners at t = 0 or t = 1.
template <CcdKind kKind, class P>
inline void load_points(const WholeQueries<P>& queries, int time, PackVec<P> (&x)[4]) {
    P a[4], b[4], c[4];
    load_transposed(queries.query, 12 * time, a);
    load_transposed(queries.query, 12 * time + 4, b);
    load_transposed(queries.query, 12 * time + 8, c);
    x[0] = {a[0], a[1], a[2]};
    x[1] = {a[3], b[0], b[1]};
    x[2] = {b[2], b[3], c[0]};
    x[3] = {c[1], c[2], c[3]};
}

template <CcdKind kKind, class P, std::size_t kCount>
inline void subtract(const PackVec<P> (&x)[4], PackVec<P> (&w)[kCount]) {
    if constexpr (kKind == CcdKind::vertex_face) {
        for (std::size_t k = 0; k < 3; ++k) w[k] = x[0] - x[k + 1];
    } else {
        w[0] = x[0] - x[2];
        w[1] = x[0] - x[3];
        w[2] = x[1] - x[2];
        w[3] = x[1] - x[3];
    }
}

template <CcdKind kKind, class P, template <class> class Queries>
inline Differences<P, kKind> load_differences(const Queries<P>& queries) {
    Differences<P, kKind> out;
    PackVec<P> x[4];
    load_points<kKind>(queries, 0, x);
    subtract<kKind>(x, out.w0);
    load_points<kKind>(queries, 1, x);
    subtract<kKind>(x, out.w1);
    return out;
}

template <class P, CcdKind kKind>
inline P largest_difference(const Differences<P, kKind>& d) {
    // A maximum may lose a NaN: Advance::sum catches it.
    P m = max_abs(d.w0[0]);
    for (std::size_t k = 1; k < Differences<P, kKind>::kCount; ++k) m = max(m, max_abs(d.w0[k]));
    for (std::size_t k = 0; k < Differences<P, kKind>::kCount; ++k) m = max(m, max_abs(d.w1[k]));
    return m;
}

/// A vector v and its square.
template <class P>
struct Candidate {
    PackVec<P> v;
    P square;
};

/// The shortest vector of the segment from w along e. A zero e has an infinite inv_ee, whose product with the zero
/// beside it is NaN, which max() turns into t = 0. kNormal: made normal to e once more where it should be.
template <bool kNormal, class P>
inline Candidate<P> shortest_of_segment(const PackVec<P>& w, const PackVec<P>& e, P inv_ee) {
    const P zero = P::all(0);
    const P t = min(max((zero - dot(w, e)) * inv_ee, zero), P::all(1));
    PackVec<P> c = add_scaled(w, t, e);
    if constexpr (kNormal) {
        const P along = select(mask_and(zero < t, t < P::all(1)), zero - dot(c, e) * inv_ee, zero);
        c = add_scaled(c, along, e);
    }
    return {c, dot(c, c)};
}

template <class P>
inline Candidate<P> shorter_of(const Candidate<P>& a, const Candidate<P>& b) {
    const auto first = a.square < b.square;
    return {select(first, a.v, b.v), select(first, a.square, b.square)};
}

/// The shortest vector to the boundary of the convex hull of the w_k, and the normal of its plane.
template <bool kNormal, class P>
inline void hull_candidates(const PackVec<P> (&w)[3], Candidate<P>& edge, PackVec<P>& normal) {
    const PackVec<P> e01 = w[1] - w[0], e12 = w[2] - w[1], e20 = w[0] - w[2];
    const P one = P::all(1);
    edge = shorter_of(shorter_of(shortest_of_segment<kNormal>(w[0], e01, one / dot(e01, e01)),
                                 shortest_of_segment<kNormal>(w[1], e12, one / dot(e12, e12))),
                      shortest_of_segment<kNormal>(w[2], e20, one / dot(e20, e20)));
    normal = cross(e01, e20);
}
template <bool kNormal, class P>
inline void hull_candidates(const PackVec<P> (&w)[4], Candidate<P>& edge, PackVec<P>& normal) {
    const PackVec<P> ea = w[2] - w[0], eb = w[1] - w[0];
    const P inv_aa = P::all(1) / dot(ea, ea), inv_bb = P::all(1) / dot(eb, eb);
    edge = shorter_of(
        shorter_of(shortest_of_segment<kNormal>(w[0], ea, inv_aa), shortest_of_segment<kNormal>(w[1], ea, inv_aa)),
        shorter_of(shortest_of_segment<kNormal>(w[0], eb, inv_bb), shortest_of_segment<kNormal>(w[2], eb, inv_bb)));
    normal = cross(ea, eb);
}

template <class P, std::size_t kCount>
inline P least_of(const P (&g)[kCount]) {
    P least = g[0];
    for (std::size_t k = 1; k < kCount; ++k) least = min(g[k], least);
    return least;
}

/// The products d.w_k and the least of them.
template <class P, std::size_t kCount>
inline P products(const PackVec<P>& d, const PackVec<P> (&w)[kCount], P (&g)[kCount]) {
    for (std::size_t k = 0; k < kCount; ++k) g[k] = dot(d, w[k]);
    return least_of(g);
}

/// The better of two candidates, the closest boundary point and the normal of the hull's plane: that with the larger
/// min_k d.w_k / |d|. In exact arithmetic one of them is the closest point of the hull, which maximises it; choosing by
/// the proved gap itself keeps needles and parallel edges, whose normals are noise, harmless. Also returns the products
/// d.w_k.
template <bool kNormal, class P, std::size_t kCount>
inline Candidate<P> separating_direction(const PackVec<P> (&w)[kCount], P (&g)[kCount]) {
    const P zero = P::all(0);
    Candidate<P> edge;
    PackVec<P> n;
    hull_candidates<kNormal>(w, edge, n);
    const P side = dot(n, w[0]);
    n = {flip_sign(n.x, side), flip_sign(n.y, side), flip_sign(n.z, side)};
    const P nn = dot(n, n);
    P g_normal[kCount];
    const P least = products(edge.v, w, g), least_normal = products(n, w, g_normal);
    const auto larger = (least * least) * nn < (least_normal * least_normal) * edge.square;
    const auto use_normal = mask_and(zero < least_normal, mask_or(least <= zero, larger));
    for (std::size_t k = 0; k < kCount; ++k) g[k] = select(use_normal, g_normal[k], g[k]);
    return {select(use_normal, n, edge.v), select(use_normal, nn, edge.square)};
}

/// What one direction proves, seen from time t; all values are multiplied by the direction's length.
template <class P, std::size_t kCount>
struct Advance {
    PackVec<P> direction;
    P square, length;
    P g0[kCount], g1[kCount]; ///< d.w_k at t = 0 and t = 1
    P least;                  ///< min_k g_k(t)
    P sum;                    ///< sum_k (g_k(t) + g_k1); NaN where any coordinate is, which minima would lose
};

/// kAtStart: t = 0, where w_k(t) and its products are those of the start.
template <bool kAtStart, bool kNormal, class P, CcdKind kKind>
inline auto look(const Differences<P, kKind>& x, P t) {
    constexpr std::size_t kCount = Differences<P, kKind>::kCount;
    Advance<P, kCount> out;
    Candidate<P> d;
    if constexpr (kAtStart) {
        d = separating_direction<kNormal>(x.w0, out.g0);
    } else {
        PackVec<P> w[kCount];
        for (std::size_t k = 0; k < kCount; ++k) w[k] = add_scaled(x.w0[k], t, x.w1[k] - x.w0[k]);
        d = separating_direction<kNormal>(w, out.g0);
        products(d.v, x.w0, out.g0);
    }
    out.direction = d.v;
    out.square = d.square;
    out.length = sqrt(d.square);
    products(d.v, x.w1, out.g1);
    for (std::size_t k = 0; k < kCount; ++k) {
        const P g = kAtStart ? out.g0[k] : out.g0[k] + t * (out.g1[k] - out.g0[k]);
        out.sum = k == 0 ? g + out.g1[k] : (out.sum + g) + out.g1[k];
        out.least = k == 0 ? g : min(g, out.least);
    }
    return out;
}

/// The first time at which some falling g_k reaches h (times the length); 1 where none does.
template <class P, std::size_t kCount>
inline P first_fall(const Advance<P, kCount>& a, P h) {
    P t = P::all(1);
    for (std::size_t k = 0; k < kCount; ++k) t = select(a.g1[k] < h, min((a.g0[k] - h) / (a.g0[k] - a.g1[k]), t), t);
    return t;
}

/// min_k (g_k1 - g_k0).
template <class P, std::size_t kCount>
inline P least_rise(const Advance<P, kCount>& a) {
    P least = a.g1[0] - a.g0[0];
    for (std::size_t k = 1; k < kCount; ++k) least = min(a.g1[k] - a.g0[k], least);
    return least;
}

template <class P>
struct Progress {
    P t, separation;
};

/// What is asked of a batch.
struct Wanted {
    bool relaxed = false;   ///< CcdStart::relaxed
    bool only_hits = false; ///< results of misses, and of hits after `latest`, get hit = false and nothing else
    double latest = 1;
};

/// The separation that the start allows: unchanged, or kKeptShare of the start distance (relaxed start).
template <class P>
inline P start_separation(P d0, P err, P separation) {
    return select(P::all(kFloorPerError) * err <= d0, min(P::all(kKeptShare) * d0, separation), separation);
}

/// Writes the results of the lanes whose bits are in `done`.
template <class P, std::size_t kCount>
inline void finish_lanes(unsigned done, unsigned missed, unsigned proved, const Advance<P, kCount>& a, P at,
                         int iterations, CcdResult* const* results) {
    constexpr unsigned kAll = (1u << P::kWidth) - 1;
    const P zero = P::all(0), one = P::all(1);
    const P inv = one / a.length;
    P rows[4] = {a.direction.x * inv, a.direction.y * inv, a.direction.z * inv, one};
    // Nearly always all lanes are certified misses: nothing to mask.
    if ((missed & proved) != kAll) {
        const auto known = P::lanes(proved);
        for (int i = 0; i < 3; ++i) rows[i] = select(known, rows[i], zero);
        rows[3] = select(P::lanes(missed), one, at);
    }
    double* out[P::kWidth];
    for (unsigned i = 0; i < static_cast<unsigned>(P::kWidth); ++i) out[i] = &results[i]->direction.x;
    store_transposed(rows, done, out);
    for (unsigned i = 0; i < static_cast<unsigned>(P::kWidth); ++i) {
        if (((done >> i) & 1u) == 0) continue;
        results[i]->hit = ((missed >> i) & 1u) == 0;
        results[i]->iterations = static_cast<std::uint16_t>(iterations);
    }
}

/// Says that lanes have no hit, or none that is wanted.
template <class P>
inline void rule_out(unsigned lanes, CcdResult* const* results) {
    for (unsigned i = 0; i < static_cast<unsigned>(P::kWidth); ++i)
        if (((lanes >> i) & 1u) != 0) results[i]->hit = false;
}

/// What an advance says of the active lanes, as bits.
template <class P>
struct Verdict {
    unsigned proved = 0; ///< apart now, or opening
    unsigned missed = 0, stopped = 0;
    P reach, separation;
};
template <bool kAtStart, class P, std::size_t kCount>
inline Verdict<P> judge(const Advance<P, kCount>& a, P err, unsigned in_range, const Wanted& wanted,
                        const Progress<P>& state, unsigned active) {
    constexpr unsigned kAll = (1u << P::kWidth) - 1;
    const P one = P::all(1);
    Verdict<P> out{.reach = state.t, .separation = state.separation};
    const unsigned valid = in_range & mask_bits(P::all(kLeastSquare) < a.square) & mask_bits(a.sum <= P::all(kHuge));
    unsigned opening = 0;
    if (kAtStart && wanted.relaxed) {
        opening = valid & mask_bits(mask_and(err * a.length <= a.least, err * a.length <= least_rise(a)));
        // At twice the separation start_separation() leaves it as it is, and rounding has room: most are spared the
        // division.
        const P far = ((state.separation + err) + (state.separation + err)) * a.length;
        if (mask_bits(far <= a.least) != kAll)
            out.separation = start_separation(a.least / a.length - err, err, state.separation);
    }
    const P h = (out.separation + err) * a.length;
    const unsigned apart = valid & mask_bits(h <= a.least);
    const P least_end = least_of(a.g1);
    out.proved = apart | opening;
    out.missed = active & (opening | (apart & mask_bits(h <= least_end)));
    out.stopped = active & ~out.missed;
    if (out.stopped != 0) {
        const P slack = max(P::all(kSlackOfSeparation) * out.separation, P::all(kSlackOfErr) * err) * a.length;
        out.reach = first_fall(a, h);
        out.missed |= out.stopped & apart & mask_bits(one <= out.reach);
        out.stopped &= ~out.missed & (~apart | mask_bits(a.least <= h + slack));
    }
    return out;
}

/// Where rounding has more slack than the separation, it may be why lanes stopped: of features a nanometre apart and
/// metres long, the shortest vector to an edge of the hull is normal to it as to 1e-6 rad, and the far end of the edge
/// comes out beyond.
template <bool kAtStart, CcdKind kKind, class P, std::size_t kCount>
inline void look_closely(const Differences<P, kKind>& x, P err, unsigned in_range, const Wanted& wanted,
                         const Progress<P>& state, Advance<P, kCount>& a, Verdict<P>& verdict) {
    const auto rough = P::all(kSlackOfSeparation) * state.separation < P::all(kSlackOfErr) * err;
    const unsigned doubtful = verdict.stopped & mask_bits(rough);
    if (doubtful == 0) return;
    const auto b = look<kAtStart, true>(x, state.t);
    const Verdict<P> closer = judge<kAtStart>(b, err, in_range, wanted, state, doubtful);
    const unsigned better = doubtful & ~closer.stopped;
    if (better == 0) return;
    const auto take = [lanes = P::lanes(better)](P& to, P from) { to = select(lanes, from, to); };
    take(a.direction.x, b.direction.x), take(a.direction.y, b.direction.y), take(a.direction.z, b.direction.z);
    take(a.length, b.length), take(verdict.reach, closer.reach), take(verdict.separation, closer.separation);
    verdict.proved |= better & closer.proved;
    verdict.missed |= closer.missed;
    verdict.stopped &= ~better;
}

/// One iteration of the active lanes; returns the bits of those that go on.
template <bool kAtStart, CcdKind kKind, class P>
inline unsigned iterate(const Differences<P, kKind>& x, P err, unsigned in_range, const Wanted& wanted, int iterations,
                        Progress<P>& state, unsigned active, CcdResult* const* results) {
    auto a = look<kAtStart, false>(x, state.t);
    Verdict<P> v = judge<kAtStart>(a, err, in_range, wanted, state, active);
    if (v.stopped != 0) look_closely<kAtStart>(x, err, in_range, wanted, state, a, v);
    if (iterations + 1 == kMaxIterations) v.stopped = active & ~v.missed;
    const unsigned told = wanted.only_hits ? v.stopped : v.missed | v.stopped;
    if (told != 0) finish_lanes(told, v.missed, v.proved, a, state.t, iterations + 1, results);
    state = {max(v.reach, state.t), v.separation};
    active &= ~(v.missed | v.stopped);
    if (!wanted.only_hits) return active;
    const unsigned late = active & mask_bits(P::all(wanted.latest) < state.t);
    rule_out<P>(v.missed | late, results);
    return active & ~late;
}

/// True where the direction proves the features apart on all of [0, 1].
template <CcdKind kKind, class P>
inline unsigned certify_along(const WholeQueries<P>& query, const PackVec<P>& d, P separation) {
    const auto x = load_differences<kKind>(query);
    const P largest = largest_difference(x);
    const P err = P::all(kErrFactor) * ceil_power_of_two(largest) + P::all(kTiny);
    const P square = dot(d, d);
    P g0[Differences<P, kKind>::kCount], g1[Differences<P, kKind>::kCount];
    const P least = min(products(d, x.w0, g0), products(d, x.w1, g1));
    P sum = g0[0] + g1[0];
    for (std::size_t k = 1; k < Differences<P, kKind>::kCount; ++k) sum = (sum + g0[k]) + g1[k];
    const auto valid = mask_and(mask_and(largest < P::all(kLargest), P::all(kLeastSquare) < square),
                                mask_and(square < P::all(kLargest), sum <= P::all(kHuge)));
    return mask_bits(mask_and(valid, (separation + err) * sqrt(square) <= least));
}

template <class P, CcdKind kKind>
struct Loaded {
    Differences<P, kKind> differences;
    P err;
    unsigned in_range;
};
template <CcdKind kKind, class P, template <class> class Queries>
inline Loaded<P, kKind> load(const Queries<P>& queries) {
    Loaded<P, kKind> out{load_differences<kKind>(queries), P::all(0), 0}; // in place: a copy is dear
    const P largest = largest_difference(out.differences);
    out.err = P::all(kErrFactor) * ceil_power_of_two(largest) + P::all(kTiny);
    out.in_range = mask_bits(largest < P::all(kLargest));
    return out;
}

/// The first iteration of the active lanes. Writes the results of the lanes that finish and returns the bits of those
/// that do not.
template <CcdKind kKind, class P>
inline unsigned begin(const Loaded<P, kKind>& x, const Wanted& wanted, Progress<P>& state, unsigned active,
                      CcdResult* const* results) {
    return iterate<true>(x.differences, x.err, x.in_range, wanted, 0, state, active, results);
}
/// The other iterations, to the end.
template <CcdKind kKind, class P>
inline void go_on(const Loaded<P, kKind>& x, const Wanted& wanted, Progress<P>& state, unsigned active,
                  CcdResult* const* results) {
    for (int i = 1; active != 0; ++i)
        active = iterate<false>(x.differences, x.err, x.in_range, wanted, i, state, active, results);
}
template <CcdKind kKind, class P>
inline void run(const WholeQueries<P>& queries, const Wanted& wanted, Progress<P>& state, unsigned active,
                CcdResult* const* results) {
    const auto x = load<kKind>(queries);
    active = begin(x, wanted, state, active, results);
    go_on(x, wanted, state, active, results);
}

inline constexpr int kBlock = 256; // queries whose survivors are compacted together

/// What is left of a block of queries after the first iteration.
struct Survivors {
    int count = 0;
    int query[kBlock];
    double t[kBlock], separation[kBlock];
};

/// Queries in a row, each whole.
struct WholeSource {
    template <class P>
    using Pack = WholeQueries<P>;
    const CcdQuery* queries;

    [[nodiscard]] WholeSource from(long first) const { return {queries + first}; }
    template <class P>
    void set(WholeQueries<P>& pack, int lane, long k) const {
        pack.query[lane] = reinterpret_cast<const double*>(queries + k);
    }
    template <class P>
    WholeQueries<P> begin_pack() const {
        return {};
    }
};
/// Where the queries and results of a pack are; the idle lanes of an incomplete pack repeat its first query.
template <class P, class Source>
struct Lanes {
    typename Source::template Pack<P> queries;
    CcdResult* result[P::kWidth];
    unsigned active = 0;

    template <class Index>
    Lanes(const Source& source, CcdResult* results, int n, Index&& index) : queries(source.template begin_pack<P>()) {
        for (int i = 0; i < P::kWidth; ++i) {
            const long k = index(i < n ? i : 0);
            source.set(queries, i, k);
            result[i] = results + k;
            active |= i < n ? 1u << i : 0u;
        }
    }
};

template <CcdKind kKind, class P, class Source>
inline void begin_pack(const Lanes<P, Source>& lanes, const Wanted& wanted, double separation, int first,
                       Survivors& left) {
    Progress<P> state{P::all(0), P::all(separation)};
    const unsigned rest = begin(load<kKind>(lanes.queries), wanted, state, lanes.active, lanes.result);
    if (rest == 0) return;
    double t[P::kWidth], s[P::kWidth];
    state.t.store(t);
    state.separation.store(s);
    for (int i = 0; i < P::kWidth; ++i) {
        if (((rest >> i) & 1u) == 0) continue;
        left.query[left.count] = first + i;
        left.t[left.count] = t[i];
        left.separation[left.count++] = s[i];
    }
}

/// At most kBlock queries, P::kWidth at a time: one iteration for everybody (that settles nearly all misses), then the
/// survivors packed together until they are done. A lane's arithmetic never depends on its neighbours. Flattened: a
/// pack handed to a function travels through memory (a sixth of the time).
template <CcdKind kKind, class P, class Source>
[[gnu::flatten]] inline void run_block(const Source& source, int count, double separation, const Wanted& wanted,
                                       CcdResult* results) {
    Survivors left;
    int first = 0;
    for (; first + P::kWidth <= count; first += P::kWidth)
        begin_pack<kKind, P, Source>({source.from(first), results + first, P::kWidth, [](int i) { return i; }}, wanted,
                                     separation, first, left);
    if (first < count)
        begin_pack<kKind, P, Source>({source.from(first), results + first, count - first, [](int i) { return i; }},
                                     wanted, separation, first, left);
    for (int i = 0; i < left.count; i += P::kWidth) {
        const int n = left.count - i < P::kWidth ? left.count - i : P::kWidth;
        double t[P::kWidth], s[P::kWidth];
        for (int lane = 0; lane < P::kWidth; ++lane) {
            t[lane] = left.t[i + (lane < n ? lane : 0)];
            s[lane] = left.separation[i + (lane < n ? lane : 0)];
        }
        Progress<P> state{P::load(t), P::load(s)};
        const Lanes<P, Source> lanes(source, results, n, [&](int lane) { return left.query[i + lane]; });
        go_on(load<kKind>(lanes.queries), wanted, state, lanes.active, lanes.result);
    }
}

template <CcdKind kKind, class P, class Source>
inline void run_blocks(const Source& source, long count, double separation, const Wanted& wanted, CcdResult* results) {
    for (long first = 0; first < count; first += kBlock)
        run_block<kKind, P>(source.from(first), static_cast<int>(count - first < kBlock ? count - first : kBlock),
                            separation, wanted, results + first);
}

template <class P, class Source>
inline void run_batch(CcdKind kind, const Source& source, long count, double separation, const Wanted& wanted,
                      CcdResult* results) {
    if (kind == CcdKind::vertex_face)
        run_blocks<CcdKind::vertex_face, P>(source, count, separation, wanted, results);
    else
        run_blocks<CcdKind::edge_edge, P>(source, count, separation, wanted, results);
}
template <class P, class Source>
inline void run_batch(CcdKind kind, const Source& source, long count, const CcdOptions& options, CcdResult* results) {
    run_batch<P>(kind, source, count, options.separation, {.relaxed = options.start == CcdStart::relaxed}, results);
}
template <class P, class Source>
inline void run_hits(CcdKind kind, const Source& source, long count, const CcdHitOptions& options, CcdResult* results) {
    run_batch<P>(kind, source, count, options.separation,
                 {.relaxed = options.start == CcdStart::relaxed, .only_hits = true, .latest = options.latest}, results);
}

} // namespace
} // namespace flotilla
