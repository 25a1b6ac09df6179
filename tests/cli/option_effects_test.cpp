// SPDX-License-Identifier: MIT
// No option of the command is dead: what each does shows in what is compared here, with it and without. The walk goes
// over --help, so that an option without a row fails as well.
#include <functional>
#include <map>
#include <regex>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "io/file.hpp"
#include "support/command.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

/// The words that start lines of the help text and match.
std::vector<std::string> words_of_help(const std::string& command, const std::string& pattern) {
    std::vector<std::string> words;
    const std::regex line_start("^  (?:-[A-Za-z],)?(" + pattern + ")(?=[\\s{].*|$)");
    std::istringstream help(run_flotilla(command + " --help").out);
    for (std::string line; std::getline(help, line);)
        if (std::smatch match; std::regex_search(line, match, line_start)) words.push_back(match[1]);
    return words;
}

/// What is compared: some part of what a command line did that depends on no clock.
using Observe = std::function<std::string(const std::string& arguments)>;

std::string all_output(const std::string& arguments) {
    const CommandOutput r = run_flotilla(arguments);
    return std::to_string(r.exit_code) + r.out + r.err;
}
std::string exit_code(const std::string& arguments) { return std::to_string(run_flotilla(arguments).exit_code); }
std::string how_much_is_printed(const std::string& arguments) {
    const CommandOutput r = run_flotilla(arguments);
    return std::string(r.out.empty() ? "" : "out ") + (r.err.empty() ? "" : "err");
}
/// The lines of the output that have `word`.
Observe lines_with(const std::string& word) {
    return [word](const std::string& arguments) {
        const CommandOutput r = run_flotilla(arguments);
        std::istringstream in(r.out + r.err);
        std::string found;
        for (std::string line; std::getline(in, line);)
            if (line.find(word) != std::string::npos) found += line + '\n';
        return found;
    };
}
/// The CSV file or table without its last column, which holds times.
std::string but_last_column(const std::string& arguments) {
    std::istringstream in(run_flotilla(arguments).out);
    std::string out;
    for (std::string line; std::getline(in, line);) out += line.substr(0, line.find_last_of(", ")) + '\n';
    return out;
}

