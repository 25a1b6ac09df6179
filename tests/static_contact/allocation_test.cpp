// SPDX-License-Identifier: MIT
// A steady scene allocates nothing in the contact solver. This program replaces operator new to count.
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "static_contact/contact_systems.hpp"

namespace {
std::atomic<long> num_allocations{0};
}

void* operator new(std::size_t size) {
    ++num_allocations;
    if (void* p = std::malloc(size)) return p;
    throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    ++num_allocations;
    const auto a = static_cast<std::size_t>(alignment);
    if (void* p = std::aligned_alloc(a, (size + a - 1) / a * a)) return p;
    throw std::bad_alloc();
}
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

namespace flotilla {
namespace {

TEST(SolveContacts, AllocatesNothingTheSecondTime) {
    ContactWorld w;
    w.add_body(0);
    for (int i = 1; i <= 40; ++i) {
        const std::int32_t body = w.add_body(1, {1, 1, 1}, {0, 0, static_cast<double>(i)});
        for (const double x : {-0.5, 0.5}) w.add_contact(body - 1, body, {x, 0, i - 0.5}, {0, 0, 1}, 0.5);
    }
    const std::vector<Contact> contacts = w.contacts;
    long counted = 0;
    for (int step = 0; step < 3; ++step) {
        for (std::size_t i = 1; i < w.velocity.size(); ++i) w.velocity[i] = {0.1, 0, -1};
        const long before = num_allocations;
        const ContactSolveStats stats = w.solve({.iterations = 10});
        counted = num_allocations - before;
        EXPECT_EQ(stats.shocked_islands, 1);
        std::reverse(w.contacts.begin(), w.contacts.end()); // makes the next step sort
        if (step == 0) {
            EXPECT_GT(counted, 0) << "the counter does not count";
        }
    }
    EXPECT_EQ(counted, 0);
}

TEST(SolveContacts, PartsAllocateNothingInTheEnd) {
    ContactWorld w = make_floor_with_tower(40, 30, 0);
    const std::vector<Vec3> start = w.velocity;
    long counted = 0;
    for (const double push : {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0}) { // on bodies of the floor: a larger part in the end
        w.velocity = start;
        w.angular_velocity.assign(start.size(), Vec3{});
        for (std::size_t i = 1; i < 5; ++i) w.velocity[i].x = push;
        w.impulses.assign(w.contacts.size(), Vec3{});
        const long before = num_allocations;
        const ContactSolveStats stats =
            w.solve({.iterations = 300, .tolerance = 1e-6, .rest_speed = 1e6, .shock = false});
        counted = num_allocations - before;
        EXPECT_GT(stats.part_rounds, 0);
    }
    EXPECT_EQ(counted, 0);
}

} // namespace
} // namespace flotilla
