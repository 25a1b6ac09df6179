// SPDX-License-Identifier: MIT
// Run folders. By the first byte: a folder of a few frames of any values, which must read back to the same bits; or a
// good one with a file replaced by bytes as they are. What reads a folder is called, all or, for many more inputs in
// the same time, one of it by the same byte: all of it ends, with a report or a refusal.
#include <array>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include <flotilla/compare.hpp>
#include <flotilla/html_report.hpp>
#include <flotilla/run_folder.hpp>
#include <flotilla/verify.hpp>

#include "fuzz/checks.hpp"
#include "fuzz/input.hpp"
#include "run_folder/checkpoint.hpp"
#include "run_folder/run_files.hpp"
#include "run_folder/sample_run.hpp"

namespace {

using namespace flotilla;
namespace fs = std::filesystem;

constexpr std::size_t kBodies = 2;

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

struct Values {
    std::vector<Vec3> position, velocity, angular_velocity, path;
    std::vector<Quat> rotation;

    explicit Values(fuzz::Input& input) {
        for (std::size_t i = 0; i < kBodies; ++i) {
            position.push_back(input.vector()), velocity.push_back(input.vector());
            angular_velocity.push_back(input.vector()), path.push_back(input.vector());
            const auto w = input.take<double>();
            const Vec3 v = input.vector();
            rotation.push_back({w, v.x, v.y, v.z});
        }
    }
    [[nodiscard]] io::FrameView view(std::int64_t step) const {
        return {step, 0.04 * static_cast<double>(step), position, rotation, velocity, angular_velocity, path};
    }
};

void check_frames(const fs::path& folder, const std::vector<Values>& values) {
    io::RunReader reader(folder);
    fuzz::require(reader.frames() == static_cast<std::int64_t>(values.size()), "every frame is there");
    for (std::size_t k = 0; k < values.size(); ++k) {
        const io::Frame frame = reader.frame(static_cast<std::int64_t>(k));
        fuzz::require(same_bits(frame.position, values[k].position) && same_bits(frame.rotation, values[k].rotation) &&
                          same_bits(frame.velocity, values[k].velocity) &&
                          same_bits(frame.angular_velocity, values[k].angular_velocity),
                      "a frame reads back to the same bits");
    }
}

void write_any_values(const fs::path& folder, fuzz::Input& input) {
    io::RunInfo info = sample_info();
    info.substeps = 1 + static_cast<int>(input.below(2));
    io::RunWriter writer(folder, info, sample_scene(kBodies), io::OpenRun::overwrite);
    std::vector<Values> values;
    const std::size_t frames = 1 + input.below(3);
    for (std::size_t k = 0; k < frames; ++k) {
        values.emplace_back(input);
        const io::Activity activity = sample_activity(kBodies, static_cast<std::int64_t>(k));
        io::FrameView view = values.back().view(static_cast<std::int64_t>(k));
        view.activity = activity.view();
        writer.add_frame(view);
    }
    writer.close("complete");
    check_frames(folder, values);
}

void write_sample_run(const fs::path& folder) {
    io::RunWriter writer(folder, sample_info(), sample_scene(kBodies), io::OpenRun::overwrite);
    write_sample(writer, kBodies, 0, 3, true);
    writer.close("complete");
    io::write_checkpoint(folder, 3, std::as_bytes(std::span("the state")));
}

void replace_file(const fs::path& folder, fuzz::Input& input) {
    constexpr std::array kFiles{
        "run.json", "scene.json", "steps.csv", "meshes.h5", "frames-00000000-00000003.h5", "checkpoint-00000003.h5"};
    const char* name = kFiles[input.below(kFiles.size())];
    const std::string content = input.remaining();
    std::ofstream(folder / name, std::ios::binary) << content;
}

using Reader = void (*)(const fs::path& folder, const fs::path& other, const fs::path& out);
constexpr std::array<Reader, 9> kReaders{
    [](const fs::path& folder, const fs::path&, const fs::path&) { (void)summarize_run(folder); },
    [](const fs::path& folder, const fs::path&, const fs::path&) { (void)verify_run(folder, fuzz::one_thread()); },
    [](const fs::path& folder, const fs::path& other, const fs::path&) { (void)compare_runs(folder, other); },
    [](const fs::path& folder, const fs::path&, const fs::path&) { (void)io::read_last_checkpoint(folder); },
    [](const fs::path& folder, const fs::path&, const fs::path&) {
        std::ostringstream csv;
        export_csv(folder, csv);
    },
    [](const fs::path& folder, const fs::path&, const fs::path& out) { export_run(folder, ExportFormat::glb, out); },
    [](const fs::path& folder, const fs::path&, const fs::path& out) { export_run(folder, ExportFormat::usd, out); },
    [](const fs::path& folder, const fs::path&, const fs::path& out) { (void)write_html_report(folder, out); },
    [](const fs::path& folder, const fs::path&, const fs::path&) { // goes on after frame 1, as a resumed run does
        io::RunWriter writer(folder, sample_info(), sample_scene(kBodies), 1);
        writer.close("complete");
    }};

/// By `which`: 0 all of them, in order, else one.
void read(const fs::path& folder, const fs::path& other, std::size_t which) {
    const fs::path out = fuzz::scratch() / "out";
    const auto attempt = [&](Reader reader) { fuzz::accepted(folder.string(), [&] { reader(folder, other, out); }); };
    if (which == 0)
        for (const Reader reader : kReaders) attempt(reader);
    else
        attempt(kReaders[(which - 1) % kReaders.size()]);
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fs::path folder = fuzz::scratch() / "run", other = fuzz::scratch() / "other";
    static const bool once = (write_sample_run(other), true);
    (void)once;
    fuzz::Input input(data, size);
    const auto first = input.take<std::uint8_t>();
    if (first % 2 == 0)
        write_any_values(folder, input);
    else
        fs::copy(other, folder), replace_file(folder, input); // far less than writing it again
    read(folder, other, first / 2);
    fs::remove_all(folder);
    return 0;
}
