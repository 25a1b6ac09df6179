// SPDX-License-Identifier: MIT
// One triangle onto a grid. Camera and shadow maps share it: both interpolate a value that is linear on the screen
// (1/depth in perspective, height towards the light in a parallel projection) and keep the largest.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

namespace flotilla::picture {

/// A projected vertex: pixel coordinates (sample i covers i .. i+1, its centre is i + 0.5) and the value to
/// interpolate.
struct ScreenVertex {
    float x, y, value;
};

/// The first and the last sample whose centre lies in [low, high], cut to 0 .. size - 1.
inline int first_sample(double low) { return low > 0 ? static_cast<int>(std::min(low, 1e6) + 0.5) : 0; }
inline int last_sample(double high, int size) {
    return high > 0 ? static_cast<int>(std::min(high, static_cast<double>(size)) + 0.5) - 1 : -1;
}

/// A side of the triangle as x over y. Precondition for use: from.y < to.y.
struct Side {
    double x, y, dx_dy;
    Side(const ScreenVertex& from, const ScreenVertex& to)
        : x(from.x), y(from.y), dx_dy((static_cast<double>(to.x) - from.x) / (static_cast<double>(to.y) - from.y)) {}
    [[nodiscard]] double at(double row) const { return x + (row - y) * dx_dy; }
};

/// Calls put(y, x0, x1, value, slope) for each row of sample centres inside the triangle, whatever its winding: samples
/// x0 to x1 have value + slope * (x - x0). Sides belong to both of their triangles (by a sliver of 1e-4 samples), so
/// that a surface has no cracks. Precondition: finite coordinates.
template <class Put>
void rasterize(ScreenVertex a, ScreenVertex b, ScreenVertex c, int width, int height, Put&& put) {
    if (b.y < a.y) std::swap(a, b);
    if (c.y < a.y) std::swap(a, c);
    if (c.y < b.y) std::swap(b, c);
    const int top = first_sample(a.y), middle = std::min(first_sample(b.y), height), end = last_sample(c.y, height);
    if (top > end) return;
    const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
    const double area = bx * cy - by * cx;
    if (!(std::abs(area) > 1e-12)) return; // edge-on
    const double inv = 1 / area, value_b = b.value - a.value, value_c = c.value - a.value;
    const double value_dx = (cy * value_b - by * value_c) * inv, value_dy = (bx * value_c - cx * value_b) * inv;

    const auto rows = [&](int from, int to, const Side& left, const Side& right) {
        constexpr double sliver = 1e-4;
        for (int y = from; y <= to; ++y) {
            const int x0 = first_sample(left.at(y + 0.5) - sliver);
            const int x1 = last_sample(right.at(y + 0.5) + sliver, width);
            if (x0 > x1) continue;
            put(y, x0, x1, static_cast<float>(a.value + (x0 + 0.5 - a.x) * value_dx + (y + 0.5 - a.y) * value_dy),
                static_cast<float>(value_dx));
        }
    };
    const Side whole(a, c); // the one side that spans all rows; the other two lie to its right if the area is positive
    if (top < middle) {
        const Side upper(a, b);
        if (area > 0)
            rows(top, middle - 1, whole, upper);
        else
            rows(top, middle - 1, upper, whole);
    }
    if (middle <= end) {
        const Side lower(b, c);
        if (area > 0)
            rows(middle, end, whole, lower);
        else
            rows(middle, end, lower, whole);
    }
}

} // namespace flotilla::picture
