// SPDX-License-Identifier: MIT
// A small run with recognisable numbers.
#pragma once

#include "base/rotation.hpp"
#include "run_folder/run_folder.hpp"

namespace flotilla {

inline io::RunScene sample_scene(std::size_t bodies) {
    io::RunScene scene;
    scene.shapes.push_back({"plate", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, {1.0 / 3, 1.0 / 3, 0}});
    for (std::size_t i = 0; i < bodies; ++i)
        scene.bodies.push_back(
            {"body \"" + std::to_string(i) + "\", plate", 0, i == 0 ? BodyType::fixed : BodyType::dynamic});
    return scene;
}

inline io::RunInfo sample_info() {
    io::RunInfo info;
    info.command_line = {"flotilla", "run", "scene.json"};
    info.threads = 3;
    info.seed = 7;
    info.settings_json = R"({"friction": 0.25})";
    info.scene_json = R"({"flotilla_scene": 1})";
    info.scene_hash = 0x8000000000000001u;
    info.trajectory = Trajectory::rigid;
    info.time_step = 0.04;
    return info;
}

/// Frame k: body i at (i, k, 0.1), turned by 0.01 k about z.
struct SampleFrame {
    std::vector<Vec3> position, velocity, angular_velocity, path;
    std::vector<Quat> rotation;
    io::FrameView view;
    SampleFrame(std::size_t bodies, std::int64_t k) {
        for (std::size_t i = 0; i < bodies; ++i) {
            position.push_back({static_cast<double>(i), static_cast<double>(k), 0.1});
            rotation.push_back(rotation_from_vector({0, 0, 0.01 * static_cast<double>(k)}));
            velocity.push_back({0, 1.0 / 3, static_cast<double>(k)});
            angular_velocity.push_back({1e-300, -0.0, 0.01});
            path.push_back({0, 0, 0.01});
        }
        view = {k, 0.04 * static_cast<double>(k), position, rotation, velocity, angular_velocity, path};
    }
    SampleFrame(const SampleFrame&) = delete;
    SampleFrame& operator=(const SampleFrame&) = delete;
};

/// Of frame k: body i has i contacts, the cluster states by turns, and a cost that the files cannot hold whole from
/// frame 7 on.
inline io::Activity sample_activity(std::size_t bodies, std::int64_t k) {
    io::Activity activity;
    for (std::size_t i = 0; i < bodies; ++i)
        activity.append({static_cast<std::int64_t>(i), static_cast<ClusterState>(i % 4), 10000 * k});
    return activity;
}

/// Writes frames first..last and their rows.
inline void write_sample(io::RunWriter& writer, std::size_t bodies, std::int64_t first, std::int64_t last,
                         bool with_activity = false) {
    for (std::int64_t k = first; k <= last; ++k) {
        SampleFrame frame(bodies, k);
        const io::Activity activity = sample_activity(bodies, k);
        if (with_activity) frame.view.activity = activity.view();
        writer.add_frame(frame.view);
        StepReport row;
        row.step = k;
        if (k > 0) writer.add_step(row);
    }
}

} // namespace flotilla
