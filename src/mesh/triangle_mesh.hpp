// SPDX-License-Identifier: MIT
// Triangle soup: open, non-manifold and degenerate surfaces are all valid. An element with an index twice is a segment,
// one with an index thrice a point: nets and clouds go through collision, contact and audit as the triangles without
// area that they are.
#pragma once

#include <algorithm>
#include <vector>

#include <flotilla/types.hpp>

namespace flotilla {

struct TriangleMesh {
    std::vector<Vec3> vertices;      ///< m, finite
    std::vector<Triangle> triangles; ///< indices into vertices
};

enum class ElementKind : std::uint8_t { point, segment, triangle }; ///< value: its dimension
inline ElementKind element_of(const Triangle& t) {
    if (t[0] == t[1] && t[1] == t[2]) return ElementKind::point;
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0] ? ElementKind::segment : ElementKind::triangle;
}
/// The vertices of a segment, in the order given.
inline std::array<std::int32_t, 2> segment_ends(const Triangle& t) { return {t[0], t[0] == t[1] ? t[2] : t[1]}; }
/// The highest dimension among the elements; a point where there is none.
inline ElementKind highest_element(const std::vector<Triangle>& triangles) {
    ElementKind highest = ElementKind::point;
    for (const Triangle& t : triangles) highest = std::max(highest, element_of(t));
    return highest;
}

} // namespace flotilla
