// SPDX-License-Identifier: MIT
// flotilla_energy_survey: does energy grow by itself, in any of many scenes? Random ones (--random N, from a seed) and
// scene files are run for some steps each, one process per scene, so that none can end or delay the survey. See
// energy_record.hpp for what is measured. Data goes to files and the summary to stdout; progress goes to stderr.
#include <CLI/CLI.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "energy_record.hpp"
#include "energy_tables.hpp"
#include "random_scene.hpp"

namespace {

using namespace flotilla;
using namespace flotilla::survey;
using Clock = std::chrono::steady_clock;

struct Arguments {
    std::uint64_t seed = 1;
    std::int64_t random = 0, only = -1, first = 0, steps = 40, scene_steps = 300;
    int jobs = 1;
    double dt = 0, seconds = 60;
    std::vector<std::string> scenes;
    std::string output, write;
};

/// One scene of the survey: a file, or a random one by its index.
struct Task {
    std::int64_t index = -1;
    std::string file;
};

std::vector<Task> list_tasks(const Arguments& arguments) {
    std::vector<Task> tasks;
    if (arguments.only >= 0) tasks.push_back({arguments.only, {}});
    for (std::int64_t k = 0; k < arguments.random; ++k) tasks.push_back({arguments.first + k, {}});
    for (const std::string& file : arguments.scenes) tasks.push_back({-1, file});
    return tasks;
}

/// What is known without running it.
EnergyRecord record_of(const Task& task) {
    EnergyRecord record;
    record.index = task.index;
    if (task.index >= 0) {
        set_text(record.group, "random");
    } else {
        const std::filesystem::path file = std::filesystem::absolute(task.file);
        set_text(record.group, file.parent_path().filename().string());
        set_text(record.name, file.stem().string());
    }
    return record;
}

SceneDescription make_scene(const Arguments& arguments, const Task& task, EnergyRecord& record) {
    SceneDescription scene;
    if (task.index >= 0) {
        RandomScene random = make_random_scene(arguments.seed, static_cast<std::uint64_t>(task.index));
        set_text(record.name, random.kinds);
        set_text(record.place, random.place);
        scene = std::move(random.scene);
    } else {
        scene = read_scene(task.file);
    }
    if (arguments.dt > 0) scene.settings.time_step = arguments.dt;
    return scene;
}

EnergyRecord run_task(const Arguments& arguments, const Task& task) {
    EnergyRecord record = record_of(task);
    try {
        const std::int64_t steps = task.index >= 0 ? arguments.steps : arguments.scene_steps;
        record_energy(make_scene(arguments, task, record), steps, arguments.seconds, record);
    } catch (const std::exception& error) {
        set_text(record.failure, error.what());
    }
    return record;
}

/// Processes, each with one scene. A record fits a pipe's buffer, so that no process waits to be read.
class Workers {
  public:
    explicit Workers(const Arguments& arguments) : arguments_(arguments) {}

    [[nodiscard]] std::size_t running() const { return running_.size(); }

    void start(const Task& task, std::size_t slot) {
        static_assert(std::is_trivially_copyable_v<EnergyRecord> && sizeof(EnergyRecord) <= 4096);
        int ends[2];
        if (pipe(ends) != 0) throw IoError("cannot make a pipe");
        const pid_t process = fork();
        if (process < 0) throw IoError("cannot start a process");
        if (process == 0) {
            // A step cannot be interrupted from within: one that never ends takes the process with it.
            alarm(static_cast<unsigned>(std::ceil(4 * arguments_.seconds)));
            const EnergyRecord record = run_task(arguments_, task);
            const bool sent = ::write(ends[1], &record, sizeof(record)) == static_cast<ssize_t>(sizeof(record));
            _exit(sent ? 0 : 1);
        }
        close(ends[1]);
        running_[process] = {slot, ends[0]};
    }

    /// Waits for any scene to end; its slot, and its record where there is one.
    std::size_t finish(const std::vector<Task>& tasks, std::vector<EnergyRecord>& records) {
        int status = 0;
        const pid_t process = wait(&status);
        const auto found = running_.find(process);
        if (found == running_.end()) throw IoError("lost a process");
        const auto [slot, pipe_end] = found->second;
        running_.erase(found);
        if (read(pipe_end, &records[slot], sizeof(EnergyRecord)) != static_cast<ssize_t>(sizeof(EnergyRecord))) {
            records[slot] = record_of(tasks[slot]);
            set_text(records[slot].failure, WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM
                                                ? "a step took too long"
                                                : "the process ended with status " + std::to_string(status));
        }
        close(pipe_end);
        return slot;
    }

