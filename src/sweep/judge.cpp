// SPDX-License-Identifier: MIT
#include "sweep/judge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace flotilla::sweep {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Beyond this part of the bodies' size the nearest point has lost the reference's motion: what is left is how far
/// apart two bodies of the pile may lie.
constexpr double kApart = 0.1;

/// Errors below this part of a metric's scale count as this part: what rounding leaves after thousands of steps is no
/// choice.
constexpr double kLeastError = 1e-9;

/// s. What a process does first (pages, caches, clock of the core) takes milliseconds.
constexpr double kShortCost = 0.1;

/// Differences within so many standard errors are called chance.
constexpr double kChance = 2;

std::vector<double> values_of(const std::vector<std::optional<Measures>>& members, std::size_t metric) {
    std::vector<double> out;
    for (const auto& m : members) out.push_back(m ? m->values[metric] : kNone);
    return out;
}

std::vector<SweepPoint> points_of(const Plan& plan, const Measured& measured, const std::vector<std::size_t>& metrics) {
    std::vector<SweepPoint> points;
    const auto reference = plan.reference();
    for (std::size_t p = 0; p < plan.points.size(); ++p) {
        const Point& point = plan.points[p];
        SweepPoint out{point.label, point.values, point.reference, 0, {}, {}, {}, false};
        std::vector<double> costs;
        for (const auto& m : measured[p]) costs.push_back(m ? m->cost : kNone);
        out.cost = statistics(costs);
        out.complete = out.cost.starts;
        for (const std::size_t m : metrics) {
            const SweepMetric& metric = sweep_metrics()[m];
            const std::vector<double> values = values_of(measured[p], m);
            const std::vector<double> truths =
                reference ? values_of(measured[*reference], m) : std::vector<double>(values.size(), kNone);
            out.values_of.push_back(statistics(values));
            out.errors.push_back(error_of(metric, values, truths));
        }
        points.push_back(std::move(out));
    }
    return points;
}

/// Poses tell how far two runs are apart until they have lost each other.
bool is_chaotic(const Plan& plan, const Measured& measured, double size) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < plan.points.size(); ++p)
        if (!plan.points[p].reference) {
            const SweepValue apart = statistics(values_of(measured[p], position));
            if (apart.starts > 0) nearest = std::min(nearest, apart.mean);
        }
    return std::isfinite(nearest) && nearest > kApart * size;
}

bool has_errors(const SweepReport& report, std::size_t metric) {
    return std::any_of(report.points.begin(), report.points.end(),
                       [&](const SweepPoint& p) { return !p.reference && p.errors[metric].starts > 0; });
}

/// What was asked for first; else poses where they say something, height where they do not, and without a reference
/// what needs none.
std::size_t choose_headline(const SweepReport& report, bool asked) {
    std::vector<std::string_view> order{report.chaotic ? "height" : "position", "height", "residual"};
    if (asked) order.insert(order.begin(), report.metrics.front().name);
    for (const std::string_view name : order)
        for (std::size_t m = 0; m < report.metrics.size(); ++m)
            if (report.metrics[m].name == name && has_errors(report, m)) return m;
    for (std::size_t m = 0; m < report.metrics.size(); ++m)
        if (has_errors(report, m)) return m;
    return 0;
}

bool comparable(const SweepPoint& p, std::size_t metric) {
    return !p.reference && p.cost.starts > 0 && p.errors[metric].starts > 0;
}

void mark_front(double least, SweepReport& report) {
    const auto error_at = [&](const SweepPoint& p) { return std::max(p.errors[report.headline].mean, least); };
    for (SweepPoint& p : report.points) {
        if (!comparable(p, report.headline)) continue;
        const double cost = p.cost.mean, error = error_at(p);
        p.on_front = std::none_of(report.points.begin(), report.points.end(), [&](const SweepPoint& q) {
            if (&q == &p || !comparable(q, report.headline)) return false;
            const double c = q.cost.mean, e = error_at(q);
            return c <= cost && e <= error && (c < cost || e < error);
        });
    }
}

double cost_ratio(double from, double to) {
    const double ratio = to / from;
    return std::abs(std::log(ratio)) < std::log1p(kSameCost) ? 1 : ratio;
}

double error_ratio(const SweepValue& from, const SweepValue& to, double least) {
    if (std::abs(to.mean - from.mean) <= kChance * std::hypot(from.spread, to.spread)) return 1;
    return std::max(to.mean, least) / std::max(from.mean, least);
}

/// Every other value of one axis at the base.
void add_changes(const Plan& plan, std::size_t axis, std::size_t stride, double least, SweepReport& report) {
    const std::vector<std::string>& values = plan.axes[axis].values;
    const std::size_t m = report.headline, at = plan.base / stride % values.size();
    const SweepPoint& from = report.points[plan.base];
    for (std::size_t v = 0; v < values.size(); ++v) {
        const SweepPoint& to = report.points[plan.base - at * stride + v * stride];
        if (v == at || !comparable(from, m) || !comparable(to, m)) continue;
        SweepChange change{plan.axes[axis].key,
                           values[at],
                           values[v],
                           cost_ratio(from.cost.mean, to.cost.mean),
                           error_ratio(from.errors[m], to.errors[m], least),
                           0,
                           from.cost,
                           to.cost,
                           from.errors[m],
                           to.errors[m]};
        change.gain = -std::log(change.cost_ratio * change.error_ratio);
        report.changes.push_back(std::move(change));
    }
}

