// SPDX-License-Identifier: MIT
// A host with another rounding mode, without subnormal numbers or with traps: the same bits, and its environment is as
// it was.
#include <bit>
#include <cfenv>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include <flotilla/scene_check.hpp>

#include "step/scenario.hpp"
#include "step/thread_scenes.hpp"

namespace flotilla::scenario {
namespace {

constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040; // bits of MXCSR

struct Environment {
    const char* name;
    void (*set)();
    friend void PrintTo(const Environment& e, std::ostream* out) { *out << e.name; }
};

/// Rounding mode, traps, and what the processor does with subnormal numbers; not the flags.
struct Observed {
    int rounding = std::fegetround();
#if defined(__GLIBC__)
    int traps = fegetexcept();
#endif
#if defined(__SSE__)
    unsigned modes = _mm_getcsr() & ~0x3fU;
#endif
    friend bool operator==(const Observed&, const Observed&) = default;
};

/// The host's environment, for one test.
class Host {
  public:
    explicit Host(const Environment& environment) {
        std::fegetenv(&before_);
        environment.set();
    }
    ~Host() { std::fesetenv(&before_); }
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;

  private:
    std::fenv_t before_{};
};

class FloatingPoint : public testing::TestWithParam<Environment> {};

std::vector<std::uint64_t> hashes_of(const SceneDescription& scene, int steps, int threads) {
    World world(scene, "scene", {threads});
    std::vector<std::uint64_t> out{world.state_hash(), world.scene_hash()};
    for (int n = 0; n < steps; ++n) {
        const Observed before;
        out.push_back(world.step().state_hash);
        EXPECT_EQ(Observed{}, before) << "step " << n;
        const Vec3 omega = world.body(0).angular_velocity;
        for (const double x : {omega.x, omega.y, omega.z}) out.push_back(std::bit_cast<std::uint64_t>(x));
    }
    return out;
}

/// A body with a velocity that is no normal number.
SceneDescription creeping() {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    add_body(scene, add_shape(scene, make_box(1, 1, 1), 1), BodyType::dynamic, {}).velocity = {1e-310, 0, 0};
    return scene;
}

TEST_P(FloatingPoint, OfTheHostChangesNoBit) {
    constexpr int kSteps = 36;
    const SceneDescription scene = one_pile(false);
    const auto expected = hashes_of(scene, kSteps, 1);
    const auto creeps = hashes_of(creeping(), 3, 1);
    const Host host(GetParam());
    for (const int threads : {1, 3}) EXPECT_EQ(hashes_of(scene, kSteps, threads), expected) << threads;
    EXPECT_EQ(hashes_of(creeping(), 3, 1), creeps);
    EXPECT_EQ(make_scene("boats-in-bowl", 32, 1).bodies[5].position, scene.bodies[5].position);
    EXPECT_EQ(check_scene(scene).mass, [&] {
        const Host plain({"", [] { std::fesetenv(FE_DFL_ENV); }});
        return check_scene(scene).mass;
    }());
}

TEST_P(FloatingPoint, OfTheHostIsRestoredWhereACallThrows) {
    SceneDescription scene = empty_scene();
    scene.settings.unsatisfiable_script = UnsatisfiableScript::error;
    add_body(scene, add_shape(scene, make_box(0.5, 0.5, 0.5), 60), BodyType::dynamic, {0, 0, 0.26});
    add_body(scene, add_shape(scene, make_box(20, 20, 0.2)), BodyType::fixed, {0, 0, -0.1});
    auto& lid = add_body(scene, add_shape(scene, make_box(2, 2, 0.2)), BodyType::kinematic, {0, 0, 2});
    lid.keyframes = {{0, lid.position, {}}, {1, {0, 0, 0}, {}}};
    World world(scene, "scene", {2});
    const Host host(GetParam());
    const Observed before;
    EXPECT_THROW(for (int n = 0; n < 24; ++n) world.step(), ScriptError);
    EXPECT_EQ(Observed{}, before);
    EXPECT_THROW((void)world.body(3), InputError);
    EXPECT_EQ(Observed{}, before);
    scene.settings.time_step = -1;
    EXPECT_THROW(World{scene}, InputError);
    EXPECT_EQ(Observed{}, before);
}

const Environment kEnvironments[] = {
    {"Upward", [] { std::fesetround(FE_UPWARD); }},
    {"Downward", [] { std::fesetround(FE_DOWNWARD); }},
    {"TowardZero", [] { std::fesetround(FE_TOWARDZERO); }},
#if defined(__SSE__)
    {"FlushToZero", [] { _mm_setcsr(_mm_getcsr() | kFlushToZero | kDenormalsAreZero); }},
#endif
#if defined(__GLIBC__)
    {"Traps", [] { feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW | FE_INEXACT); }},
#endif
};

INSTANTIATE_TEST_SUITE_P(Hosts, FloatingPoint, testing::ValuesIn(kEnvironments),
                         [](const auto& host) { return std::string(host.param.name); });

} // namespace
} // namespace flotilla::scenario
