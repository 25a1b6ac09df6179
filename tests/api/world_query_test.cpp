// SPDX-License-Identifier: MIT
// What a World answers about its bodies, against geometry known beforehand.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <flotilla/scene_library.hpp>
#include <flotilla/world.hpp>

#include "base/rotation.hpp"
#include "mesh/primitives.hpp"
#include "step/scene_parts.hpp"
#include "support/random.hpp"

namespace flotilla::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A floor at z = 0; a crate of 1 m and 2 kg on it at the origin, and one at x = 3; sleeping off.
SceneDescription two_crates() {
    SceneDescription scene = scenario::empty_scene();
    const std::int32_t crate = scenario::add_shape(scene, make_box(1, 1, 1), 2),
                       floor = scenario::add_shape(scene, make_plate(40, 40));
    scenario::add_body(scene, floor, BodyType::fixed, {}).name = "floor";
    scenario::add_body(scene, crate, BodyType::dynamic, {0, 0, 0.505}).name = "near";
    scenario::add_body(scene, crate, BodyType::dynamic, {3, 0, 0.505}).name = "far";
    return scene;
}

std::vector<std::string> names(const World& world, const std::vector<BodyId>& bodies) {
    std::vector<std::string> out;
    for (const BodyId body : bodies) out.push_back(world.name(body));
    return out;
}

TEST(WorldQuery, RaysStopAtTheFirstSurface) {
    World world(two_crates());
    const auto hit = world.ray({-5, 0.1, 0.4}, {2, 0, 0}, 100);
    ASSERT_TRUE(hit);
    EXPECT_EQ(world.name(hit->body), "near");
    EXPECT_NEAR(hit->distance, 4.5, 1e-12);
    EXPECT_NEAR(length(hit->point - Vec3{-0.5, 0.1, 0.4}), 0, 1e-12);
    EXPECT_EQ(hit->normal, (Vec3{-1, 0, 0}));
    EXPECT_FALSE(world.ray({-5, 0.1, 0.4}, {2, 0, 0}, 4.4)) << "out of reach";
    EXPECT_FALSE(world.ray({-5, 0.1, 0.4}, {-1, 0, 0}, 100));
    const auto down = world.ray({1.5, 0.1, 7}, {0, 0, -1}, 100);
    ASSERT_TRUE(down);
    EXPECT_EQ(world.name(down->body), "floor");
    EXPECT_NEAR(down->distance, 7, 1e-12);
    EXPECT_EQ(down->normal, (Vec3{0, 0, 1})) << "against the ray, whichever side that is";
    EXPECT_THROW((void)world.ray({}, {}, 1), InputError);
    EXPECT_THROW((void)world.ray({std::nan(""), 0, 0}, {1, 0, 0}, 1), InputError);
    EXPECT_THROW((void)world.ray({}, {1, 0, 0}, -1), InputError);
}

TEST(WorldQuery, RaysFindWhatEveryTriangleByItselfWould) {
    SceneDescription scene = scenario::empty_scene();
    const std::int32_t ring = scenario::add_shape(scene, make_ring(1, 0.3, 24, 12), 1);
    Random random(4);
    for (int k = 0; k < 8; ++k)
        scenario::add_body(scene, ring, BodyType::dynamic, {3.0 * k, 0, 0}).rotation = random.rotation();
    World world(scene);
    int hits = 0;
    for (int k = 0; k < 400; ++k) {
        const Vec3 from = Vec3{10, 0, 0} + random.vec(14), to{3.0 * static_cast<double>(random.below(8)), 0, 0};
        const Vec3 direction = to + random.vec(1.5) - from;
        double nearest = 1e300; // over all triangles, by Moller and Trumbore
        for (std::size_t b = 0; b < world.size(); ++b)
            for (const Triangle& t : scene.shapes[0].triangles) {
                const auto corner = [&](std::size_t c) {
                    return rotate(world.poses()[b].rotation, scene.shapes[0].vertices[static_cast<std::size_t>(t[c])]) +
                           world.poses()[b].origin;
                };
                const Vec3 a = corner(0), e = corner(1) - a, f = corner(2) - a, d = direction / length(direction);
                const Vec3 p = cross(d, f);
                const double det = dot(e, p);
                if (std::abs(det) < 1e-14) continue;
                const Vec3 s = from - a, q = cross(s, e);
                const double u = dot(s, p) / det, v = dot(d, q) / det, at = dot(f, q) / det;
                if (u >= 0 && v >= 0 && u + v <= 1 && at >= 0) nearest = std::min(nearest, at);
            }
        const auto hit = world.ray(from, direction, 1e3);
        ASSERT_EQ(hit.has_value(), nearest < 1e3) << k;
        if (!hit) continue;
        ASSERT_NEAR(hit->distance, nearest, 1e-9) << k;
        ++hits;
    }
    EXPECT_GT(hits, 40);
}

