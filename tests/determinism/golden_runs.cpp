// SPDX-License-Identifier: MIT
// Steps scenes of the library and compares where they end with a table of state hashes; golden_runs.csv says when it is
// right to make that anew.
//
// usage: golden_runs TABLE            compares; exit code 1: a run ended elsewhere, 77: not a platform of the table
//        golden_runs TABLE --renew    writes the hashes of this build into the table
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <flotilla/build_info.hpp>
#include <flotilla/error.hpp>
#include <flotilla/scene_library.hpp>
#include <flotilla/world.hpp>

namespace flotilla {
namespace {

constexpr int kOk = 0, kDifferent = 1, kUsage = 2, kSkipped = 77;

#if defined(__x86_64__)
constexpr std::string_view kArchitecture = "x86_64";
#elif defined(__aarch64__)
constexpr std::string_view kArchitecture = "aarch64";
#else
constexpr std::string_view kArchitecture = "of another architecture";
#endif

/// "x86_64 GNU 12": architecture, compiler and its major version.
std::string platform() {
    const std::string_view compiler = build_info().compiler;
    return std::string(kArchitecture) + ' ' + std::string(compiler.substr(0, compiler.find('.')));
}

/// One line of the table. Comments and the header are lines without a run.
struct Line {
    std::string text;
    bool run = false;
    std::string scene, settings; ///< settings: key=value, separated by spaces
    int bodies = 0;
    std::uint64_t seed = 0;
    int steps = 0;
    std::string hash;
};

struct Table {
    std::vector<Line> lines;
    std::vector<std::string> platforms;
};

Line read_run(const std::string& text) {
    std::vector<std::string> fields;
    std::istringstream in(text);
    for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
    if (fields.size() != 6) throw InputError("not a line of six fields: " + text);
    return {.text = text,
            .run = true,
            .scene = fields[0],
            .settings = fields[3],
            .bodies = std::stoi(fields[1]),
            .seed = std::stoull(fields[2]),
            .steps = std::stoi(fields[4]),
            .hash = fields[5]};
}

Table read_table(const std::string& file) {
    constexpr std::string_view kPlatform = "# platform: ";
    std::ifstream in(file);
    if (!in) throw IoError(file + ": cannot be read");
    Table table;
    bool header = false;
    for (std::string text; std::getline(in, text);) {
        if (text.starts_with(kPlatform)) table.platforms.push_back(text.substr(kPlatform.size()));
        const bool comment = text.starts_with('#');
        table.lines.push_back(comment || !header ? Line{.text = text} : read_run(text));
        header = header || !comment;
    }
    return table;
}

std::string end_of(const Line& line) {
    SceneDescription scene = make_scene(line.scene, line.bodies, line.seed);
    std::istringstream settings(line.settings);
    for (std::string setting; settings >> setting;) {
        const std::size_t equals = setting.find('=');
        if (equals == std::string::npos) throw InputError("not key=value: " + setting);
        set_setting(scene.settings, setting.substr(0, equals), setting.substr(equals + 1));
    }
    World world(scene, line.scene);
    for (int i = 0; i < line.steps; ++i) world.step();
    char hash[17];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(world.state_hash()));
    return hash;
}

std::string text_of(const Line& line, const std::string& hash) {
    return line.text.substr(0, line.text.rfind(',') + 1) + hash;
}

int renew(const std::string& file) {
    const Table table = read_table(file);
    std::ostringstream out;
    for (const Line& line : table.lines) out << (line.run ? text_of(line, end_of(line)) : line.text) << '\n';
    std::ofstream(file) << out.str();
    std::printf("%s: written by %s; compare it with the one before\n", file.c_str(), platform().c_str());
    return kOk;
}

int compare(const std::string& file) {
    const Table table = read_table(file);
    bool named = false;
    for (const std::string& name : table.platforms) named = named || name == platform();
    if (!named) {
        std::printf("skipped: the table does not name %s\n", platform().c_str());
        return kSkipped;
    }
    int runs = 0, different = 0;
    for (const Line& line : table.lines) {
        if (!line.run) continue;
        ++runs;
        const std::string hash = end_of(line);
        std::printf("%s %s\n", hash == line.hash ? "same     " : "different", text_of(line, hash).c_str());
        if (hash != line.hash) std::printf("  the table has %s\n", line.hash.c_str()), ++different;
    }
    std::printf("%d runs, %d different\n", runs, different);
    if (different > 0) std::printf("Bits have changed. The head of %s says what to do.\n", file.c_str());
    return runs > 0 && different == 0 ? kOk : kDifferent;
}

int main_of(const std::vector<std::string>& arguments) {
    try {
        if (arguments.size() == 2 && arguments[1] == "--renew") return renew(arguments[0]);
        if (arguments.size() == 1) return compare(arguments[0]);
        std::fputs("usage: golden_runs TABLE [--renew]\n", stderr);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
    return kUsage;
}

} // namespace
} // namespace flotilla

int main(int count, char** words) { return flotilla::main_of({words + 1, words + count}); }
