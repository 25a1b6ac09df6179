// SPDX-License-Identifier: MIT
// What of a body lies on a plane.
#pragma once

#include <vector>

#include "geometry/box.hpp"

namespace flotilla {

struct Segment {
    Vec3 p, q;

    [[nodiscard]] Box box() const { return {min(p, q), max(p, q)}; }
};

/// What of a body lies on the plane of a hit: vertices, and edges.
struct Footprint {
    std::vector<Vec3> feet;
    std::vector<Segment> rim;

    void clear() {
        feet.clear();
        rim.clear();
    }
};

} // namespace flotilla