void find_changes(const Plan& plan, double least, SweepReport& report) {
    std::size_t stride = 1;
    for (std::size_t axis = plan.axes.size(); axis-- > 0;) {
        add_changes(plan, axis, stride, least, report);
        stride *= plan.axes[axis].values.size();
    }
    std::stable_sort(report.changes.begin(), report.changes.end(),
                     [](const SweepChange& a, const SweepChange& b) { return a.gain > b.gain; });
}

std::string times(double ratio) { return ratio >= 1 ? "x " + brief(ratio) : "/ " + brief(1 / ratio); }

std::string figures(const SweepReport& report, const SweepChange& c) {
    const SweepMetric& metric = report.metrics[report.headline];
    const std::string error = "error of " + std::string(metric.name) + " " + with_spread(c.error_from, metric.unit) +
                              " -> " + with_spread(c.error_to, metric.unit) +
                              (c.error_ratio == 1 ? " (the same)" : " (" + times(c.error_ratio) + ")");
    return c.key + " from " + c.from + " to " + c.to + ": " + error + ", cost " + brief(c.cost_from.mean) + " s -> " +
           brief(c.cost_to.mean) + " s" + (c.cost_ratio == 1 ? " (the same)" : " (" + times(c.cost_ratio) + ")");
}

template <class Good>
const SweepChange* best(const SweepReport& report, Good&& good, double SweepChange::*least) {
    const SweepChange* found = nullptr;
    for (const SweepChange& c : report.changes)
        if (good(c) && (found == nullptr || c.*least < found->*least)) found = &c;
    return found;
}

void advise(SweepReport& report) {
    const auto say = [&](const std::string& text) { report.advice.push_back(text); };
    if (report.changes.empty()) {
        say("No advice: it takes the complete runs of two points beside the reference, and an error (give "
            "--reference).");
        return;
    }
    const SweepChange& first = report.changes.front();
    // Equal terms: what costs as much more as it errs less gains nothing.
    if (first.gain > std::log1p(kSameCost))
        say("Change first: " + figures(report, first));
    else
        say("Change nothing first: from " + report.points[report.base].label +
            " no single change makes cost times error smaller by 10 %. The nearest: " + figures(report, first));
    if (report.points[report.base].cost.mean < kShortCost)
        say("Runs of " + brief(report.points[report.base].cost.mean) +
            " s are too short for true times: simulate longer.");
    const SweepChange* cheaper = best(
        report, [](const SweepChange& c) { return c.error_ratio <= 1 && c.cost_ratio < 1; }, &SweepChange::cost_ratio);
    const SweepChange* better = best(
        report, [](const SweepChange& c) { return c.error_ratio < 1; }, &SweepChange::error_ratio);
    if (cheaper != nullptr && cheaper != &first) say("Cheapest without more error: " + figures(report, *cheaper));
    if (better != nullptr && better != &first) say("Least error by one change: " + figures(report, *better));
    const bool equal = std::all_of(report.changes.begin(), report.changes.end(),
                                   [](const SweepChange& c) { return c.error_ratio == 1; });
    if (equal && report.chaotic && report.starts.size() > 1)
        say("No two of these errors differ by more than chance over " + std::to_string(report.starts.size()) +
            " starts: it takes more starts to tell them apart.");
    if (report.starts.size() < 2 && report.chaotic)
        say("The runs are chaotic and have one start: what is chance and what is error cannot be told apart. Give "
            "several "
            "(--seeds, or several scenes).");
}

} // namespace

SweepValue statistics(const std::vector<double>& values) {
    SweepValue out{0, 0, 0};
    for (const double v : values)
        if (!std::isnan(v)) ++out.starts, out.mean += v;
    if (out.starts == 0) return {kNone, 0, 0};
    out.mean /= out.starts;
    double sum = 0;
    for (const double v : values)
        if (!std::isnan(v)) sum += (v - out.mean) * (v - out.mean);
    if (out.starts > 1) out.spread = std::sqrt(sum / (out.starts - 1));
    return out;
}

SweepValue error_of(const SweepMetric& metric, const std::vector<double>& values, const std::vector<double>& truths) {
    std::vector<double> differences = values;
    if (metric.truth == SweepMetric::Truth::reference)
        for (std::size_t i = 0; i < differences.size(); ++i) differences[i] -= truths[i];
    SweepValue error = statistics(differences);
    error.mean = std::abs(error.mean);
    if (error.starts > 0) error.spread /= std::sqrt(error.starts);
    return error;
}

bool within_chance(const SweepValue& error) { return error.starts > 1 && error.mean <= kChance * error.spread; }

std::string brief(double value) {
    if (std::isnan(value)) return "-";
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return text;
}

std::string with_spread(const SweepValue& value, std::string_view unit) {
    if (value.starts == 0) return "-";
    std::string text = brief(value.mean);
    if (value.starts > 1) text += " ± " + brief(value.spread);
    if (!unit.empty()) (text += ' ') += unit;
    return text;
}

void judge(const Plan& plan, const Problem& problem, const Measured& measured, const std::vector<std::size_t>& wanted,
           SweepReport& report) {
    std::vector<std::size_t> metrics = wanted;
    if (metrics.empty())
        for (std::size_t m = 0; m < kMetrics; ++m)
            if (plan.reference() || !sweep_metrics()[m].needs_reference) metrics.push_back(m);
    for (const std::size_t m : metrics) report.metrics.push_back(sweep_metrics()[m]);
    report.points = points_of(plan, measured, metrics);
    report.base = plan.base;
    report.chaotic = is_chaotic(plan, measured, report.size);
    report.headline = choose_headline(report, !wanted.empty());
    const double least = kLeastError * problem.scale_of(metrics[report.headline], plan.duration);
    mark_front(least, report);
    find_changes(plan, least, report);
    advise(report);
}

} // namespace flotilla::sweep
