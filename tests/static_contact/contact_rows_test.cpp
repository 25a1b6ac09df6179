// SPDX-License-Identifier: MIT
// W of many contacts side by side: the bits of one at a time.
#include "static_contact/contact_rows.hpp"

#include <cstring>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "base/rotation.hpp"
#include "static_contact/tangents.hpp"

namespace flotilla {
namespace {

class RandomRows {
  public:
    explicit RandomRows(unsigned seed) : random_(seed) {}

    /// Some with a body that cannot move, some with equal moments of inertia, whose tangents need no turn.
    ContactBlock block() {
        ContactBlock b;
        b.inv_mass_a = random_() % 4 == 0 ? 0 : uniform(0.1, 1);
        b.inv_mass_b = b.inv_mass_a == 0 || random_() % 4 != 0 ? uniform(0.1, 1) : 0;
        const bool round = random_() % 4 == 0;
        const auto inertia = [&] {
            const double xx = uniform(0.5, 2);
            if (round) return Sym3{xx, xx, xx, 0, 0, 0};
            return Sym3{
                xx, uniform(0.5, 2), uniform(0.5, 2), uniform(-0.2, 0.2), uniform(-0.2, 0.2), uniform(-0.2, 0.2)};
        };
        if (b.inv_mass_a > 0) b.inv_inertia_a = inertia();
        if (b.inv_mass_b > 0) b.inv_inertia_b = inertia();
        return b;
    }
    ContactRow row() {
        ContactRow r;
        const bool plain = random_() % 3 == 0;
        r.normal = plain ? Vec3{0, 0, 1} : vec();
        if (!plain) r.normal = (1 / length(r.normal)) * r.normal;
        const TangentPair t = any_tangents(r.normal);
        r.tangent_1 = t.t1;
        r.tangent_2 = t.t2;
        r.arm_a = plain ? Vec3{0, 0, 1} : vec();
        r.arm_b = plain ? Vec3{0, 0, -1} : vec();
        r.local.target = vec();
        r.local.friction = uniform(0, 1);
        return r;
    }

  private:
    double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
    Vec3 vec() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }

    std::mt19937_64 random_;
};

TEST(ContactRows, PrincipalMassesSideBySideAreThoseOneByOne) {
    RandomRows random(1);
    int turned = 0;
    for (std::size_t n = 0; n < 40; ++n) {
        std::vector<ContactBlock> blocks;
        std::vector<ContactRow> one, many;
        for (std::size_t i = 0; i < n; ++i) {
            blocks.push_back(random.block());
            one.push_back(random.row());
        }
        many = one;
        PrincipalMasses masses(best_isa());
        for (std::size_t i = 0; i < n; ++i) masses.add(blocks[i], many[i]);
        masses.flush();
        for (std::size_t i = 0; i < n; ++i) {
            const Vec3 before = one[i].tangent_1;
            set_principal_mass(blocks[i], one[i]);
            turned += one[i].tangent_1 != before ? 1 : 0;
            ASSERT_EQ(std::memcmp(&one[i], &many[i], sizeof(ContactRow)), 0) << n << ' ' << i;
            ContactRow again = one[i];
            set_effective_mass(blocks[i], again); // in the frame found
            ASSERT_EQ(again.local.mass_diagonal, one[i].local.mass_diagonal);
            ASSERT_EQ(again.local.coupling, one[i].local.coupling);
            ASSERT_NEAR(again.local.coupling.z, 0, 1e-14 * max_component(again.local.mass_diagonal));
        }
    }
    EXPECT_GT(turned, 300);
    EXPECT_LT(turned, 780);
}

} // namespace
} // namespace flotilla
