// SPDX-License-Identifier: MIT
// A scratch that has solved other contacts before gives the bits of a new one, whatever has changed since.
#include "static_contact/assemble.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/same_bits.hpp"
#include "static_contact/contact_systems.hpp"

namespace flotilla {
namespace {

struct Change {
    std::string what;
    std::function<void(ContactWorld&)> make;
};

Contact& some_contact(ContactWorld& w) { return w.contacts[w.contacts.size() / 2]; }
std::size_t some_body(ContactWorld& w) { return static_cast<std::size_t>(some_contact(w).b); }
void reset_impulses(ContactWorld& w) { w.impulses.assign(w.contacts.size(), Vec3{}); }

std::vector<Change> changes() {
    return {
        {"nothing", [](ContactWorld&) {}},
        {"point", [](ContactWorld& w) { some_contact(w).point.x += 0.01; }},
        {"normal",
         [](ContactWorld& w) {
             some_contact(w).normal = normalized(some_contact(w).normal + Vec3{0.1, 0, 0});
         }},
        {"turned normal", [](ContactWorld& w) { some_contact(w).normal = -some_contact(w).normal; }},
        {"friction", [](ContactWorld& w) { some_contact(w).friction += 0.1; }},
        {"target", [](ContactWorld& w) { some_contact(w).target += 0.1; }},
        {"slip",
         [](ContactWorld& w) {
             some_contact(w).slip = 0.1 * cross(some_contact(w).normal, Vec3{1, 2, 3});
         }},
        {"a point on each body", [](ContactWorld& w) { some_contact(w).across = 0.02 * some_contact(w).normal; }},
        {"one point again", [](ContactWorld& w) { some_contact(w).across = {}; }},
        {"wider gap", [](ContactWorld& w) { some_contact(w).target = -1000; }},
        {"tolerance", [](ContactWorld& w) { some_contact(w).tolerance = 1e-9; }},
        {"position", [](ContactWorld& w) { w.position[some_body(w)].z += 0.01; }},
        {"position of infinite mass", [](ContactWorld& w) { w.position[0].z += 0.01; }},
        {"mass", [](ContactWorld& w) { w.inv_mass[some_body(w)] *= 2; }},
        {"infinite mass", [](ContactWorld& w) { w.inv_mass[some_body(w)] = 0; }},
        {"inertia", [](ContactWorld& w) { w.inv_inertia[some_body(w)].m[4] *= 2; }},
        {"turned inertia",
         [](ContactWorld& w) {
             Mat3& j = w.inv_inertia[some_body(w)];
             j.m[1] = j.m[3] = 0.1 * j.m[0];
         }},
        {"lock", [](ContactWorld& w) { w.locked[some_body(w)] = 1; }},
        {"velocity", [](ContactWorld& w) { w.velocity[some_body(w)].x += 10; }},
        {"warm impulse",
         [](ContactWorld& w) {
             w.impulses[w.contacts.size() / 2] = {0.1, 0.2, 0.3};
         }},
        {"one contact less",
         [](ContactWorld& w) {
             w.contacts.erase(w.contacts.begin() + static_cast<std::ptrdiff_t>(w.contacts.size() / 2));
             reset_impulses(w);
         }},
        {"one contact more",
         [](ContactWorld& w) {
             Contact c = some_contact(w);
             w.add_contact(c.a, c.b, c.point + Vec3{0, 0.1, 0}, c.normal, c.friction, c.target);
         }},
        {"one gap more",
         [](ContactWorld& w) {
             const Contact c = some_contact(w);
             w.add_contact(c.a, c.b, c.point + Vec3{0.1, 0, 0}, c.normal, c.friction, -1000);
         }},
        {"no gap",
         [](ContactWorld& w) {
             std::erase_if(w.contacts, [](const Contact& c) { return c.target < 0; });
             reset_impulses(w);
         }},
        {"no lock", [](ContactWorld& w) { std::ranges::fill(w.locked, AxisMask{0}); }},
        {"one contact in place of another",
         [](ContactWorld& w) {
             Contact& c = w.contacts.front();
             c.a = some_contact(w).a;
             c.b = some_contact(w).b;
         }},
        {"order of input", [](ContactWorld& w) { std::reverse(w.contacts.begin(), w.contacts.end()); }},
        {"features of a pair",
         [](ContactWorld& w) {
             for (Contact& c : w.contacts) c.feature_key = 1000 - c.feature_key;
         }},
        {"no friction",
         [](ContactWorld& w) {
             for (Contact& c : w.contacts) c.friction = 0;
         }},
        {"friction again",
         [](ContactWorld& w) {
             for (Contact& c : w.contacts) c.friction = 0.4;
         }},
        {"bodies exchanged",
         [](ContactWorld& w) {
             std::swap(w.position[1], w.position[2]);
             std::swap(w.inv_mass[1], w.inv_mass[2]);
             std::swap(w.inv_inertia[1], w.inv_inertia[2]);
         }},
        {"a body without contacts", [](ContactWorld& w) { w.add_body(1); }},
    };
}

void expect_same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), same_bits<Vec3>));
}

