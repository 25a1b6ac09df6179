// SPDX-License-Identifier: MIT
#include "proximity/contact_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "scene/scene.hpp"
#include "state/build_model.hpp"

namespace flotilla {
namespace {

constexpr double kProximity = 0.02; // m
const double kAngleCos = std::cos(3 * std::numbers::pi / 180);

struct Placed {
    TriangleMesh mesh;
    Vec3 position;
    Quat rotation{};
};

SceneDescription scene_of(const Placed& a, const Placed& b) {
    SceneDescription scene;
    for (const Placed* p : {&a, &b}) {
        ShapeDescription shape;
        shape.name = std::to_string(scene.shapes.size());
        shape.vertices = p->mesh.vertices;
        shape.triangles = p->mesh.triangles;
        shape.mass_kind = MassKind::mass;
        shape.mass_value = 1;
        BodyDescription body;
        body.name = shape.name;
        body.shape = static_cast<std::int32_t>(scene.shapes.size());
        body.position = p->position;
        body.rotation = p->rotation;
        scene.shapes.push_back(shape);
        scene.bodies.push_back(body);
    }
    return scene;
}

/// Both bodies at rest where they are placed.
struct Pair {
    Scene scene;
    Model model;
    Trajectories trajectories;

    Pair(const Placed& a, const Placed& b) : scene(build_scene(scene_of(a, b))), model(make_model(scene)) {
        trajectories.start(model, initial_state(scene, model).pose);
    }
};

std::vector<ProximityPoint> contact_points(const Placed& a, const Placed& b) {
    const Pair pair(a, b);
    ProximityScratch scratch;
    std::vector<ProximityPoint> points;
    (void)find_contact_points(pair.trajectories.at_start(0), pair.trajectories.at_start(1), kProximity, kAngleCos, {},
                              scratch, points);
    for (const ProximityPoint& p : points) {
        EXPECT_NEAR(p.distance, dot(p.normal, p.b - p.a), 1e-15);
        EXPECT_GE(dot(p.normal, normalized(p.b - p.a)), kAngleCos);
        EXPECT_LT(p.distance, kProximity);
    }
    return points;
}

int count_along(const std::vector<ProximityPoint>& points, const Vec3& direction) {
    int n = 0;
    for (const ProximityPoint& p : points) n += dot(p.normal, direction) > kAngleCos ? 1 : 0;
    return n;
}

TEST(ContactPoints, ABoxOnTheGroundHasItsCorners) {
    const auto points = contact_points({make_box(1, 1, 1), {2, -2, 0.51}}, {make_plate(10, 10), {}});
    ASSERT_EQ(points.size(), 4u);
    EXPECT_EQ(count_along(points, {0, 0, -1}), 4);
    for (const ProximityPoint& p : points) EXPECT_NEAR(p.distance, 0.01, 1e-12);
}

TEST(ContactPoints, FlatFacesOfManyTrianglesTouchAsOne) {
    for (const double turn : {0.0, 0.4}) {
        const Placed box{make_box(1, 1.2, 1), {0.203, 0.311, 0.51}, rotation_from_vector({0, 0, turn})};
        const Placed divided{make_box(1, 1.2, 1, 3), box.position, box.rotation};
        const auto due = contact_points(box, {make_plate(8, 8), {}});
        ASSERT_EQ(due.size(), 4u);
        const auto points = contact_points(box, {make_plate(8, 8, 25, 31), {}});
        ASSERT_EQ(points.size(), 4u);
        for (std::size_t i = 0; i < due.size(); ++i) EXPECT_NEAR(length(points[i].a - due[i].a), 0, 1e-12);
        EXPECT_EQ(contact_points(divided, {make_plate(8, 8, 25, 31), {}}).size(), 4u + 4 * 2); // its rim has vertices
    }
    // Every corner over the other's face or rim, and each side across one or two of the other's.
    const Placed upper{make_cylinder(1, 0.2, 96), {0.001, 0.0003, 0.21}}, lower{make_cylinder(1, 0.2, 96), {}};
    const auto discs = contact_points(upper, lower);
    EXPECT_GE(discs.size(), 96u);
    EXPECT_LE(discs.size(), 4 * 96u);
}

TEST(ContactPoints, ASlidingBoxDoesNotCatchOnSideFaces) {
    // Figure 11: the lower corner of the upper box hangs over, 5 mm from the side of the lower box and 10 mm above its
    // top.
    const auto points = contact_points({make_box(1, 1, 1), {0.005, 0.1, 1.01}}, {make_box(1, 1, 1), {}});
    EXPECT_GE(points.size(), 4u);
    EXPECT_EQ(count_along(points, {0, 0, -1}), static_cast<int>(points.size()));
}

/// Two plates that meet at a right angle, open upwards; along y.
TriangleMesh groove() {
    return {{{0, -1, 0}, {0, 1, 0}, {-1, -1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, 1}},
            {{0, 1, 3}, {0, 3, 2}, {0, 4, 5}, {0, 5, 1}}};
}

TEST(ContactPoints, AVertexInAGrooveHasBothWalls) {
    // A corner 8 mm from one wall and 9 mm from the other.
    const Vec3 left = normalized(Vec3{1, 0, 1}), right = normalized(Vec3{-1, 0, 1});
    const TriangleMesh spike{{{0, 0, 0}, {0.1, 0.1, 1}, {-0.1, 0.1, 1}, {0, -0.1, 1}},
                             {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}};
    const Vec3 place = 0.008 * left + 0.009 * right + Vec3{0, 0.3, 0};
    for (const bool first : {true, false}) {
        const auto points =
            first ? contact_points({spike, place}, {groove(), {}}) : contact_points({groove(), {}}, {spike, place});
        ASSERT_EQ(points.size(), 2u);
        const double sign = first ? -1 : 1;
        EXPECT_EQ(count_along(points, sign * left), 1);
        EXPECT_EQ(count_along(points, sign * right), 1);
    }
}

// Of a vertex above the right wall of a shallow groove, the left wall's nearest point is the bottom, 11 degrees from
// the right wall's.
TEST(ContactPoints, AVertexBesideTheBottomOfAShallowGrooveHasTheBottomAsWell) {
    constexpr double kSlope = 0.04, kHeight = 0.01; // m a m, m
    const TriangleMesh shallow{{{0, -1, 0}, {0, 1, 0}, {1, 0, kSlope}, {-1, 0, kSlope}}, {{0, 2, 1}, {0, 1, 3}}};
    const TriangleMesh spike{{{0, 0, 0}, {0.1, 0.1, 1}, {-0.1, 0.1, 1}, {0, -0.1, 1}},
                             {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}};
    const auto points_at = [&](double aside) {
        return contact_points({shallow, {}}, {spike, {aside, 0.1, kHeight + kSlope * aside}});
    };
    const auto beside = points_at(0.0015);
    ASSERT_EQ(beside.size(), 2u);
    EXPECT_LT(dot(beside[0].normal, beside[1].normal), kAngleCos);
    EXPECT_EQ(points_at(0.015).size(), 1u); // far up the wall the bottom is another side
}

TEST(ContactPoints, AnEdgeInANotchHasBothSides) {
    // The blade's lower edge crosses the two edges of a notch in a plate, 8 mm from the one and 9 mm from the other.
    const Vec3 left = normalized(Vec3{1, 0, 1}), right = normalized(Vec3{-1, 0, 1});
    const TriangleMesh notch{{{0, 0, 0}, {-1, 0, 1}, {1, 0, 1}, {-1, 0, -1}, {1, 0, -1}},
                             {{0, 1, 3}, {0, 3, 4}, {0, 4, 2}}};
    const TriangleMesh blade{{{0, -1, 0}, {0, 1, 0}, {0, -1, 0.5}, {0, 1, 0.5}}, {{0, 1, 3}, {0, 3, 2}}};
    const auto points = contact_points({blade, 0.008 * left + 0.009 * right}, {notch, {}});
    EXPECT_EQ(count_along(points, -1.0 * left), 1);
    EXPECT_EQ(count_along(points, -1.0 * right), 1);
    EXPECT_EQ(points.size(), 2u);
}

// A cube on its edge, tilted by 20 degrees: two corners are at the ground, two above it.
TEST(ContactPoints, WhatATiltedBoxPassesIsWhatItsWaysLeadTo) {
    constexpr double kRest = 0.01, kTilt = 20 * std::numbers::pi / 180;
    const double center = kRest + 0.5 * (std::cos(kTilt) + std::sin(kTilt));
    const Placed box{make_box(1, 1, 1), {2, -2, center}, rotation_from_vector({0, kTilt, 0})};
    const Placed ground{make_plate(10, 10), {}};
    EXPECT_EQ(contact_points(box, ground).size(), 2u);
    const Pair pair(box, ground);
    const auto passing = [&](const Vec3& way, const Vec3& turn) {
        ProximityScratch scratch;
        std::vector<ProximityPoint> points;
        find_passing_points(pair.trajectories.at_start(0), pair.trajectories.at_start(1),
                            {{{2, -2, center}, way, turn}, {}, (1 - 1e-9) * kRest}, 1, std::cos(1.0), scratch, points);
        return points;
    };
    EXPECT_TRUE(passing({}, {}).empty());
    EXPECT_TRUE(passing({0, 0, 0.1}, {}).empty());
    EXPECT_TRUE(passing({5, 0, 0}, {}).empty()) << "slides";
    EXPECT_EQ(passing({0, 0, -0.1}, {}).size(), 2u) << "the corners that are there";
    EXPECT_EQ(passing({0, 0, -0.5}, {}).size(), 4u);
    const auto high = passing({0, 0, 0.05}, {0, -0.9, 0});
    ASSERT_EQ(high.size(), 2u) << "those that come down as it turns on";
    for (const ProximityPoint& p : high) EXPECT_NEAR(p.distance, kRest + std::sin(kTilt), 1e-12);
}

// A cube over one of its size, aside by a share of its gap on both axes. Up to 3 degrees their corners touch the other
// one's side, beyond they touch nothing: those that are within it do.
TEST(ContactPoints, CornerAHairOutsideASideTouchesTheSide) {
    constexpr double kGap = 0.005;
    const Vec3 up{0, 0, 1};
    const auto on_cube = [&](double aside, const Quat& turn = {}) {
        return contact_points({make_box(1, 1, 1), {}}, {make_box(1, 1, 1), {aside, aside, 1 + kGap}, turn});
    };
    for (const double share : {0.0, 1e-9, 1e-3, 0.035, 0.1}) {
        const auto points = on_cube(share * kGap);
        ASSERT_GE(points.size(), 2u) << share;
        for (const ProximityPoint& p : points) EXPECT_LT(length(p.normal - up), 1e-12) << share;
    }
    for (const ProximityPoint& p : on_cube(0, rotation_from_vector({0, 0, 3e-5})))
        EXPECT_LT(length(p.normal - up), 1e-12);
}

// Corner over corner: a corner of each body, and edges of both that cross there, would be up to three contacts, by the
// last bits of the poses. A corner apart by more than what solves keep distances to stays a contact.
TEST(ContactPoints, CornersAtOnePlaceAreOneContact) {
    constexpr double kGap = 0.005;
    const auto on_cube = [&](double x, double y, const Quat& turn = {}) {
        return contact_points({make_box(1, 1, 1), {}}, {make_box(1, 1, 1), {x, y, 1 + kGap}, turn});
    };
    for (const double hair : {0.0, 1e-16, 1e-12, 1e-9, 1e-6})
        for (const double x : {-hair, hair})
            for (const double y : {-hair, hair})
                for (const double turn : {-hair, 0.0, hair}) {
                    const auto points = on_cube(x, y, rotation_from_vector({0, 0, turn}));
                    ASSERT_EQ(points.size(), 4u) << x << " " << y << " " << turn;
                    for (const Vec3 corner :
                         {Vec3{-0.5, -0.5, 0.5}, {-0.5, 0.5, 0.5}, {0.5, -0.5, 0.5}, {0.5, 0.5, 0.5}})
                        EXPECT_EQ(std::count_if(points.begin(), points.end(),
                                                [&](const auto& p) { return length(p.a - corner) < 1e-5; }),
                                  1);
                }
    EXPECT_EQ(on_cube(1e-3, 1e-3).size(), 4u); // the overlap's corners: one of each body, and two of crossing edges
    EXPECT_EQ(on_cube(0, 0, rotation_from_vector({0, 0, 0.1})).size(), 8u); // all edges cross
}

// Tips of cones have no flat side, and a corner a hair beside one is seen along a tilted line: what stays at the place
// is the tip on the corner's flat side, whichever body comes first.
TEST(ContactPoints, OfAPlaceTheContactOnAFlatSideStays) {
    const TriangleMesh cone{{{0, 0, 0}, {0.1, 0, -0.01}, {0, 0.1, -0.01}, {-0.1, 0, -0.01}, {0, -0.1, -0.01}},
                            {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {1, 3, 2}, {1, 4, 3}}};
    for (const double hair : {1e-9, 2e-7, 3e-6}) { // the tip inside of the plate's corner by that
        const Placed tip{cone, {}}, plate{make_box(1, 1, 0.1), {0.5 - hair, 0.5 - hair, 0.055}};
        for (const bool tip_first : {true, false}) {
            const auto points = tip_first ? contact_points(tip, plate) : contact_points(plate, tip);
            ASSERT_EQ(points.size(), 1u) << hair << tip_first;
            EXPECT_LT(length(points[0].normal - Vec3{0, 0, tip_first ? 1.0 : -1.0}), 1e-14) << hair << tip_first;
        }
    }
}

// A corner beside the seam of two triangles of one plane sees that seam aside, in a direction in which there is nothing.
TEST(ContactPoints, ACornerBesideASeamOfAFlatFaceHasThatFace) {
    constexpr double kHeight = 0.01;
    const TriangleMesh box = make_box(1, 1, 1);
    const Quat turn = rotation_from_vector({0.5, 0.4, 0.3});
    Vec3 lowest{0, 0, 1};
    for (const Vec3& v : box.vertices)
        if (rotate(turn, v).z < lowest.z) lowest = rotate(turn, v);
    for (const double degrees : {6.0, 8.0, 10.0, 12.0, 14.0}) {
        const double aside = kHeight * std::tan(degrees * std::numbers::pi / 180);
        const Vec3 place = Vec3{std::sqrt(2.0) * aside, 0, kHeight} - lowest;
        for (const int cells : {1, 2}) { // the seam is a diagonal through the middle
            const auto points = contact_points({box, place, turn}, {make_plate(10, 10, cells, cells), {}});
            ASSERT_EQ(points.size(), 1u) << degrees << " degrees, " << cells;
            EXPECT_LT(length(points[0].normal - Vec3{0, 0, -1}), 1e-12);
        }
    }
}

// Two sides that meet at a corner are two contacts, though at one place.
TEST(ContactPoints, CornersInOtherDirectionsStay) {
    // A cube in the corner of a floor and a wall, its lower edge's ends at the ends of theirs.
    const TriangleMesh corner{{{0, -0.5, 0}, {0, 0.5, 0}, {1, 0.5, 0}, {1, -0.5, 0}, {0, 0.5, 1}, {0, -0.5, 1}},
                              {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {0, 4, 5}}};
    constexpr double kGap = 1e-6; // so near that points on floor and wall are at one place
    const auto points = contact_points({corner, {}}, {make_box(0.8, 1, 0.8), {0.4 + kGap, 0, 0.4 + kGap}});
    EXPECT_EQ(count_along(points, {0, 0, 1}), 4);
    EXPECT_EQ(count_along(points, {1, 0, 0}), 4);
}

TEST(ContactPoints, RimOfAnOpenPlateIsOneOfASide) {
    const TriangleMesh plate = make_plate(1, 1), cube = make_box(1, 1, 1);
    const auto points = contact_points({plate, {}}, {cube, {1e-4, 1e-4, 0.505}});
    ASSERT_GE(points.size(), 4u);
    for (const ProximityPoint& p : points) EXPECT_LT(length(p.normal - Vec3{0, 0, 1}), 1e-12);
}

// The facets of this disc differ by 11.25 degrees. A corner near the edge between two of them stays off in the direction
// of the points.
TEST(ContactPoints, EdgeBetweenFacetsOfARoundBodyIsNoRim) {
    const TriangleMesh disc = make_cylinder(0.5, 0.2, 32);
    const double facet = std::numbers::pi / 32;
    const Vec3 edge = 0.5 * Vec3{std::cos(2 * facet), std::sin(2 * facet), 0};
    for (const double turn : {0.9 * facet, 0.95 * facet}) {
        const Vec3 way{std::cos(2 * facet + turn), std::sin(2 * facet + turn), 0};
        // A wedge whose corner points at the edge, from a place that sees the one facet 3 degrees or less aside.
        const TriangleMesh wedge{{{0, 0, 0}, {0.1, 0.02, 0.02}, {0.1, -0.02, 0.02}, {0.1, 0, -0.02}},
                                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
        const auto points =
            contact_points({disc, {}}, {wedge, edge + 0.005 * way, rotation_from_vector({0, 0, 2 * facet + turn})});
        ASSERT_EQ(points.size(), 1u);
        EXPECT_LT(length(points[0].normal - normalized(points[0].b - points[0].a)), 1e-12);
        EXPECT_LT(length(points[0].normal - way), 1e-9);
    }
}

// One contact of each corner of two flush cubes is known. Where one has slid so far that a corner is seen along a line
// beyond theta, others carry what it did, and all have to be searched for.
TEST(ContactPoints, OnesThatLeftTheirSideAreSearchedFor) {
    constexpr double kGap = 0.005;
    const auto renewed = [&](double slid) {
        const Pair flush({make_box(1, 1, 1), {}}, {make_box(1, 1, 1), {0, 0, 1 + kGap}});
        const Pair now({make_box(1, 1, 1), {}}, {make_box(1, 1, 1), {slid, slid, 1 + kGap}});
        ProximityScratch scratch;
        std::vector<ProximityPoint> points;
        (void)find_contact_points(flush.trajectories.at_start(0), flush.trajectories.at_start(1), kProximity, kAngleCos,
                                  {}, scratch, points);
        EXPECT_EQ(points.size(), 4u);
        std::vector<FeaturePair> features;
        for (const ProximityPoint& p : points) features.push_back(p.features);
        points.clear();
        double distance = 0;
        const bool all = renew_contact_points(now.trajectories.at_start(0), now.trajectories.at_start(1), kProximity,
                                              kAngleCos, features, distance, points);
        for (const ProximityPoint& p : points) EXPECT_LT(length(p.normal - Vec3{0, 0, 1}), 1e-14) << slid;
        EXPECT_EQ(points.size(), all ? 4u : 0u);
        return all;
    };
    EXPECT_TRUE(renewed(0));
    EXPECT_TRUE(renewed(0.03 * kGap));  // 2.4 degrees
    EXPECT_FALSE(renewed(0.04 * kGap)); // 3.2
    EXPECT_FALSE(renewed(0.15 * kGap));
}

TEST(ContactPoints, OnesThatAreKnownAreFoundAgain) {
    const Placed box{make_box(1, 1, 1), {2, -2, 0.51}, rotation_from_vector({0.003, -0.002, 0.4})};
    const Placed groove_up{groove(), {}},
        bar{make_box(0.2, 1, 0.2), {0.002, 0, 0.158}, rotation_from_vector({0, 0.785, 0})};
    const Placed cube{make_box(1, 1, 1), {}}, flush{make_box(1, 1, 1), {1e-4, -1e-4, 1.005}};
    for (const auto& [a, b] :
         {std::pair(box, Placed{make_plate(10, 10), {}}), std::pair(groove_up, bar), std::pair(cube, flush)}) {
        const Pair pair(a, b);
        const BodyMotion at_a = pair.trajectories.at_start(0), at_b = pair.trajectories.at_start(1);
        ProximityScratch scratch;
        std::vector<ProximityPoint> points, again;
        const ProximityResult found = find_contact_points(at_a, at_b, kProximity, kAngleCos, {}, scratch, points);
        ASSERT_GE(points.size(), 2u);
        std::vector<FeaturePair> features;
        for (const ProximityPoint& p : points) {
            EXPECT_EQ(features_of(feature_key(p.features)), p.features);
            features.insert(features.begin(), p.features);
        }
        double distance = 0;
        ASSERT_TRUE(renew_contact_points(at_a, at_b, kProximity, kAngleCos, features, distance, again));
        EXPECT_EQ(distance, found.distance);
        ASSERT_EQ(again.size(), points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            EXPECT_EQ(again[i].features, points[i].features) << i;
            EXPECT_EQ(again[i].a, points[i].a) << i;
            EXPECT_EQ(again[i].b, points[i].b) << i;
            EXPECT_EQ(again[i].normal, points[i].normal) << i;
            EXPECT_EQ(again[i].distance, points[i].distance) << i;
        }
        EXPECT_FALSE(
            renew_contact_points(at_a, at_b, 0.5 * distance, kAngleCos, features, distance, again)); // beyond its reach
        EXPECT_EQ(again.size(), points.size());
    }
}

} // namespace
} // namespace flotilla
