// SPDX-License-Identifier: MIT
// Faults planted into the frames of a clean run, one at a time, each of which verify_run must find: at the planted
// frame, with the planted body, and without a word against another one. That a planted intersection is one is decided
// here, by brute force.
#pragma once

#include <algorithm>
#include <cstdio>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include <flotilla/run.hpp>
#include <flotilla/verify.hpp>

#include "base/rotation.hpp"
#include "run_folder/run_folder.hpp"
#include "step/bowl_run.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla::test {

enum class FaultKind { overlap, graze, through_wall, swapped, not_finite, not_unit };
inline constexpr int kFaultKinds = 6;

struct PlantedFault {
    FaultKind kind{};
    std::int64_t frame = 0; ///< of the run
    std::int32_t body = 0, other = -1;
    std::string text;
};

/// Thirty boats in a bowl, recorded from the first boats' impact on.
class PlantedRun {
  public:
    explicit PlantedRun(std::uint64_t seed)
        : rng_(seed), scene_(make_scene("boats-in-bowl", kBoats + 2, 1)), wall_(scene_) {
        RunOptions options;
        options.output = folder_.path() / "clean";
        options.steps = kSteps;
        (void)run_scene(scene_, "scene", options);
        io::RunReader reader(options.output);
        bodies_ = reader.scene();
        info_ = reader.info();
        for (std::int64_t k = 0; k < reader.frames(); ++k) frames_.push_back(reader.frame(k));
        for (const Vec3& v : scene_.shapes[1].vertices) rim_ = std::max(rim_, v.z);
    }

    [[nodiscard]] VerifyReport verify_clean() const { return verify_run(folder_.path() / "clean", options()); }

    /// Plants a fault of this kind where none was before, and expects the verdict on the frames around it to name it.
    bool plant_and_find(FaultKind kind) {
        for (;;) {
            const std::int64_t k = pick(kFirst, kSteps - kWindow);
            std::vector<io::Frame> frames(frames_.begin() + k - kBefore, frames_.begin() + k - kBefore + kWindow);
            PlantedFault fault{kind, k, static_cast<std::int32_t>(pick(0, kBoats - 1)), -1, ""};
            if (!plant(frames, fault) || !planted_.insert({kind, k, fault.body}).second) continue;
            return found(verify(frames), fault);
        }
    }

  private:
    static constexpr std::int64_t kBoats = 30, kSteps = 66, kFirst = 46;
    static constexpr std::int64_t kWindow = 5, kBefore = 2; ///< frames verified around a fault; of them, before it

    static VerifyOptions options() {
        VerifyOptions options;
        options.distance = false;
        return options;
    }