class Options : public ::testing::Test {
  protected:
    Options() {
        folder_.write("scene.json", R"({"flotilla_scene": 1, "settings": {"time_step": 0.02, "static_iterations": 77},
            "shapes": [{"name": "block", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0.3,0.3,1]], "triangles": [[0,2,1],[0,1,3],[1,2,3],[2,0,3]], "mass": 2},
                       {"name": "ground", "vertices": [[-9,-9,0],[9,-9,0],[0,9,0]], "triangles": [[0,1,2]]}],
            "bodies": [{"name": "block", "shape": "block", "position": [0, 0, 0.05], "velocity": [1, 0.5, 0]},
                       {"name": "other", "shape": "block", "position": [0.2, 0.1, 1.2]},
                       {"name": "ground", "shape": "ground", "type": "static"}]})");
        folder_.write("ipc.json", R"({"rigid_body_problem": {"rigid_bodies": [
            {"vertices": [[0,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,2]]}]}})");
        folder_.write("edits.json", R"({"flotilla_edits": 1, "edits": [{"step": 2, "set_gravity": [1, 0, -9]}]})");
        std::string overlap = io::read_text(at("scene.json"));
        overlap.replace(overlap.find("[0.2, 0.1, 1.2]"), 15, "[0.2, 0.1, 0.1]");
        folder_.write("overlap.json", overlap);
        folder_.write(
            "queries.csv",
            "kind,x0,y0,z0,x1,y1,z1,x2,y2,z2,x3,y3,z3,x0,y0,z0,x1,y1,z1,x2,y2,z2,x3,y3,z3,expected,toi,source\n"
            "VF,0.25,0.25,1,0,0,0,1,0,0,0,1,0,0.25,0.25,0.001,0,0,0,1,0,0,0,1,0,0,,made here\n"
            "EE,-1,0,0,1,0,0,2,0,1,4,0,1,-1,0,0,1,0,0,-2,0,-1,0,0,-1,0,,made here\n");
        const std::string run = "run --quiet --steps 6 ";
        ready_ = run_flotilla(run + "--trace " + at("trace.json") + " --output " + at("run") + ' ' + at("scene.json"))
                         .exit_code == 0 &&
                 run_flotilla("export " + at("run") + " --output " + at("poses.csv")).exit_code == 0;
    }
    void SetUp() override { ASSERT_TRUE(ready_); }

    [[nodiscard]] std::string at(const std::string& name) const { return (folder_.path() / name).string(); }

    /// Adds --output FILE; the bytes of the file.
    Observe written(const std::string& name) {
        return [this, name](const std::string& arguments) {
            std::error_code ignored;
            fs::remove_all(at(name), ignored);
            (void)run_flotilla(arguments + " --output " + at(name));
            return fs::exists(at(name)) ? io::read_text(at(name)) : std::string("no file");
        };
    }
    /// Which of the files of the folder are there afterwards, that were not before.
    Observe new_files(const std::string& in = "") {
        return [this, in](const std::string& arguments) {
            const fs::path folder = folder_.path() / "files";
            fs::remove_all(folder);
            fs::create_directory(folder);
            (void)run_flotilla(arguments);
            std::vector<std::string> names;
            if (fs::exists(folder / in))
                for (const auto& file : fs::recursive_directory_iterator(folder / in)) names.push_back(file.path());
            std::sort(names.begin(), names.end());
            std::string text;
            for (const std::string& name : names) text += name + '\n';
            return text;
        };
    }
    /// The number of threads that the command starts.
    Observe threads_started() {
        return [this](const std::string& arguments) {
            const std::string count = at("threads");
            const std::string line = "ASAN_OPTIONS=verify_asan_link_order=0 THREAD_COUNT_FILE=" + count +
                                     " LD_PRELOAD=" FLOTILLA_THREAD_COUNTER " " FLOTILLA_COMMAND " " + arguments +
                                     " >/dev/null 2>&1";
            (void)!std::system(line.c_str());
            return io::read_text(count);
        };
    }
    /// run.json's number of threads.
    Observe threads_of_run() {
        return [this](const std::string& arguments) {
            (void)run_flotilla(arguments + " --overwrite --output " + at("again"));
            const std::string json = io::read_text(at("again") + "/run.json");
            const std::size_t begin = json.find("\"threads\"");
            return json.substr(begin, json.find('\n', begin) - begin);
        };
    }

    /// The lines of the first run's run.json that have `word`.
    Observe lines_of_run(const std::string& word, const std::string& scene = "scene") {
        return [this, word, scene](const std::string& arguments) {
            (void)run_flotilla(arguments + " --overwrite --output " + at("lines"));
            std::istringstream in(io::read_text(at("lines") + "/members/friction=0.1@" + scene + "/run.json"));
            std::string found;
            for (std::string line; std::getline(in, line);)
                if (line.find(word) != std::string::npos) found += line + '\n';
            return found;
        };
    }

    struct Row {
        std::string without, with; ///< arguments
        Observe observe;
    };
    using Rows = std::map<std::string, Row>; ///< by option
    Rows rows_of(const std::string& command);
    Rows run_rows();
    Rows picture_rows();
    Rows sweep_rows();

    TemporaryFolder folder_;
    bool ready_ = false;
};

Options::Rows Options::run_rows() {
    const std::string scene = at("scene.json"), run = "run " + scene + " --steps 6", quiet = run + " --quiet",
                      folder = at("files/r"), keep = run + " --output " + folder,
                      old = quiet + " --output " + at("run");
    const std::string longer = "run " + scene + " --steps 20", again = run + " --overwrite --output " + at("again");
    const Observe hash = lines_with("state hash:");
    return {{"--preset", {longer, longer + " --preset paper", hash}},
            {"--set", {run, run + " --set friction=0.9", hash}},
            {"--output", {run, keep, new_files()}},
            {"--steps", {run, run + " --steps 7", lines_with("steps,")}},
            {"--duration", {"run " + scene, "run " + scene + " --duration 0.1", lines_with("steps,")}},
            {"--dt", {run, run + " --dt 0.01", hash}},
            {"--frame-every", {keep, keep + " --frame-every 2", new_files("r")}},
            {"--overwrite", {old, old + " --overwrite", exit_code}},
            {"--resume", {old, old + " --resume", exit_code}},
            {"--checkpoint-every", {keep, keep + " --checkpoint-every 2", new_files("r")}},
            {"--time-limit", {again, again + " --time-limit 0:0:0", exit_code}},
            {"--threads", {quiet + " --threads 1", quiet + " --threads 3", threads_of_run()}},
            {"--executor",
             {quiet + " --threads 2 --executor parallel", quiet + " --threads 2 --executor serial", threads_of_run()}},
            {"--trace", {run, run + " --trace " + at("files/t.json"), new_files()}},
            {"--trace-every",
             {run + " --trace " + at("t.json"), run + " --trace " + at("t.json") + " --trace-every 3",
              lines_with("trace of")}},
            {"--contacts", {run, run + " --contacts " + at("files/c.csv"), new_files()}},
            {"--edits", {run, run + " --edits " + at("edits.json"), hash}},
            {"--pin", {run, run + " --pin", exit_code}}, // is gone, and says so
            {"--audit", {again, again + " --audit", lines_with("verdict")}},
            {"--quiet", {run, quiet, how_much_is_printed}}};
}

