// SPDX-License-Identifier: MIT
#include "proximity/same_place.hpp"

#include <algorithm>
#include <span>

#include "base/index.hpp"

namespace flotilla {
namespace {

/// How near to each other points are at one place, as a share of the distance within which bodies are in contact:
/// solves keep distances to as much (ContactTuning::of_rest).
constexpr double kOnePlace = 1.0 / 2048;

/// A corner of a body, and how far from it is the same place.
class Corner {
  public:
    explicit Corner(double reach) : reach_sq_(reach * reach) {}

    [[nodiscard]] bool one_place(const Vec3& x, const Vec3& y) const { return length_sq(x - y) < reach_sq_; }
    [[nodiscard]] bool of_face(const BodyMotion& body, std::int32_t face, const Vec3& x) const {
        const Triangle& t = body.shape->mesh.triangles[at(face)];
        return std::any_of(t.begin(), t.end(), [&](std::int32_t v) { return one_place(body.at0.x[at(v)], x); });
    }
    [[nodiscard]] bool of_edge(const BodyMotion& body, std::int32_t edge, const Vec3& x) const {
        const Edge& e = body.shape->topology.edges[at(edge)];
        return one_place(body.at0.x[at(e[0])], x) || one_place(body.at0.x[at(e[1])], x);
    }

  private:
    double reach_sq_;
};

} // namespace

std::size_t drop_same_places(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                             std::size_t first, ProximityScratch& scratch, std::vector<ProximityPoint>& points) {
    const Corner corner(kOnePlace * proximity);
    const auto at_corner = [&](const ProximityPoint& p) {
        switch (p.features.kind) {
        case FeatureKind::vertex_face: return corner.of_face(b, p.features.b, p.b);
        case FeatureKind::face_vertex: return corner.of_face(a, p.features.a, p.a);
        case FeatureKind::edge_edge: break;
        }
        return corner.of_edge(a, p.features.a, p.a) || corner.of_edge(b, p.features.b, p.b);
    };
    const std::span<ProximityPoint> found = std::span(points).subspan(first);
    auto& repeats = scratch.repeats;
    repeats.assign(found.size(), 0);
    for (std::size_t i = 0; i < found.size(); ++i) {
        const ProximityPoint& p = found[i];
        if (!at_corner(p)) continue;
        for (std::size_t k = 0; k < found.size() && repeats[i] == 0; ++k) {
            const ProximityPoint& q = found[k];
            if (!q.flat || (p.flat && k >= i)) continue;
            repeats[i] =
                corner.one_place(q.a, p.a) && corner.one_place(q.b, p.b) && dot(q.normal, p.normal) >= angle_cos;
        }
    }
    std::size_t end = first;
    for (std::size_t i = 0; i < found.size(); ++i)
        if (repeats[i] == 0) points[end++] = found[i];
    const std::size_t dropped = points.size() - end;
    points.resize(end);
    return dropped;
}

} // namespace flotilla
