// SPDX-License-Identifier: MIT
#include "geometry/support.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/float4.hpp"

namespace flotilla {
namespace {

// Coordinates and directions are rounded once (2^-24 of each), products once, sums twice: five roundings of terms that
// sum up to |p| at most, in magnitude. Beyond the limits products overflow, or lose bits below the least normal number.
constexpr double kError = 0x1p-21;
constexpr double kLargest = 0x1p60, kSmallest = 0x1p-60;
constexpr std::size_t kMost = std::size_t{1} << 24; // places are counted in floats

} // namespace

SupportPoints support_points(std::span<const Vec3> points) {
    SupportPoints out;
    double radius = 0;
    for (const Vec3& p : points) radius = std::max(radius, length(p));
    if (!(radius < kLargest) || !(radius > kSmallest) || points.size() > kMost) return out;
    out.error = kError * radius;
    out.fours.resize((points.size() + 3) / 4);
    for (std::size_t i = 0; i < 4 * out.fours.size(); ++i) {
        const Vec3& p = points[std::min(i, points.size() - 1)];
        FourPoints& four = out.fours[i / 4];
        four.x[i % 4] = static_cast<float>(p.x);
        four.y[i % 4] = static_cast<float>(p.y);
        four.z[i % 4] = static_cast<float>(p.z);
    }
    return out;
}

Support reach(const SupportPoints& points, const Vec3& direction) {
    const Float4 dx = both4(static_cast<float>(direction.x)), dy = both4(static_cast<float>(direction.y)),
                 dz = both4(static_cast<float>(direction.z));
    Float4 most = both4(-std::numeric_limits<float>::infinity()), place = both4(0), here = both4(0);
    for (const FourPoints& p : points.fours) {
        const Float4 along = dx * load4(p.x) + dy * load4(p.y) + dz * load4(p.z);
        place = select(along > most, here, place);
        most = larger(along, most);
        here = here + both4(1);
    }
    alignas(16) float reaches[4], places[4];
    store(reaches, most);
    store(places, place);
    const auto lane = static_cast<std::size_t>(std::max_element(reaches, reaches + 4) - reaches);
    return {static_cast<double>(reaches[lane]), 4 * static_cast<std::size_t>(places[lane]) + lane};
}

} // namespace flotilla