TEST(WorldQuery, ClosestPointsAreThoseOfTheSurfaces) {
    World world(two_crates());
    const BodyId near = world.find("near"), far = world.find("far");
    const ClosestPoints c = world.closest(near, far);
    EXPECT_NEAR(c.distance, 2, 1e-12);
    EXPECT_NEAR(c.point_a.x, 0.5, 1e-12);
    EXPECT_NEAR(c.point_b.x, 2.5, 1e-12);
    EXPECT_NEAR(world.closest(world.find("floor"), far).distance, 0.005, 1e-12);
    EXPECT_THROW((void)world.closest(near, near), InputError);
    world.remove_body(far);
    EXPECT_THROW((void)world.closest(near, far), InputError);
}

TEST(WorldQuery, OverlapsAreThoseThatAddingWouldRefuse) {
    World world(two_crates());
    EXPECT_THAT(names(world, world.overlapping(0, {1.5, 0, 0.3}, {})), ElementsAre("floor"));
    EXPECT_THAT(names(world, world.overlapping(0, {0.9, 0, 0.6}, {})), ElementsAre("near"));
    EXPECT_THAT(names(world, world.overlapping(1, {0, 0, 0.5}, {})), ElementsAre("near", "far"));
    EXPECT_TRUE(world.overlapping(0, {1.5, 0, 0.6}, {}).empty());
    EXPECT_THROW((void)world.overlapping(7, {}, {}), InputError);
    EXPECT_THROW((void)world.overlapping(0, {}, {2, 0, 0, 0}), InputError);
}

TEST(WorldQuery, BodiesInABoxAreThoseWithAPointInIt) {
    World world(two_crates());
    EXPECT_THAT(names(world, world.bodies_in({-0.1, -0.1, 0.9}, {0.1, 0.1, 1.1})), ElementsAre("near"));
    EXPECT_THAT(names(world, world.bodies_in({-9, -9, -9}, {9, 9, 9})), ElementsAre("floor", "near", "far"));
    EXPECT_TRUE(world.bodies_in({-0.1, -0.1, 0.4}, {0.1, 0.1, 0.6}).empty()) << "inside, where there is no surface";
    EXPECT_THAT(names(world, world.bodies_in({1, 0, 0}, {1, 0, 0})), ElementsAre("floor")) << "a single point";
    EXPECT_THROW((void)world.bodies_in({1, 0, 0}, {0, 0, 0}), InputError);
}