  private:
    struct Running {
        std::size_t slot;
        int pipe_end;
    };
    const Arguments& arguments_;
    std::map<pid_t, Running> running_;
};

void save(const Arguments& arguments, const std::vector<EnergyRecord>& records, const std::vector<bool>& done) {
    if (arguments.output.empty()) return;
    std::vector<EnergyRecord> finished;
    for (std::size_t i = 0; i < records.size(); ++i)
        if (done[i]) finished.push_back(records[i]);
    std::ofstream file(arguments.output);
    write_csv(file, finished);
    if (!file.flush()) throw IoError("cannot write " + arguments.output);
}

/// Runs all; what is done is saved on the way.
std::vector<EnergyRecord> run_all(const Arguments& arguments, const std::vector<Task>& tasks) {
    std::vector<EnergyRecord> records(tasks.size());
    std::vector<bool> done(tasks.size());
    Workers workers(arguments);
    const Clock::time_point began = Clock::now();
    double told = 0;
    for (std::size_t next = 0, finished = 0; finished < tasks.size(); ++finished) {
        for (; next < tasks.size() && workers.running() < static_cast<std::size_t>(arguments.jobs); ++next)
            workers.start(tasks[next], next);
        done[workers.finish(tasks, records)] = true;
        const double now = std::chrono::duration<double>(Clock::now() - began).count();
        if (now < told + 5 && finished + 1 < tasks.size()) continue;
        told = now;
        const auto rising = std::count_if(records.begin(), records.end(), rises);
        std::cerr << "energy survey: " << finished + 1 << " of " << tasks.size() << " scenes, " << rising
                  << " with a rise, " << static_cast<std::int64_t>(now) << " s\n";
        save(arguments, records, done);
    }
    return records;
}

void write_random_scene(const Arguments& arguments) {
    std::ofstream file(arguments.write);
    write_scene(file, make_random_scene(arguments.seed, static_cast<std::uint64_t>(arguments.only)).scene);
    if (!file.flush()) throw IoError("cannot write " + arguments.write);
}

int survey_energy(const Arguments& arguments) {
    if (!arguments.write.empty()) {
        write_random_scene(arguments);
        return 0;
    }
    const std::vector<EnergyRecord> records = run_all(arguments, list_tasks(arguments));
    write_summary(std::cout, records);
    const auto bad = [](const EnergyRecord& r) { return rises(r) || r.failure[0] != '\0'; };
    return std::any_of(records.begin(), records.end(), bad) ? 3 : 0;
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"Does energy grow by itself in any of many scenes?", "flotilla_energy_survey"};
    app.footer("exit code: 0 no rise, 2 usage, 3 a rise or a failure, 5 a file cannot be written");
    Arguments arguments;
    app.add_option("--random", arguments.random, "Random scenes")->check(CLI::NonNegativeNumber);
    app.add_option("--first", arguments.first, "Index of the first of them")->check(CLI::NonNegativeNumber);
    app.add_option("--seed", arguments.seed, "Of the random scenes");
    CLI::Option* only = app.add_option("--only", arguments.only, "One random scene, by its index")
                            ->check(CLI::NonNegativeNumber)
                            ->excludes("--random");
    app.add_option("--write", arguments.write, "Write the scene of --only as JSON instead of running it")->needs(only);
    app.add_option("--scene", arguments.scenes, "Scene files; their folder names their group");
    app.add_option("--steps", arguments.steps, "Of each random scene")->check(CLI::PositiveNumber);
    app.add_option("--scene-steps", arguments.scene_steps, "Of each scene file")->check(CLI::PositiveNumber);
    app.add_option("--dt", arguments.dt, "Time step, s (default: the scene's)")->check(CLI::PositiveNumber);
    app.add_option("--seconds", arguments.seconds,
                   "A scene ends early after this time; a step of four times it is a failure")
        ->check(CLI::PositiveNumber);
    app.add_option("--jobs", arguments.jobs, "Scenes at a time")->check(CLI::PositiveNumber);
    app.add_option("--output", arguments.output, "Table of all scenes, CSV");
    CLI11_PARSE(app, argc, argv);
    try {
        return survey_energy(arguments);
    } catch (const InputError& error) {
        std::cerr << "flotilla_energy_survey: " << error.what() << '\n';
        return 2;
    } catch (const IoError& error) {
        std::cerr << "flotilla_energy_survey: " << error.what() << '\n';
        return 5;
    }
}
