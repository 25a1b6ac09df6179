// SPDX-License-Identifier: MIT
#include "physics/physics.hpp"

#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <utility>

#include "scene/scene.hpp"

namespace flotilla::physics {

extern const Slice kSlice; // of the executable

namespace {

class FunctionTest : public testing::Test {
  public:
    explicit FunctionTest(std::function<void()> body) : body_(std::move(body)) {}
    void TestBody() override { body_(); }

  private:
    std::function<void()> body_;
};

/// Seconds that the calling thread had a core: what else the machine does must not end a run.
double thread_seconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Vec3 angular_momentum(const MassProperties& mass, const Quat& rotation, const Vec3& angular_velocity) {
    return rotate(rotation, mass.inertia * rotate(conjugate(rotation), angular_velocity));
}

} // namespace

std::vector<Run> runs(const std::vector<int>& rates) {
    std::vector<Run> list;
    for (const char* preset : {"balanced", "accurate", "reference"})
        for (const int rate : rates) list.push_back({preset, rate});
    return list;
}

void add_test(const std::string& suite, const std::string& name, Slice slice, std::function<void()> body) {
    if (slice != kSlice) return;
    testing::RegisterTest(suite.c_str(), name.c_str(), nullptr, nullptr, __FILE__, __LINE__,
                          [body = std::move(body)]() -> testing::Test* { return new FunctionTest(body); });
}

void add_runs(const std::string& suite, const std::string& name, const std::vector<Run>& list, bool fast,
              const std::function<void(const Run&)>& body) {
    for (const Run& run : list)
        add_test(suite, name + "/" + run.name(), fast && &run == &list.front() ? Slice::fast : Slice::full,
                 [run, body] { body(run); });
}

Motion::Motion(const SceneDescription& scene) : scene_(scene), world_(scene), bodies_(scene.bodies.size()) {
    const Scene built = build_scene(scene);
    const double g = length(scene.gravity);
    double total = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const BodyDescription& body = built.bodies[i];
        const Shape& shape = built.shapes[static_cast<std::size_t>(body.shape)];
        bodies_[i].start = world_.body(i).center_of_mass;
        bodies_[i].size = 2 * shape.sphere.radius;
        for (const Vec3& v : shape.mesh.vertices) {
            const Vec3 arm = v - shape.center;
            bodies_[i].half = max(bodies_[i].half, {std::abs(arm.x), std::abs(arm.y), std::abs(arm.z)});
        }
        scripted_ = scripted_ || body.type == BodyType::kinematic;
        if (body.type != BodyType::dynamic) continue;
        const MassProperties& mass = *shape.mass;
        bodies_[i].mass = mass.mass;
        const Vec3 spin = angular_momentum(mass, body.rotation, body.angular_velocity);
        out_.start += 0.5 * (mass.mass * length_sq(body.velocity) + dot(spin, body.angular_velocity));
        total -= mass.mass * dot(scene.gravity, bodies_[i].start);
        const double rest = scene.settings.rest_distance;
        lift_ += mass.mass * g * (rest > 0 ? rest : bodies_[i].size / kSizePerRestDistance);
    }
    total += out_.start;
    out_.start_total = lowest_ = low_ = high_ = total;
    add(total, out_.start);
}

void Motion::add(double total, double kinetic) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    const double rise = std::isfinite(total) ? total - lowest_ - lift_ : kInfinite;
    if (rise > rise_) rise_ = rise, out_.rise_step = out_.steps;
    lowest_ = std::min(lowest_, total);
    low_ = std::min(low_, total), high_ = std::max(high_, total);
    kinetic_ = std::max(kinetic_, kinetic);
    // What cannot be told from rounding of the energy is no scale.
    const double rounding = 1e-9 * std::max(std::abs(low_), std::abs(high_));
    out_.scale = std::max({high_ - low_, kinetic_, rounding, 1e-300});
    out_.rise = rise_ < kInfinite ? rise_ / out_.scale : kInfinite;
    out_.end = kinetic;
    out_.end_total = total;
}

// Not above what turns at the radius of the size: a needle that turns about its own axis hardly moves.
double Motion::surface_speed(const Body& body, const BodyState& state) {
    const Vec3 w = rotate(conjugate(state.rotation), state.angular_velocity), h = body.half;
    const Vec3 most{std::abs(w.y) * h.z + std::abs(w.z) * h.y, std::abs(w.z) * h.x + std::abs(w.x) * h.z,
                    std::abs(w.x) * h.y + std::abs(w.y) * h.x};
    return std::min(0.5 * body.size * length(w), length(most));
}