TEST(WorldQuery, ContactsOfABodyCarryItsWeight) {
    World world(two_crates());
    for (int k = 0; k < 60; ++k) (void)world.step();
    const BodyContacts c = world.contacts_of(world.find("near"));
    EXPECT_EQ(c.contacts.size(), 4u);
    EXPECT_NEAR(c.force.z, 2 * 9.8, 1e-3);
    EXPECT_NEAR(length(c.torque), 0, 1e-3);
    const BodyContacts floor = world.contacts_of(world.find("floor"));
    EXPECT_EQ(floor.contacts.size(), 8u);
    EXPECT_NEAR(floor.force.z, -4 * 9.8, 2e-3);
    EXPECT_EQ(world.contact_view().size(), 8u);
    world.remove_body(world.find("near"));
    EXPECT_EQ(world.contacts_of(world.find("floor")).contacts.size(), 4u) << "after an edit";
    (void)world.step();
    EXPECT_EQ(world.contacts_of(world.find("far")).contacts.size(), 4u) << "after a step";
    const BodyId third = world.add_body([] {
        BodyDescription body;
        body.name = "third";
        body.position = {0, 0, 5};
        return body;
    }());
    EXPECT_TRUE(world.contacts_of(third).contacts.empty());
    EXPECT_EQ(world.contacts_of(world.find("floor")).contacts.size(), 4u);
}

// A needle across the tops of two rails, which come before or after it, on a slope that friction holds it on: edges
// meet edges there, and the contact is found on the first body's. Friction turns the needle about its own axis by its
// thickness alone, not by the 3 mm at which it rests.
TEST(WorldQuery, ContactsOfANeedleHaveAPointOnEachBody) {
    for (const bool rails_first : {true, false}) {
        SceneDescription scene = scenario::empty_scene();
        scene.gravity = {9.8 * std::sin(0.2), 0, -9.8 * std::cos(0.2)};
        const std::int32_t rail = scenario::add_shape(scene, make_box(1, 0.1, 0.1)),
                           needle = scenario::add_shape(scene, make_box(1e-5, 1, 1e-5), 0.05);
        const auto add_rails = [&] {
            for (const double y : {-0.3, 0.3})
                scenario::add_body(scene, rail, BodyType::fixed, {0, y, -0.05}).friction = 0.5;
        };
        if (rails_first) add_rails();
        BodyDescription& thin = scenario::add_body(scene, needle, BodyType::dynamic, {0, 0, 0.0035});
        thin.friction = 0.5;
        thin.name = "needle";
        if (!rails_first) add_rails();
        World world(scene);
        for (int k = 0; k < 60; ++k) (void)world.step();
        const BodyContacts c = world.contacts_of(world.find("needle"));
        EXPECT_NEAR(c.force.x, -0.05 * scene.gravity.x, 1e-6);
        EXPECT_NEAR(c.force.z, -0.05 * scene.gravity.z, 1e-6);
        EXPECT_NEAR(length(c.torque), 0, 1e-7) << "N m, of a force of 0.1 N and a gap of 3 mm";
        for (const ContactState& contact : c.contacts)
            EXPECT_NEAR(dot(contact.across, contact.normal), contact.distance, 1e-12);
    }
    World crates(two_crates());
    for (int k = 0; k < 60; ++k) (void)crates.step();
    for (const ContactState& contact : crates.contacts()) EXPECT_EQ(contact.across, Vec3{});
}

TEST(WorldQuery, ViewsAreOfTheWorldsOwnMemory) {
    World world(two_crates());
    const auto poses = world.poses();
    EXPECT_EQ(poses.data(), world.poses().data());
    EXPECT_EQ(poses.size(), 3u);
    EXPECT_EQ(poses[2].origin, world.body(2).position);
    world.set_user_data(world.find("far"), 77);
    EXPECT_EQ(world.user_data(world.find("far")), 77u);
    EXPECT_EQ(world.user_data(world.find("near")), 0u);
    const MemoryUse memory = world.memory();
    EXPECT_GT(memory.shapes, 1000u);
    EXPECT_GT(memory.bodies, 1000u);
    EXPECT_LT(memory.total(), 10'000'000u);
}

