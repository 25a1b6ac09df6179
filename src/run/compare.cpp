// SPDX-License-Identifier: MIT
#include <flotilla/compare.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include <flotilla/error.hpp>

#include "base/floating_point.hpp"
#include "base/rotation.hpp"
#include "io/number.hpp"
#include "run_folder/run_files.hpp"
#include "run_folder/run_folder.hpp"
#include "run_folder/run_inputs.hpp"
#include "run_folder/step_csv.hpp"

namespace flotilla {
namespace {

// -------------------------------------------------------------------------------------------------------------- steps

/// A stage and the columns of steps.csv that it alone, or it first, decides.
struct StageColumns {
    std::string_view stage;
    std::vector<std::string_view> columns;
};

/// Counts of work, which depend on what is remembered as well (DifferentWork).
constexpr std::array<std::string_view, 1> kWorkColumns{"pairs"};

/// In the order of the step. Two counters are sums over two stages: then the earlier one cannot be told from the later.
const std::vector<StageColumns>& stage_columns() {
    static const std::vector<StageColumns> all{
        {"stage 1 (collisions)", {"collisions"}},
        {"stage 3 or 7 (contact solves, counted together)", {"iterations", "residual"}},
        {"stage 5 (dynamic contact and failsafe)",
         {"merges", "rung_changes", "held", "kinematic_bodies", "rigid_bodies", "largest_cluster", "trigger_a",
          "trigger_b"}},
        {"stage 7 (contact points at the end poses)",
         {"contacts", "min_distance", "proximities", "pruned_end_points", "pruned_same_direction", "pruned_angle",
          "pruned_occluded"}},
        {"the end of the step (energy account, who sleeps)",
         {"energy_corrections", "energy_removed", "lift", "sleeping", "sleeping_contacts"}}};
    return all;
}

std::string earliest_stage(std::span<const ComparedValue> columns) {
    for (const auto& [stage, names] : stage_columns()) {
        std::string found;
        for (const auto& column : columns)
            if (std::find(names.begin(), names.end(), column.name) != names.end())
                found += (found.empty() ? "" : ", ") + column.name;
        if (!found.empty()) return std::string(stage) + ": " + found;
    }
    return "";
}

/// The columns that both tables have, times left out.
struct CommonColumn {
    std::string name;
    std::size_t a, b; ///< position
};
std::vector<CommonColumn> common_columns(const io::StepTable& a, const io::StepTable& b) {
    std::vector<CommonColumn> common;
    for (std::size_t i = 0; i < a.columns.size(); ++i) {
        const auto found = std::find(b.columns.begin(), b.columns.end(), a.columns[i]);
        if (found == b.columns.end() || found->ends_with("_ms")) continue;
        common.push_back({a.columns[i], i, static_cast<std::size_t>(found - b.columns.begin())});
    }
    return common;
}

class StepComparison {
  public:
    StepComparison(const io::StepTable& a, const io::StepTable& b, CompareReport& report)
        : a_(a), b_(b), report_(report), columns_(common_columns(a, b)) {
        report.steps_a = static_cast<std::int64_t>(a.rows.size());
        report.steps_b = static_cast<std::int64_t>(b.rows.size());
    }

    void run() {
        auto i = a_.rows.begin();
        auto j = b_.rows.begin();
        while (i != a_.rows.end() && j != b_.rows.end()) {
            const std::int64_t ahead = i->first - j->first;
            if (ahead == 0) compare(i->first, i->second, j->second);
            if (ahead <= 0) ++i;
            if (ahead >= 0) ++j;
        }
    }

  private:
    void compare(std::int64_t number, std::string_view row_a, std::string_view row_b) {
        ++report_.steps_compared;
        report_.last_step = number;
        if (report_.first_state) return; // later steps only follow
        const auto a = io::step_csv_fields(row_a), b = io::step_csv_fields(row_b);
        DifferentStep step;
        DifferentWork work;
        step.step = work.step = number;
        for (const auto& [name, at_a, at_b] : columns_) {
            if (at_a >= a.size() || at_b >= b.size()) continue;
            if (name == "time" && !io::parse_number(a[at_a], step.time)) step.time = 0;
            if (a[at_a] == b[at_b]) continue;
            const bool of_work = std::ranges::find(kWorkColumns, name) != kWorkColumns.end();
            (of_work ? work.columns : step.columns).push_back({name, std::string(a[at_a]), std::string(b[at_b])});
            step.state = step.state || name == "state_hash";
        }
        if (!work.columns.empty() && !report_.first_work) report_.first_work = std::move(work);
        if (step.columns.empty()) return;
        step.stage = earliest_stage(step.columns);
        if (step.state) report_.first_state = step;
        if (!report_.first_step) report_.first_step = std::move(step);
    }