StepReport Motion::step() {
    const double start = thread_seconds();
    const StepReport r = world_.step();
    out_.seconds += thread_seconds() - start;
    ++out_.steps;
    out_.merges += r.merges;
    out_.held += r.held;
    out_.held_steps += r.held > 0 ? 1 : 0;
    out_.above += (r.warnings & kStaticLimit) != 0 ? 1 : 0;
    out_.asleep = r.sleeping;
    add(r.energy, r.kinetic_energy);
    out_.fastest = out_.fastest_sizes = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        if (bodies_[i].mass == 0) continue;
        const BodyState s = world_.body(i);
        const double speed = length(s.velocity), surface = surface_speed(bodies_[i], s);
        out_.fastest = std::max(out_.fastest, speed);
        out_.fastest_sizes = std::max(out_.fastest_sizes, std::max(speed, surface) / bodies_[i].size);
    }
    return r;
}

void Motion::run(double time, const std::function<void(const StepReport&)>& each, double most) {
    constexpr double kExploded = 0.5; // of the scale
    while (world_.time() < time - 0.5 * scene_.settings.time_step) {
        const StepReport r = step();
        if (each) each(r);
        if (out_.seconds < most && (scripted_ || out_.rise < kExploded)) continue;
        ADD_FAILURE() << "given up at " << world_.time() << " s of " << time << " s, step " << out_.steps;
        return;
    }
}

History Motion::record(double time) {
    History history(scene_.settings.time_step);
    const auto add_instant = [&] {
        Instant now{world_.time(), {}};
        for (std::size_t i = 0; i < world_.size(); ++i) now.bodies.push_back(world_.body(i));
        history.add(std::move(now));
    };
    add_instant();
    run(time, [&](const StepReport&) { add_instant(); });
    return history;
}

double Motion::total_mass() const {
    double sum = 0;
    for (const Body& b : bodies_) sum += b.mass;
    return sum;
}

Vec3 Motion::force_on(std::size_t body) const {
    Vec3 impulse;
    for (const ContactState& c : world_.contacts()) {
        if (c.body_b == static_cast<std::int32_t>(body)) impulse += c.impulse;
        if (c.body_a == static_cast<std::int32_t>(body)) impulse += -c.impulse;
    }
    return impulse / scene_.settings.time_step;
}

double Motion::farthest() const {
    double most = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
        if (bodies_[i].mass > 0) most = std::max(most, length(world_.body(i).center_of_mass - bodies_[i].start));
    return most;
}

double Motion::farthest_aside() const {
    const Vec3 up = normalized(-scene_.gravity);
    double most = 0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        if (bodies_[i].mass == 0) continue;
        const Vec3 moved = world_.body(i).center_of_mass - bodies_[i].start;
        most = std::max(most, length(moved - dot(moved, up) * up));
    }
    return most;
}

void Motion::print(const char* format, ...) const {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    std::printf(
        "%s.%s: rise %.2g of %.3g J (step %d), end %.3g J %.2g m/s %.2g sizes/s, merges %lld, held %lld in %lld, "
        "above %lld of %d, %.1f s",
        test->test_suite_name(), test->name(), out_.rise, out_.scale, out_.rise_step, out_.end, out_.fastest,
        out_.fastest_sizes, static_cast<long long>(out_.merges), static_cast<long long>(out_.held),
        static_cast<long long>(out_.held_steps), static_cast<long long>(out_.above), out_.steps, out_.seconds);
    std::printf("; ");
    std::va_list arguments;
    va_start(arguments, format);
    std::vprintf(format, arguments);
    va_end(arguments);
    std::printf("\n");
    std::fflush(stdout);
}

void expect_no_rise(const Motion& motion) {
    EXPECT_LE(motion.outcome().rise, kRise)
        << "of " << motion.outcome().scale << " J, at step " << motion.outcome().rise_step;
}

void expect_rest(const Motion& motion) { EXPECT_LT(motion.outcome().fastest_sizes, 1e-4) << "sizes a second"; }

void expect_weight_on(const Motion& motion, std::size_t ground) {
    const double weight = motion.total_mass() * length(motion.scene().gravity);
    const double carried = dot(motion.force_on(ground), normalized(motion.scene().gravity));
    EXPECT_NEAR(carried / weight, 1, 1e-3) << "of the weight";
}

} // namespace flotilla::physics