TEST(WorldQuery, SleepersKeepNoVerticesUntilTheyWake) {
    World world(make_scene("boats-in-bowl", 22, 1));
    (void)world.step();
    const MemoryUse falling = world.memory();
    while (world.step().sleeping < 20 && world.steps() < 400) {
    }
    ASSERT_LT(world.steps(), 400);
    const MemoryUse asleep = world.memory();
    EXPECT_LT(static_cast<double>(asleep.bodies), 0.25 * static_cast<double>(falling.bodies))
        << "of that the bowl is a sixth";

    // Who asks gets them: as they are in a World that has just begun there.
    World resumed = world.clone();
    for (std::size_t i = 1; i < 6; ++i) {
        const ClosestPoints d = world.closest(world.id(0), world.id(i));
        EXPECT_EQ(d.point_a, resumed.closest(resumed.id(0), resumed.id(i)).point_a);
        EXPECT_LT(length(d.point_a - world.body(0).position), 2) << "on a boat of 3 m";
    }
    EXPECT_TRUE(world.ray(world.body(0).position + Vec3{0, 0, 9}, {0, 0, -1}, 20).has_value());
    EXPECT_EQ(world.bodies_in({-20, -20, -20}, {20, 20, 20}).size(), world.num_bodies());
    const auto keep = world.memory().bodies;
    EXPECT_GT(keep, asleep.bodies) << "kept for the next one who asks";

    world.wake(world.id(0));
    (void)world.step();
    EXPECT_GT(world.memory().bodies, keep);
}

TEST(WorldQuery, PinnedPlacesStayWhereTheyAre) {
    const SceneDescription scene = two_crates();
    World world(scene, "scene", {.threads = 1});
    const std::vector<std::byte> start = world.snapshot();
    const std::span<const Pose> poses = world.poses();
    const std::span<const Motion> motions = world.motions();
    const auto stand = [&] {
        EXPECT_EQ(world.poses().data(), poses.data());
        EXPECT_EQ(world.motions().data(), motions.data());
        EXPECT_EQ(poses[2].origin, world.body(2).position);
    };
    std::shared_ptr<const void> pin = world.pin();
    (void)world.step();
    stand();
    world.set_pose(world.find("far"), {3, 0, 9}, {});
    (void)world.step();
    stand();
    world.set_observer([](Phase phase) { return phase != Phase::velocity && phase != Phase::static_contact; });
    EXPECT_THROW((void)world.step(), StepCancelled);
    world.set_observer({});
    stand();
    world.restore(start);
    stand();
    EXPECT_EQ(world.state_hash(), World(scene).state_hash());

    BodyDescription third = scene.bodies[2];
    third.name = "third", third.position = {0, 0, 7};
    const std::uint64_t before = world.state_hash();
    EXPECT_THROW(world.add_body(third), InputError);
    EXPECT_EQ(world.state_hash(), before);
    world.remove_body(world.find("far"));
    EXPECT_EQ(world.add_body(third).index, 2) << "a place that there is";
    stand();
    const std::vector<std::byte> of_three = world.snapshot();

    pin.reset();
    third.name = "fourth", third.position = {0, 0, 9};
    EXPECT_EQ(world.add_body(third).index, 3);
    pin = world.pin();
    EXPECT_THROW(world.restore(of_three), InputError);
    EXPECT_EQ(world.size(), 4u);
    World other = world.clone();
    other.restore(of_three); // a pin is of one World
    pin.reset();
    world.restore(of_three);
    EXPECT_EQ(world.step().state_hash, other.step().state_hash);
}

TEST(WorldQuery, SharedContactsStayWhatTheyAre) {
    std::shared_ptr<const std::vector<ContactState>> kept, same;
    std::vector<ContactState> before;
    {
        World world(two_crates());
        for (int k = 0; k < 60; ++k) (void)world.step();
        kept = world.shared_contacts();
        same = world.shared_contacts();
        EXPECT_EQ(kept, same) << "no copies";
        EXPECT_EQ(kept->data(), world.contact_view().data());
        before = world.contacts();
        world.apply_impulse(world.find("near"), {0, 0, 20}, world.body(1).center_of_mass);
        (void)world.step();
        EXPECT_NE(world.contacts().size(), before.size());
    }
    EXPECT_EQ(*kept, before);
}

} // namespace
} // namespace flotilla::test
