// SPDX-License-Identifier: MIT
#include "mpi/model_command.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <limits>
#include <memory>
#include <variant>

#include <flotilla/error.hpp>
#include <flotilla/world.hpp>

#include "api/world_access.hpp"
#include "cli/scene_options.hpp"
#include "cli/value_checks.hpp"
#include "mpi/cost_model.hpp"
#include "parallel/division.hpp"

namespace flotilla::mpi {
namespace {

struct ModelArguments {
    cli::SceneArguments options;
    std::string scene;
    std::vector<int> ranks{1, 2, 4, 8, 16, 32, 64};
    std::int64_t from = 0, steps = 100;
    std::vector<double> latency{2}, bandwidth{10}; ///< us, GB/s; by network
    bool csv = false;
};

/// s, to read the clock of the log before and after a task: no rank does that.
double cost_of_clock() {
    constexpr int kReadings = 20000;
    const std::int64_t begin = thread_ns();
    for (int k = 0; k < kReadings; ++k) (void)thread_ns();
    return 2e-9 * static_cast<double>(thread_ns() - begin) / kReadings;
}

/// How many times was it read?
std::int64_t num_timed(const WorkLog& log) {
    std::int64_t n = 0;
    for (const LoggedSection& section : log.sections) {
        if (const auto* loop = std::get_if<LoggedLoop>(&section)) n += std::ssize(loop->items);
        if (const auto* sweep = std::get_if<LoggedSweep>(&section))
            n += std::ranges::count_if(sweep->tasks, [](const LoggedSweep::Task& t) { return t.ns > 0; });
        if (const auto* contacts = std::get_if<LoggedContacts>(&section); contacts && !contacts->packets.empty())
            n += contacts->sweeps * (contacts->packets.back().color + 1) + contacts->evaluations;
    }
    return n;
}

/// Before those that are counted: after so many steps owners are what they are in a run.
constexpr std::int64_t kStepsOfWeights = 6;

/// This process alone.
class OneRank : public Ranks {
  public:
    OneRank() : Ranks(0, 1) {}
    std::unique_ptr<RankExchange> prepare(std::span<const RankMessage>, std::span<const RankMessage>) override {
        throw Error("one rank has nobody to send to");
    }
    void gather(std::span<const std::byte> own, std::span<const std::size_t>, std::span<std::byte> all) override {
        std::copy(own.begin(), own.end(), all.begin());
    }
};

/// A scene stepped twice, side by side: as one process does it, and as the one rank whose work is logged.
class LoggedScene {
  public:
    explicit LoggedScene(const cli::LoadedScene& loaded)
        : alone_(loaded.scene, loaded.source, {1, Executor::serial}),
          divided_(loaded.scene, loaded.source, {1, Executor::serial}),
          division_(rank_) {
        WorldAccess::team(divided_).divide(&division_);
    }
    void skip() {
        divided_ = World(alone_.clone({1, Executor::serial}));
        WorldAccess::team(divided_).divide(&division_);
    }
    void step_alone() { alone_.step(); }
    void step(std::vector<CostModel>& models, bool counted) {
        const std::vector<Vec3> positions = centers();
        const std::vector<std::int32_t> active = awake();
        WorkLog log;
        division_.log_to(&log);
        const auto timed = [](World& world) {
            const std::int64_t begin = thread_ns();
            const StepReport report = world.step();
            return std::pair(1e-9 * static_cast<double>(thread_ns() - begin), report);
        };
        const auto [alone, report] = timed(alone_);
        const auto [divided, other] = timed(divided_);
        division_.log_to(nullptr);
        if (report.state_hash != other.state_hash) throw Error("the divided step has another state");
        if (!active.empty())
            place_ = std::min(place_, 1e-3 * report.phase_ms[static_cast<std::size_t>(Phase::position)] /
                                          static_cast<double>(active.size()));
        const double untimed =
            divided - clock_cost_ * static_cast<double>(num_timed(log)) - 1e-9 * static_cast<double>(log.own_ns);
        for (CostModel& model : models) model.add({log, positions, active, alone, untimed, place_}, counted);
    }
    [[nodiscard]] std::size_t size() const { return alone_.size(); }

  private:
    [[nodiscard]] std::vector<Vec3> centers() const {
        std::vector<Vec3> out;
        for (std::size_t i = 0; i < alone_.size(); ++i) out.push_back(alone_.body(i).center_of_mass);
        return out;
    }
    /// Bodies that cost anything: the others are nobody's.
    [[nodiscard]] std::vector<std::int32_t> awake() const {
        std::vector<std::int32_t> out;
        const std::vector<BodyActivity> did = alone_.activity();
        for (std::size_t i = 0; i < did.size(); ++i)
            if (did[i].cluster != ClusterState::asleep) out.push_back(static_cast<std::int32_t>(i));
        return out;
    }

