// SPDX-License-Identifier: MIT
// The whole matrix of extremes: extremes_matrix [PAGE.md [STEPS [PART]]], the last a part of the names of cells. Each
// cell runs in a process of its own, so that one that crashes or hangs is a cell of the page like any other. Exit code
// 1 where a promise was broken.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>

#include "extremes/apart.hpp"

namespace flotilla::extremes {
namespace {

/// Of processor time, of three runs of a cell and their audit; of a large one: after which no step begins, and in all.
constexpr int kMostSeconds = 30, kLargeSeconds = 120, kMostLargeSeconds = 900;

struct Row {
    Cell cell;
    Outcome outcome;
};

struct AxisSum {
    std::map<Verdict, int> count;
    double seconds = 0, rise = 0, drift = 0;
    std::string slowest;
    void add(const Row& row) {
        ++count[row.outcome.verdict];
        if (row.outcome.slowest_step >= seconds) seconds = row.outcome.slowest_step, slowest = row.cell.name();
        rise = std::max(rise, row.outcome.rise);
        drift = std::max(drift, row.outcome.drift);
    }
};

const char* name_of(Verdict v) {
    switch (v) {
    case Verdict::pass: return "pass";
    case Verdict::held: return "held";
    case Verdict::refused: return "refused";
    case Verdict::unended: return "unended";
    case Verdict::broken: break;
    }
    return "BROKEN";
}

void write_sums(std::ostream& out, const std::string& name, AxisSum& s) {
    out << "| " << name;
    for (const Verdict v : {Verdict::pass, Verdict::held, Verdict::refused, Verdict::unended, Verdict::broken})
        out << " | " << s.count[v];
    out << " | " << s.rise << " | " << s.drift << " | " << 1e3 * s.seconds << " | " << s.slowest << " |\n";
}

constexpr const char* kPreface =
    " steps, each with one or two axes at an extreme value, and *large* ones that are described in "
    "tests/extremes/large_cells.cpp. After every step: no two bodies intersect (exact), the motion of the step was "
    "free of passages, the state is finite, energy less lift did not rise (as a share of the largest energy of motion, "
    "or of what lift may be in all), linear momentum stayed where nothing acts from outside and the failsafe did not "
    "(as a share of all |m v|), and the hash of the state is the same in another run and on 3 threads. *held*: all "
    "this, and the failsafe reported bodies held or scripts delayed. *refused*: with a message. *unended*: the scene "
    "allows 100,000 sweeps of 100,000 hits a pair, and was stopped after 30 s. Times are of the slowest step on one "
    "thread.\n\n";

void write_page(std::ostream& out, const std::vector<Row>& rows, int steps, const std::string& part) {
    AxisSum all;
    std::map<std::string, AxisSum> axes;
    for (const Row& row : rows) {
        all.add(row);
        for (const Extreme& e : row.cell.extremes) axes[e.axis].add(row);
    }
    out.precision(3);
    out << "# The matrix of extremes\n\nWritten by `extremes_matrix"
        << (part.empty() ? "" : " PAGE " + std::to_string(steps) + " " + part)
        << "` (`ctest -L extremes`: all parts, pile, clash and large). " << rows.size() << " scenes of " << steps
        << kPreface
        << "| axis | pass | held | refused | unended | broken | worst rise | worst drift | slowest step, ms | in |\n"
        << "|---|---|---|---|---|---|---|---|---|---|\n";
    write_sums(out, "all", all);
    for (auto& [name, sum] : axes) write_sums(out, name, sum);
    out << "\n| cell | outcome | slowest step, ms | |\n|---|---|---|---|\n";
    for (const Row& row : rows)
        out << "| " << row.cell.name() << " | " << name_of(row.outcome.verdict) << " | "
            << 1e3 * row.outcome.slowest_step << " | " << row.outcome.message << " |\n";
}

Outcome outcome_of(const Cell& cell, int steps) {
    if (cell.own_scene) {
        const CheckOptions options{.steps = steps, .seconds = kLargeSeconds};
        return run_apart([&] { return run_scene(cell.scene(), options); }, kMostLargeSeconds);
    }
    Outcome o = run_apart([&] { return run_cell(cell, steps); }, kMostSeconds);
    const auto is_own_limit = [](const Extreme& e) { return e.axis == "iterations" && e.value == "100000"; };
    if (o.late && std::ranges::any_of(cell.extremes, is_own_limit)) o.verdict = Verdict::unended;
    return o;
}

int run(const char* page, int steps, const std::string& part) {
    std::vector<Row> rows;
    int broken = 0;
    std::vector<Cell> cells = all_cells();
    std::ranges::move(large_cells(), std::back_inserter(cells));
    for (Cell& cell : cells) {
        if (cell.name().find(part) == std::string::npos) continue;
        const Outcome outcome = outcome_of(cell, steps);
        if (outcome.verdict == Verdict::broken) {
            ++broken;
            std::cout << cell.name() << ": " << outcome.message << std::endl;
        }
        rows.push_back({std::move(cell), outcome});
    }
    std::cout << rows.size() << " cells, " << broken << " broken\n";
    if (page != nullptr) {
        std::ofstream out(page);
        write_page(out, rows, steps, part);
    }
    return broken == 0 ? 0 : 1;
}

} // namespace
} // namespace flotilla::extremes

int main(int argc, char** argv) {
    return flotilla::extremes::run(argc > 1 ? argv[1] : nullptr, argc > 2 ? std::atoi(argv[2]) : 10,
                                   argc > 3 ? argv[3] : "");
}