    std::int64_t pick(std::int64_t low, std::int64_t high) {
        return std::uniform_int_distribution<std::int64_t>(low, high)(rng_);
    }
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng_); }

    [[nodiscard]] std::vector<Vec3> vertices(const io::Frame& frame, std::int32_t body) const {
        const auto i = static_cast<std::size_t>(body);
        const TriangleMesh& mesh = bodies_.shapes[static_cast<std::size_t>(bodies_.bodies[i].shape)].mesh;
        std::vector<Vec3> placed(mesh.vertices.size());
        world_vertices(mesh.vertices, frame.position[i], frame.rotation[i], placed);
        return placed;
    }
    [[nodiscard]] bool intersect(const io::Frame& frame, std::int32_t a, std::int32_t b) const {
        return intersect(vertices(frame, a), vertices(frame, b));
    }
    /// Whether two boats meet whose vertices go straight from one frame to the next, by samples. Two that change places
    /// while one of them turns over may pass each other: half-way its vertices are all near its axis.
    [[nodiscard]] bool meet_on_the_way(const io::Frame& from, const io::Frame& to, std::int32_t a,
                                       std::int32_t b) const {
        constexpr int kSamples = 200;
        const auto a0 = vertices(from, a), a1 = vertices(to, a), b0 = vertices(from, b), b1 = vertices(to, b);
        const auto at_time = [](const std::vector<Vec3>& x0, const std::vector<Vec3>& x1, double t) {
            std::vector<Vec3> x(x0.size());
            for (std::size_t k = 0; k < x.size(); ++k) x[k] = x0[k] + t * (x1[k] - x0[k]);
            return x;
        };
        for (int k = 1; k < kSamples; ++k) {
            const double t = static_cast<double>(k) / kSamples;
            if (intersect(at_time(a0, a1, t), at_time(b0, b1, t))) return true;
        }
        return false;
    }
    [[nodiscard]] bool intersect(const std::vector<Vec3>& x, const std::vector<Vec3>& y) const {
        const auto& triangles = bodies_.shapes[0].mesh.triangles; // both are boats
        const auto corners = [](const std::vector<Vec3>& v, const Triangle& t) {
            const auto at = [&v](std::int32_t i) { return v[static_cast<std::size_t>(i)]; };
            return std::array<Vec3, 3>{at(t[0]), at(t[1]), at(t[2])};
        };
        scenario::Bounds bounds;
        for (const Triangle& t : triangles) bounds.add(corners(y, t));
        for (const Triangle& s : triangles)
            if (scenario::bounds_of(corners(x, s)).meets(bounds))
                for (const Triangle& t : triangles)
                    if (exact::triangles_intersect(corners(x, s), corners(y, t))) return true;
        return false;
    }
    [[nodiscard]] std::int32_t nearest_boat(const io::Frame& frame, std::int32_t body) const {
        std::int32_t nearest = -1;
        double distance = std::numeric_limits<double>::infinity();
        for (std::int32_t j = 0; j < kBoats; ++j) {
            const double d =
                length(frame.position[static_cast<std::size_t>(j)] - frame.position[static_cast<std::size_t>(body)]);
            if (j != body && d < distance) nearest = j, distance = d;
        }
        return nearest;
    }

    /// Edits the frame at kBefore, and those after it where a body goes away for good. False where the fault is none
    /// there.
    bool plant(std::vector<io::Frame>& frames, PlantedFault& fault) {
        io::Frame& frame = frames[kBefore];
        const auto i = static_cast<std::size_t>(fault.body);
        switch (fault.kind) {
        case FaultKind::overlap: return plant_overlap(frame, fault);
        case FaultKind::graze: return plant_graze(frame, fault);
        case FaultKind::through_wall: return plant_passage(frames, fault);
        case FaultKind::swapped: {
            fault.other = static_cast<std::int32_t>(pick(0, kBoats - 1));
            const auto j = static_cast<std::size_t>(fault.other);
            fault.text = "swapped with boat " + std::to_string(j);
            std::swap(frame.position[i], frame.position[j]);
            std::swap(frame.rotation[i], frame.rotation[j]);
            return i != j && meet_on_the_way(frames[kBefore - 1], frame, fault.body, fault.other);
        }
        case FaultKind::not_finite: {
            const double bad = pick(0, 1) == 0 ? std::nan("") : std::numeric_limits<double>::infinity();
            double* values[] = {&frame.position[i].x, &frame.position[i].y, &frame.position[i].z, &frame.rotation[i].w,
                                &frame.rotation[i].x, &frame.rotation[i].y, &frame.rotation[i].z};
            *values[pick(0, 6)] = bad;
            fault.text = "a value " + std::to_string(bad);
            return true;
        }
        case FaultKind::not_unit: {
            const double scale = 1 + (pick(0, 1) == 0 ? -1 : 1) * std::pow(10, uniform(-5.0, -0.5));
            Quat& q = frame.rotation[i];
            q = {scale * q.w, scale * q.x, scale * q.y, scale * q.z};
            fault.text = "a rotation of length " + std::to_string(scale);
            return true;
        }
        }
        return false;
    }

    /// Somewhere in another boat.
    bool plant_overlap(io::Frame& frame, PlantedFault& fault) {
        const auto i = static_cast<std::size_t>(fault.body);
        fault.other = static_cast<std::int32_t>(pick(0, kBoats - 1));
        if (fault.other == fault.body) return false;
        frame.position[i] = frame.position[static_cast<std::size_t>(fault.other)] +
                            Vec3{uniform(-0.2, 0.2), uniform(-0.2, 0.2), uniform(-0.2, 0.2)};
        frame.rotation[i] = rotation_from_vector({uniform(-3.0, 3.0), uniform(-3.0, 3.0), uniform(-3.0, 3.0)});
        fault.text = "inside boat " + std::to_string(fault.other);
        return intersect(frame, fault.body, fault.other);
    }

    /// Towards the nearest boat until it just intersects that.
    bool plant_graze(io::Frame& frame, PlantedFault& fault) {
        const auto i = static_cast<std::size_t>(fault.body);
        fault.other = nearest_boat(frame, fault.body);
        const Vec3 from = frame.position[i], way = frame.position[static_cast<std::size_t>(fault.other)] - from;
        const auto intersects_at = [&](double part) {
            frame.position[i] = from + part * way;
            return intersect(frame, fault.body, fault.other);
        };
        double apart = 0, inside = 1;
        if (!intersects_at(inside)) return false;
        while (inside - apart > 1e-14) {
            const double middle = 0.5 * (apart + inside);
            (intersects_at(middle) ? inside : apart) = middle;
        }
        fault.text = "just into boat " + std::to_string(fault.other);
        return intersects_at(inside);
    }

    /// From inside the bowl to a place beside it: every frame is clean, the way there is not.
    bool plant_passage(std::vector<io::Frame>& frames, PlantedFault& fault) {
        constexpr double kBelowRim = 1, kFar = 12; // m
        const auto i = static_cast<std::size_t>(fault.body);
        const Vec3& from = frames[kBefore - 1].position[i];
        if (!wall_.contains(from) || from.z > rim_ - kBelowRim) return false;
        const SinCos way = sin_cos(uniform(0.0, 2 * scenario::kPi));
        for (std::size_t k = kBefore; k < frames.size(); ++k)
            frames[k].position[i] += Vec3{kFar * way.cos, kFar * way.sin, 0};
        fault.other = kBoats; // the bowl
        fault.text = "through the wall of the bowl";
        return true;
    }

    VerifyReport verify(const std::vector<io::Frame>& frames) const {
        io::RunInfo info = info_;
        info.scene_json = "{}";
        io::RunWriter writer(folder_.path() / "planted", info, bodies_, io::OpenRun::overwrite);
        std::int64_t step = 0;
        for (const auto& f : frames)
            writer.add_frame({step++, f.time, f.position, f.rotation, f.velocity, f.angular_velocity, {}});
        writer.close("complete");
        return verify_run(folder_.path() / "planted", options());
    }

    /// The verdict names the planted frame and body, and nothing else.
    static bool found(const VerifyReport& report, const PlantedFault& fault) {
        using Kind = VerifyFault::Kind;
        const auto names = [&](const VerifyFault& f, std::int32_t body) {
            return f.body_a == body || f.body_b == body;
        };
        bool found = false, others = false;
        for (const VerifyFault& f : report.faults) {
            const bool swapped = fault.kind == FaultKind::swapped;
            others = others || f.frame < kBefore - 1 || f.frame > kBefore ||
                     !(names(f, fault.body) || (swapped && names(f, fault.other)));
            const bool pair = names(f, fault.body) && names(f, fault.other);
            switch (fault.kind) {
            case FaultKind::overlap:
            case FaultKind::graze: found = found || (f.kind == Kind::intersection && f.frame == kBefore && pair); break;
            case FaultKind::through_wall:
                found = found || (f.kind == Kind::crossing && f.frame == kBefore - 1 && pair);
                others = others || f.kind == Kind::intersection;
                break;
            case FaultKind::swapped: found = found || (f.kind != Kind::bad_pose && pair); break;
            case FaultKind::not_finite:
            case FaultKind::not_unit:
                found = found || (f.kind == Kind::bad_pose && f.frame == kBefore && f.body_a == fault.body);
                others = others || f.kind != Kind::bad_pose;
                break;
            }
        }
        EXPECT_TRUE(found) << "frame " << fault.frame << ", boat " << fault.body << ": " << fault.text;
        EXPECT_FALSE(others) << "frame " << fault.frame << ", boat " << fault.body << ": " << fault.text;
        EXPECT_TRUE(report.unreadable.empty());
        return found && !others;
    }

    std::mt19937_64 rng_;
    SceneDescription scene_;
    scenario::BowlWall wall_;
    double rim_ = 0; ///< m, height
    TemporaryFolder folder_;
    io::RunScene bodies_;
    io::RunInfo info_;
    std::vector<io::Frame> frames_;
    std::set<std::tuple<FaultKind, std::int64_t, std::int32_t>> planted_;
};

inline void expect_planted_faults_are_found(int count, std::uint64_t seed) {
    PlantedRun run(seed);
    const VerifyReport clean = run.verify_clean();
    EXPECT_EQ(clean.faults.size(), 0u);
    EXPECT_TRUE(clean.proved());
    EXPECT_GT(clean.motions, 0);
    int found = 0;
    for (int k = 0; k < count; ++k) found += run.plant_and_find(static_cast<FaultKind>(k % kFaultKinds)) ? 1 : 0;
    std::printf("%d of %d planted faults found, %zu in the clean run\n", found, count, clean.faults.size());
    EXPECT_EQ(found, count);
}

} // namespace flotilla::test