Options::Rows Options::picture_rows() {
    const std::string picture = "picture " + at("run") + " --supersampling 1 ",
                      small = picture + "--width 60 --height 40 ";
    const Observe png = written("p.png");
    Rows rows{{"--output", {picture, small + "--output " + at("files/p.png"), new_files()}},
              {"--width", {picture + "--height 40", small, png}},
              {"--height", {picture + "--width 60", small, png}},
              {"--supersampling", {small, "picture " + at("run") + " --width 60 --height 40 --supersampling 2", png}}};
    for (const char* option : {"--frame 0", "--step 2", "--camera-frame 0", "--azimuth 0", "--elevation 10", "--zoom 2",
                               "--field-of-view 60", "--outlines 0"}) {
        const std::string text = option;
        rows[text.substr(0, text.find(' '))] = {small, small + option, png};
    }
    const std::string step = small + "--step 20 ", out = " --output " + at("q.png");
    rows["--lines"] = {step, step + "--lines proofs", png};
    rows["--quiet"] = {step + out, step + "--quiet" + out, lines_with("to make step")};
    return rows;
}

Options::Rows Options::sweep_rows() {
    const std::string library = "sweep stack --bodies 3 --vary friction=0.1,0.2 --steps 3",
                      to = " --output " + at("files/s"),
                      of_file = "sweep " + at("scene.json") + " --vary friction=0.1,0.2",
                      sweep = of_file + " --steps 3";
    const Observe folders = new_files("s/members"), files = new_files();
    const Observe table = [](const std::string& arguments) {
        std::istringstream in(run_flotilla(arguments + " --overwrite").out);
        std::string words; // without figures, which hold times
        for (std::string word; in >> word;)
            if (std::isalpha(static_cast<unsigned char>(word.front())) != 0) words += word + ' ';
        return words;
    };
    const Observe members = [this](const std::string& arguments) {
        (void)run_flotilla(arguments + " --overwrite --output " + at("members"));
        std::istringstream in(io::read_text(at("members") + "/members.csv"));
        std::string kept; // member, point, start, state, steps
        for (std::string line; std::getline(in, line);)
            for (int k = 0; k < 5; ++k) kept += line.substr(0, line.find(',')) + ' ', line.erase(0, line.find(',') + 1);
        return kept;
    };
    const Observe threads_of_members = [this](const std::string& arguments) {
        (void)run_flotilla(arguments + " --overwrite --output " + at("threaded"));
        const std::string json = io::read_text(at("threaded") + "/sweep.json");
        return json.substr(json.find("\"threads\""), 14);
    };
    const std::string done = sweep + " --output " + at("done");
    (void)run_flotilla(done);
    return {{"--bodies", {"sweep stack --vary friction=0.1 --steps 3", library, lines_of_run("\"bodies\"", "stack")}},
            {"--vary", {sweep + to, sweep + " --vary preset=preview,balanced" + to, folders}},
            {"--seeds", {library + to, library + " --seeds 2" + to, folders}},
            {"--reference", {sweep + to, sweep + " --reference accurate" + to, folders}},
            {"--metric", {sweep + " --output " + at("m"), sweep + " --metric creep --output " + at("m"), table}},
            {"--preset", {sweep, sweep + " --preset paper", lines_of_run("tangents")}},
            {"--set", {sweep, sweep + " --set restitution=0.7", lines_of_run("restitution")}},
            {"--steps", {sweep, of_file + " --steps 4", members}},
            {"--duration", {of_file + " --duration 0.1", of_file + " --duration 0.2", members}},
            {"--dt", {of_file + " --duration 0.1", of_file + " --duration 0.1 --dt 0.01", members}},
            {"--output", {sweep, sweep + to, files}},
            {"--threads", {sweep, sweep + " --threads 2", threads_of_members}},
            {"--jobs",
             {sweep + " --overwrite --jobs 1" + to, sweep + " --overwrite --jobs 100000" + to,
              lines_with("runs at a time")}},
            {"--time-limit", {sweep + " --overwrite" + to, sweep + " --overwrite --time-limit 0:0:0" + to, exit_code}},
            {"--overwrite", {done, done + " --overwrite", exit_code}},
            {"--resume", {done, done + " --resume", exit_code}},
            {"--quiet", {done + " --resume", done + " --resume --quiet", how_much_is_printed}}};
}