    const io::StepTable &a_, &b_;
    CompareReport& report_;
    std::vector<CommonColumn> columns_;
};

// ------------------------------------------------------------------------------------------------------------- frames

/// Not ==: -0 and 0 are different bits, and NaN has the same bits as itself.
template <class T>
bool same_bits(const T& a, const T& b) {
    constexpr std::size_t kDoubles = sizeof(T) / sizeof(double);
    using Bits = std::array<std::uint64_t, kDoubles>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

double known(double difference) {
    return std::isnan(difference) ? std::numeric_limits<double>::infinity() : difference;
}

/// The recorded turn of a body into its frame, where there is one.
const Vec3* recorded_turn(const io::Frame& frame, std::int32_t body) {
    const auto found = std::lower_bound(frame.path.begin(), frame.path.end(), body,
                                        [](const io::PathRotation& p, std::int32_t i) { return p.body < i; });
    return found != frame.path.end() && found->body == body ? &found->rotation : nullptr;
}

bool same_activity(const io::Activity& a, const io::Activity& b, std::size_t i) {
    return a.empty() || b.empty() ||
           (a.contacts[i] == b.contacts[i] && a.cluster[i] == b.cluster[i] && a.cost[i] == b.cost[i]);
}

bool same_body(const io::Frame& a, const io::Frame& b, std::size_t i) {
    const Vec3 *turn_a = recorded_turn(a, static_cast<std::int32_t>(i)),
               *turn_b = recorded_turn(b, static_cast<std::int32_t>(i));
    const bool same_turn = turn_a == nullptr || turn_b == nullptr ? turn_a == turn_b : same_bits(*turn_a, *turn_b);
    return same_turn && same_activity(a.activity, b.activity, i) && same_bits(a.position[i], b.position[i]) &&
           same_bits(a.rotation[i], b.rotation[i]) && same_bits(a.velocity[i], b.velocity[i]) &&
           same_bits(a.angular_velocity[i], b.angular_velocity[i]);
}

BodyDifference difference(const io::Frame& a, const io::Frame& b, std::size_t i, const std::string& name) {
    return {static_cast<std::int32_t>(i),
            name,
            known(length(b.position[i] - a.position[i])),
            known(length(rotation_vector(b.rotation[i] * conjugate(a.rotation[i])))),
            known(length(b.velocity[i] - a.velocity[i])),
            known(length(b.angular_velocity[i] - a.angular_velocity[i])),
            !same_activity(a.activity, b.activity, i)};
}

std::optional<DifferentFrame> difference(const io::Frame& a, const io::Frame& b, const io::RunScene& scene) {
    DifferentFrame result;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        if (same_body(a, b, i)) continue;
        BodyDifference body = difference(a, b, i, scene.bodies[i].name);
        if (result.bodies++ == 0) result.first = body;
        if (result.farthest.body < 0 || body.position > result.farthest.position) result.farthest = std::move(body);
    }
    if (result.bodies == 0) return {};
    result.step = a.step;
    result.time = a.time;
    result.frame_a = a.index;
    result.frame_b = b.index;
    return result;
}

/// Compares the frames of the steps of which both runs have one.
void compare_frames(io::RunReader& a, io::RunReader& b, CompareReport& report) {
    report.frames_a = a.frames();
    report.frames_b = b.frames();
    const auto read = [&report](io::RunReader& run, std::int64_t k) -> std::optional<io::Frame> {
        try {
            return run.frame(k);
        } catch (const IoError& error) {
            if (report.unreadable.empty() || report.unreadable.back() != error.what())
                report.unreadable.emplace_back(error.what());
            return {};
        }
    };
    for (std::int64_t k = 0; k < report.frames_a; ++k) {
        const std::int64_t step = k * a.info().frame_every;
        if (step % b.info().frame_every != 0 || step / b.info().frame_every >= report.frames_b) continue;
        const auto frame_a = read(a, k), frame_b = read(b, step / b.info().frame_every);
        if (!frame_a || !frame_b) continue;
        ++report.frames_compared;
        report.last_frame_step = step;
        report.last_frame = difference(*frame_a, *frame_b, a.scene());
        if (!report.first_frame) report.first_frame = report.last_frame;
    }
}

} // namespace

CompareReport compare_runs(const std::filesystem::path& folder_a, const std::filesystem::path& folder_b) {
    const DefaultFloatingPoint environment;
    io::RunReader a(folder_a), b(folder_b);
    CompareReport report;
    for (auto& d : io::record_differences(a, b))
        (d.input ? report.inputs : report.record).push_back({d.name, d.a, d.b});
    const io::StepTable steps_a = io::read_step_table(io::read_text(folder_a / io::kStepsCsv));
    const io::StepTable steps_b = io::read_step_table(io::read_text(folder_b / io::kStepsCsv));
    StepComparison(steps_a, steps_b, report).run();
    report.same_bodies = io::same_bodies(a.scene(), b.scene());
    if (report.same_bodies) compare_frames(a, b, report);
    return report;
}

} // namespace flotilla