// Solves with the scratch as it is and with a new one.
void expect_as_new(ContactWorld& w, const ContactSolveOptions& options) {
    ContactWorld anew = w;
    anew.scratch = {};
    const ContactSolveStats stats = w.solve(options), of_new = anew.solve(options);
    expect_same_bits(w.velocity, anew.velocity);
    expect_same_bits(w.angular_velocity, anew.angular_velocity);
    expect_same_bits(w.impulses, anew.impulses);
    EXPECT_EQ(stats.iterations, of_new.iterations);
    EXPECT_EQ(stats.visits, of_new.visits);
    EXPECT_EQ(stats.residual, of_new.residual);
    EXPECT_EQ(stats.colors, of_new.colors);
    EXPECT_EQ(stats.islands, of_new.islands);
}

// Islands of 12 bodies; and one of so many that its packets are ordered by regions.
std::vector<ContactWorld> systems() {
    std::vector<ContactWorld> out{make_random(1, 60, 12, 0.5, true), make_random(2, 300, 300, 0.5, false)};
    for (ContactWorld& w : out) open_gaps(w);
    return out;
}

std::vector<ContactSolveOptions> ways(Team& team) {
    ContactSolveOptions cone{.iterations = 60, .tolerance = 1e-6, .patience = 50, .rest_speed = 0.1};
    ContactSolveOptions exact = cone, random = cone, threads = cone;
    exact.exact = true;
    random.tangents = Tangents::random;
    threads.team = &team;
    return {cone, exact, random, threads};
}

// Where the next solve of the same contacts begins.
void set_back(ContactWorld& w, const ContactWorld& start) {
    std::copy(start.velocity.begin(), start.velocity.end(), w.velocity.begin());
    std::copy(start.angular_velocity.begin(), start.angular_velocity.end(), w.angular_velocity.begin());
    reset_impulses(w);
}

TEST(Assemble, KnowsWhatChangedSinceTheLastSolve) {
    Team team({.threads = 3, .crowds = true});
    for (const ContactWorld& start : systems())
        for (const ContactSolveOptions& options : ways(team))
            for (const Change& change : changes()) {
                SCOPED_TRACE(change.what);
                ContactWorld w = start;
                w.solve(options);
                set_back(w, start);
                change.make(w);
                expect_as_new(w, options);
            }
}

TEST(Assemble, KnowsWhatChangedInManySolves) {
    Team team({.threads = 3, .crowds = true});
    for (const ContactWorld& start : systems())
        for (ContactSolveOptions options : ways(team)) {
            ContactWorld w = start;
            for (const Change& change : changes()) {
                SCOPED_TRACE(change.what);
                change.make(w);
                ++options.step; // of random tangents
                expect_as_new(w, options);
                set_back(w, start);
            }
        }
}

TEST(Assemble, KnowsOtherOptions) {
    for (const ContactWorld& start : systems()) {
        ContactWorld w = start;
        ContactSolveOptions options{.iterations = 60};
        const auto solve = [&] {
            expect_as_new(w, options);
            set_back(w, start);
        };
        solve();
        options.tangents = Tangents::random;
        solve();
        options.tangents = Tangents::cone;
        options.tuning.to_and_fro = !options.tuning.to_and_fro;
        solve();
        options.tuning.parked_margin *= 1e6;
        solve();
        for (Contact& c : w.contacts) c.friction = 0;
        solve();
        options.normal_rows = false;
        solve();
    }
}

TEST(Assemble, GoesOnAfterVelocitiesWithoutBounds) {
    const ContactWorld start = systems().front();
    ContactWorld w = start;
    const ContactSolveOptions options{.iterations = 5, .shock = false};
    for (Vec3& v : w.velocity) v = 1e300 * v;
    w.solve(options);
    set_back(w, start);
    expect_as_new(w, options);
}

int blocks_standing(const ContactWorld& w) { return static_cast<int>(std::ranges::count(w.scratch.block_stands, 1)); }

TEST(Assemble, KeepsWhatIsTheSame) {
    for (const ContactWorld& start : systems()) {
        ContactWorld w = start;
        const ContactSolveOptions options{.iterations = 20};
        w.solve(options);
        EXPECT_EQ(blocks_standing(w), 0);
        const int blocks = static_cast<int>(w.scratch.blocks.size());
        set_back(w, start);
        w.solve(options);
        EXPECT_EQ(blocks_standing(w), blocks);
        set_back(w, start);
        some_contact(w).point.x += 0.01;
        w.solve(options);
        EXPECT_EQ(blocks_standing(w), blocks - 1);
        set_back(w, start);
        some_contact(w).target -= 1e-3;
        w.solve(options);
        EXPECT_EQ(blocks_standing(w), blocks);
    }
}

} // namespace
} // namespace flotilla