Options::Rows Options::rows_of(const std::string& command) {
    const std::string scene = at("scene.json"), run = at("run");
    if (command == "run") return run_rows();
    if (command == "picture") return picture_rows();
    if (command == "sweep") return sweep_rows();
    if (command == "ccd") {
        const std::string ccd = "ccd " + at("queries.csv");
        return {{"--separation", {ccd + " --csv", ccd + " --csv --separation 0.01", but_last_column}},
                {"--method",
                 {ccd + " --csv --separation 0.01", ccd + " --csv --separation 0.01 --method cubic", but_last_column}},
                {"--csv", {ccd, ccd + " --csv", but_last_column}}};
    }
    if (command == "check") {
        const std::string check = "check " + scene, bad = "check " + at("overlap.json");
        return {{"--preset", {check, check + " --preset accurate", all_output}},
                {"--set", {bad, bad + " --set initial_overlap=separate", exit_code}},
                {"--output", {bad, bad + " --output " + at("files/o.obj"), new_files()}}};
    }
    if (command == "export") {
        const std::string to = "export " + run;
        return {{"--format", {to, to + " --format obj --output " + at("files/obj"), new_files()}},
                {"--output", {to, to + " --output " + at("files/p.csv"), new_files()}},
                {"--frames", {to, to + " --frames 1:3", all_output}}};
    }
    if (command == "plan") {
        const std::string plan = "plan " + scene;
        return {{"--preset", {plan, plan + " --preset accurate", all_output}},
                {"--set", {plan, plan + " --set friction=0", all_output}},
                {"--settings", {plan, plan + " --settings", all_output}}};
    }
    if (command == "report") {
        const std::string report = "report " + run, verified = report + " --verify";
        return {{"--output", {report, report + " --output " + at("files/r.html"), new_files()}},
                {"--verify", {report, verified, written("r.html")}},
                {"--frame-every", {report, report + " --frame-every 3", written("r.html")}},
                {"--threads", {report + " --threads 1", report + " --threads 3", threads_started()}},
                {"--quiet", {report, report + " --quiet", how_much_is_printed}}};
    }
    if (command == "import") {
        const std::string import = "import " + at("ipc.json");
        return {{"--output", {import, import + " --output " + at("files/scene.json"), new_files()}}};
    }
    if (command == "scene") {
        const std::string boats = "scene boats-in-bowl --bodies 4";
        return {{"--bodies", {boats, "scene boats-in-bowl --bodies 5", all_output}},
                {"--seed", {boats, boats + " --seed 3", all_output}},
                {"--list", {boats, boats + " --list", all_output}}};
    }
    if (command == "trace") {
        const std::string trace = "trace " + at("trace.json");
        return {{"--assume-costs", {trace, trace + " --assume-costs", all_output}},
                {"--csv", {trace, trace + " --csv", all_output}},
                {"--cores", {trace, trace + " --cores 3", all_output}},
                {"--growth", {trace, trace + " --growth linear", all_output}}};
    }
    if (command == "verify") {
        const std::string verify = "verify " + run;
        return {{"--poses", {"verify " + scene, "verify " + scene + " --poses " + at("poses.csv"), exit_code}},
                {"--motion", {verify, verify + " --motion never", lines_with("motions checked")}},
                {"--threads", {verify + " --threads 1", verify + " --threads 3", threads_started()}},
                {"--no-distance", {verify, verify + " --no-distance", lines_with("smallest distance")}},
                {"--quiet", {verify, verify + " --quiet", how_much_is_printed}}};
    }
    return {};
}

TEST_F(Options, EveryOneChangesSomething) {
    const std::vector<std::string> commands = words_of_help("", "[a-z]+");
    ASSERT_GE(commands.size(), 12u);
    for (const std::string& command : commands) {
        const Rows rows = rows_of(command);
        std::size_t known = 0;
        for (const std::string& option : words_of_help(command, "--[a-z-]+")) {
            if (option == "--help") continue;
            const auto row = rows.find(option);
            if (row == rows.end()) {
                ADD_FAILURE() << command << ' ' << option << ": nothing shows what it does";
                continue;
            }
            ++known;
            const auto& [without, with, observe] = row->second;
            EXPECT_TRUE(observe(without) != observe(with)) << command << ' ' << option << " changes nothing";
        }
        EXPECT_EQ(known, rows.size()) << command << ": a row for an option that is not there";
    }
}

} // namespace
} // namespace flotilla::test