    World alone_, divided_;
    OneRank rank_;
    Division division_;
    double clock_cost_ = cost_of_clock();
    double place_ = std::numeric_limits<double>::infinity();
};

void print_header(bool csv) {
    if (csv)
        std::puts("bodies,latency_us,gb_per_s,ranks,ms_per_step,speed_up,common_ms,divided_ms,messages,kilobytes,"
                  "gathers,gathered_kilobytes");
    else
        std::puts("us, GB/s    ranks  ms/step  speed-up  on every rank, ms  divided, ms  messages      kB  gathers  "
                  "gathered kB");
}

void print(std::size_t bodies, const CostModel& model, bool csv) {
    const ModelTotals& t = model.totals();
    const double n = static_cast<double>(t.steps);
    const auto per_step = [&](std::int64_t sum) { return static_cast<double>(sum) / n; };
    const double latency = 1e6 * model.network().latency, bandwidth = 1e-9 * model.network().bandwidth;
    if (csv)
        std::printf("%zu,%g,%g,", bodies, latency, bandwidth);
    else
        std::printf("%3g, %-5g  ", latency, bandwidth);
    std::printf(csv ? "%d,%.3f,%.3f,%.3f,%.3f,%.1f,%.1f,%.1f,%.1f\n"
                    : "%5d  %7.2f  %8.2f  %17.2f  %11.2f  %8.0f  %6.0f  %7.0f  %11.0f\n",
                model.ranks(), 1e3 * t.seconds / n, t.alone / t.seconds, 1e3 * t.common / n, 1e3 * t.work / n,
                per_step(t.messages), 1e-3 * per_step(t.bytes), per_step(t.gathers), 1e-3 * per_step(t.gathered_bytes));
}

int run_model(const ModelArguments& arguments) {
    const cli::LoadedScene loaded = cli::load_scene(arguments.scene, arguments.options.resolve());
    LoggedScene scene(loaded);
    const std::int64_t unlogged = std::max<std::int64_t>(0, arguments.from - kStepsOfWeights);
    for (std::int64_t k = 0; k < unlogged; ++k) scene.step_alone();
    if (unlogged > 0) scene.skip();
    if (arguments.latency.size() != arguments.bandwidth.size())
        throw InputError("model: as many latencies as bandwidths say what networks there are");
    const auto all = [](const auto& values, auto least) {
        return std::ranges::all_of(values, [&](auto value) { return value >= least; });
    };
    if (!all(arguments.ranks, 1) || !all(arguments.latency, 0.0) || !all(arguments.bandwidth, 1e-6))
        throw InputError("model: ranks and bandwidths must be above 0, latencies 0 or more");
    std::vector<CostModel> models;
    for (std::size_t k = 0; k < arguments.latency.size(); ++k)
        for (const int ranks : arguments.ranks)
            models.emplace_back(ranks, Network{1e-6 * arguments.latency[k], 1e9 * arguments.bandwidth[k]});
    for (std::int64_t k = unlogged; k < arguments.from + arguments.steps; ++k) scene.step(models, k >= arguments.from);
    if (!arguments.csv)
        std::printf("%zu bodies, steps %ld to %ld; per step, messages of the rank with most of them\n", scene.size(),
                    static_cast<long>(arguments.from + 1), static_cast<long>(arguments.from + arguments.steps));
    print_header(arguments.csv);
    for (const CostModel& model : models) print(scene.size(), model, arguments.csv);
    return cli::kOk;
}

} // namespace

void register_model(CLI::App& app, cli::Action& action) {
    using namespace cli;
    const auto arguments = std::make_shared<ModelArguments>();
    CLI::App* command = app.add_subcommand(
        "model", "What one scene would take on some ranks: messages, bytes and time by a log of the work of every step "
                 "and a network. Needs no mpirun");
    command->add_option("SCENE", arguments->scene, "Scene file")->required();
    add_scene_options(*command, arguments->options);
    command->add_option("--ranks", arguments->ranks, "Numbers of ranks, a list")->delimiter(',');
    command->add_option("--from", arguments->from, "Steps before those that are logged")->check(kCount);
    command->add_option("--steps", arguments->steps, "Steps that are logged")
        ->check(kPositiveCount)
        ->capture_default_str();
    command->add_option("--latency", arguments->latency, "us, of a message; of several networks a list")
        ->delimiter(',')
        ->capture_default_str();
    command->add_option("--bandwidth", arguments->bandwidth, "GB/s of a rank, likewise")
        ->delimiter(',')
        ->capture_default_str();
    command->add_flag("--csv", arguments->csv, "Print CSV");
    command->callback([arguments, &action] { action = [arguments] { return run_model(*arguments); }; });
}

} // namespace flotilla::mpi
