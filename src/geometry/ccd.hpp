// SPDX-License-Identifier: MIT
// Continuous collision detection of moving features with a minimum separation.
//
// A query is a vertex and a triangle (v, f0, f1, f2) or two edges (a0, a1, b0, b1); every point moves on a straight
// line from x0 at t = 0 to x1 at t = 1. The answer "no hit" is a proof: the features stay farther apart than the
// separation at every t in [0, 1], in exact arithmetic on the doubles given. Everything doubtful is a hit.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/vec3.hpp"

namespace flotilla {

enum class CcdKind : std::uint8_t { vertex_face, edge_edge };

struct CcdQuery {
    std::array<Vec3, 4> x0, x1; ///< m; vertex_face: v f0 f1 f2, edge_edge: a0 a1 b0 b1
};

struct CcdResult {
    /// Last separating direction, from the second feature to the first, about unit length; zero if none was found.
    Vec3 direction;
    double toi = 1; ///< [0, 1]: the features are proved apart on [0, toi]; 1 where there is no hit
    bool hit = true;
    std::uint16_t iterations = 0; ///< closest-point evaluations
};

/// What a query does when the features start closer than the separation.
enum class CcdStart : std::uint8_t {
    strict,  ///< a hit at t = 0
    relaxed, ///< the separation of this query becomes kKeptShare of the start distance, unless that is below the floor
};

struct CcdOptions {
    double separation = 0; ///< m, >= 0
    CcdStart start = CcdStart::strict;
};

[[nodiscard]] CcdResult ccd(CcdKind kind, const CcdQuery& query, const CcdOptions& options);

/// Does `direction` (from the second feature to the first, any length) alone prove the features farther apart than
/// `separation` during the whole motion? A query costs a fifth of ccd(); false proves nothing. Directions kept from
/// earlier answers are good witnesses for slow pairs.
[[nodiscard]] bool certified_along(CcdKind kind, const CcdQuery& query, const Vec3& direction, double separation);

/// Rounding allowance of a query whose largest coordinate difference between the features is w (metres): distances are
/// certified against separation + ccd_error(w).
[[nodiscard]] double ccd_error(double w);

/// The floor, m: of features nearer than that no motion is certified but one that opens the gap, so that gaps cannot
/// creep to zero, step by step (kKeptShare), where rounding would no longer tell them from none.
[[nodiscard]] double ccd_floor(double w);
inline constexpr double kFloorPerError = 16; ///< of ccd_error()

/// The share of its start distance that a motion must keep which starts closer than the separation: less than all of
/// it, or features that slide past each other would hit by rounding.
inline constexpr double kKeptShare = 0.95;

/// A hit is reported within this share of the separation above it, or where that is less within what rounding needs: a
/// query need not approach it to the bit.
inline constexpr double kSlackOfSeparation = 0x1p-7;

/// Instruction sets of the wide kernels. All of them, and the scalar code, give the same bits.
enum class Isa : std::uint8_t { scalar, avx2, avx512 };
/// The widest instruction set that this processor has, or what the variable FLOTILLA_SIMD allows: scalar, avx2 or
/// avx512. Looked up once.
[[nodiscard]] Isa best_isa();

/// results[i] = ccd(kind, queries[i], options), several queries at a time. Sizes must agree.
void ccd_batch(CcdKind kind, std::span<const CcdQuery> queries, const CcdOptions& options, std::span<CcdResult> results,
               Isa isa);

/// Where the corners of many queries stand: those of the first feature and those of the second, at t = 0 and t = 1, m.
struct CcdPoints {
    const Vec3 *first0, *first1, *second0, *second1;
};
/// A query by the places of its corners in these arrays, in the order of CcdQuery.
using CcdCorners = std::array<std::int32_t, 4>;
[[nodiscard]] CcdQuery ccd_query(CcdKind kind, const CcdPoints& points, const CcdCorners& corners);

/// The same for queries by their corners: nothing is copied.
void ccd_batch(CcdKind kind, const CcdPoints& points, std::span<const CcdCorners> corners, const CcdOptions& options,
               std::span<CcdResult> results, Isa isa);

} // namespace flotilla
