// SPDX-License-Identifier: MIT
#include "scene/household_meshes.hpp"

#include "base/assert.hpp"
#include "mesh/building.hpp"
#include "mesh/primitives.hpp"

namespace flotilla::library {
namespace {

void append(TriangleMesh& mesh, const TriangleMesh& part, const Vec3& offset) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (const Vec3& v : part.vertices) mesh.vertices.push_back(v + offset);
    for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

/// Rings of equally many vertices, one after the other, joined to a tube.
void join_rings(TriangleMesh& mesh, std::int32_t first, std::int32_t second, int segments) {
    for (int i = 0; i < segments; ++i) {
        const int next = (i + 1) % segments;
        add_quad(mesh, first + i, first + next, second + next, second + i);
    }
}

} // namespace

TriangleMesh revolve(const std::vector<OutlinePoint>& outline, int segments) {
    FLOTILLA_ASSERT(outline.size() >= 2 && segments >= 3);
    TriangleMesh mesh;
    std::vector<std::int32_t> first;
    for (const auto& [r, z] : outline) {
        first.push_back(static_cast<std::int32_t>(mesh.vertices.size()));
        for (int i = 0; i < (r > 0 ? segments : 1); ++i) {
            const auto [s, c] = fraction_of_turn(i, segments);
            add_vertex(mesh, {r * c, r * s, z});
        }
    }
    for (std::size_t k = 0; k + 1 < outline.size(); ++k) {
        const std::int32_t a = first[k], b = first[k + 1];
        const bool from_axis = outline[k].u == 0, to_axis = outline[k + 1].u == 0;
        FLOTILLA_ASSERT(!(from_axis && to_axis));
        if (!from_axis && !to_axis) join_rings(mesh, a, b, segments);
        for (int i = 0; i < segments && (from_axis || to_axis); ++i) {
            const int next = (i + 1) % segments;
            mesh.triangles.push_back(from_axis ? Triangle{a, b + next, b + i} : Triangle{a + i, a + next, b});
        }
    }
    return mesh;
}

TriangleMesh extrude(const std::vector<OutlinePoint>& outer, const std::vector<OutlinePoint>& inner, double height) {
    FLOTILLA_ASSERT(outer.size() == inner.size() && outer.size() >= 3 && height > 0);
    const auto n = static_cast<int>(outer.size());
    TriangleMesh mesh;
    for (const auto* outline : {&outer, &inner})
        for (const double z : {-height / 2, height / 2})
            for (const auto& [x, y] : *outline) add_vertex(mesh, {x, y, z});
    const std::int32_t outer_low = 0, outer_high = n, inner_low = 2 * n, inner_high = 3 * n;
    join_rings(mesh, outer_low, outer_high, n);
    join_rings(mesh, outer_high, inner_high, n);
    join_rings(mesh, inner_high, inner_low, n);
    join_rings(mesh, inner_low, outer_low, n);
    return mesh;
}

TriangleMesh sweep(const std::vector<OutlinePoint>& path, double radius, int sides) {
    FLOTILLA_ASSERT(path.size() >= 2 && radius > 0 && sides >= 3);
    const auto at = [&](std::size_t k) { return Vec3{path[k].u, 0, path[k].v}; };
    const std::size_t last = path.size() - 1;
    TriangleMesh mesh;
    for (std::size_t k = 0; k <= last; ++k) {
        const Vec3 along = normalized(at(k < last ? k + 1 : last) - at(k > 0 ? k - 1 : 0));
        const Vec3 across{0, 1, 0}, out = cross(across, along);
        for (int i = 0; i < sides; ++i) {
            const auto [s, c] = fraction_of_turn(i, sides);
            add_vertex(mesh, at(k) + radius * (s * across + c * out));
        }
    }
    for (std::size_t k = 0; k < last; ++k)
        join_rings(mesh, static_cast<std::int32_t>(k) * sides, static_cast<std::int32_t>(k + 1) * sides, sides);
    const std::int32_t start = add_vertex(mesh, at(0)), end = add_vertex(mesh, at(last));
    const std::int32_t last_ring = static_cast<std::int32_t>(last) * sides;
    for (int i = 0; i < sides; ++i) {
        const int next = (i + 1) % sides;
        mesh.triangles.push_back({start, next, i});
        mesh.triangles.push_back({end, last_ring + i, last_ring + next});
    }
    return mesh;
}

TriangleMesh mug_mesh() {
    constexpr double kRadius = 0.045, kHeight = 0.1, kHandle = 0.03, kTube = 0.006; // m
    constexpr int kHandleParts = 8;
    // From above the opening down the wall to the foot: facing inwards and up, as bowls do.
    TriangleMesh mug = revolve({{kRadius, kHeight}, {kRadius, kHeight / 2}, {kRadius, 0}, {0, 0}}, 20);
    std::vector<OutlinePoint> path; // half a circle from wall to wall
    for (int i = 0; i <= kHandleParts; ++i) {
        const auto [s, c] = fraction_of_turn(i, 2 * kHandleParts);
        path.push_back({kRadius + kHandle * s, kHeight / 2 - kHandle * c});
    }
    append(mug, sweep(path, kTube, 6), {});
    return mug;
}

TriangleMesh soup_bowl_mesh() { return revolve({{0.09, 0.07}, {0.083, 0.043}, {0.067, 0.02}, {0.04, 0}, {0, 0}}, 24); }

TriangleMesh dinner_plate_mesh() { return revolve({{0.13, 0.02}, {0.095, 0.012}, {0.08, 0}, {0, 0}}, 24); }

TriangleMesh stool_mesh() {
    constexpr double kSeat = 0.14, kThickness = 0.025, kHeight = 0.3, kLeg = 0.014; // m
    constexpr double kLegTop = 0.09, kLegFoot = 0.13;                               // m from the axis
    constexpr double kLegHeight = kHeight - kThickness;
    TriangleMesh stool;
    append(stool, make_cylinder(kSeat, kThickness, 24), {0, 0, kHeight - kThickness / 2});
    for (int leg = 0; leg < 3; ++leg) {
        const auto [s, c] = fraction_of_turn(leg, 3);
        TriangleMesh upright = make_cylinder(kLeg, kLegHeight, 8);
        // Sheared, not turned, so that its ends lie flat on the floor and under the seat.
        for (Vec3& v : upright.vertices) {
            const double share = v.z / kLegHeight + 0.5, away = (1 - share) * kLegFoot + share * kLegTop;
            v += Vec3{away * c, away * s, 0};
        }
        append(stool, upright, {0, 0, kLegHeight / 2});
    }
    return stool;
}

TriangleMesh pallet_mesh() {
    constexpr double kLength = 0.4, kWidth = 0.3, kBoard = 0.048, kThickness = 0.012; // m
    constexpr double kBearer = 0.04, kBearerHeight = 0.046;
    TriangleMesh pallet;
    // Boards of one layer, across the bearers, evenly from edge to edge.
    const auto add_boards = [&](int count, double z) {
        for (int i = 0; i < count; ++i)
            append(pallet, make_box(kLength, kBoard, kThickness),
                   {0, (kWidth - kBoard) * (1.0 * i / (count - 1) - 0.5), z});
    };
    add_boards(3, -(kBearerHeight + kThickness) / 2);
    for (int i = -1; i <= 1; ++i)
        append(pallet, make_box(kBearer, kWidth, kBearerHeight), {i * (kLength - kBearer) / 2, 0, 0});
    add_boards(5, (kBearerHeight + kThickness) / 2);
    return pallet;
}

TriangleMesh gear_mesh() {
    constexpr double kRoot = 0.072, kTip = 0.09, kBore = 0.025, kThickness = 0.03; // m
    constexpr int kTeeth = 10;
    // Of each tooth: root, flank up, tip, flank down; places in parts of its pitch.
    constexpr struct { double radius, place; } kTooth[] = {{kRoot, 0}, {kRoot, 0.3}, {kTip, 0.45}, {kTip, 0.85}};
    std::vector<OutlinePoint> outer, bore;
    for (int tooth = 0; tooth < kTeeth; ++tooth)
        for (const auto& [radius, place] : kTooth) {
            const auto [s, c] = fraction_of_turn(tooth + place, kTeeth);
            outer.push_back({radius * c, radius * s});
            bore.push_back({kBore * c, kBore * s});
        }
    return extrude(outer, bore, kThickness);
}

} // namespace flotilla::library
