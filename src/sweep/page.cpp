// SPDX-License-Identifier: MIT
#include "sweep/page.hpp"

#include <algorithm>
#include <cmath>
#include <flotilla/build_info.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "io/file.hpp"
#include "report/page.hpp"
#include "run_folder/run_files.hpp"
#include "sweep/judge.hpp"
#include "sweep/plot.hpp"

namespace flotilla::sweep {
namespace {

/// More points than this are named by their numbers alone in the plots.
constexpr std::size_t kMostNames = 12;

constexpr std::string_view kStyle = R"(
.front-plot { width: 100%; height: auto; display: block; font: 12px system-ui, sans-serif; fill: var(--soft); }
.front-plot .grid { stroke: var(--grid); } .front-plot .label { fill: var(--ink); }
.front-plot .front { fill: none; stroke: var(--soft); stroke-width: 1.4; }
.front-plot .reference { stroke: var(--soft); stroke-dasharray: 4 4; }
.front-plot .ring { fill: none; stroke: var(--ink); stroke-width: 1.4; }
main > .card, #charts { margin-bottom: 14px; } .scroll { overflow-x: auto; }
.grid-table td, .grid-table th { text-align: right; white-space: nowrap; min-width: 0; padding: 3px 14px 3px 0; }
.grid-table th { color: var(--soft); font-weight: 500; vertical-align: bottom; }
.grid-table td:nth-child(2), .grid-table th:nth-child(2) { text-align: left; }
.grid-table td, .grid-table td:first-child, .grid-table td:nth-child(3) { color: var(--ink); min-width: 0; }
.grid-table .of { color: var(--soft); font-size: 12px; } .best td { font-weight: 600; }
.words td { text-align: left; }
.advice { margin: 6px 0 0; padding-left: 18px; } .advice li:first-child { font-weight: 600; }
)";

std::string cell(const std::string& text) { return "<td>" + text + "</td>"; }

std::string row_of(const std::string& name, const std::string& text, const std::string& more = "") {
    return "<tr>" + cell(escaped(name)) + cell(escaped(text)) + (more.empty() ? "" : cell(escaped(more))) + "</tr>\n";
}

std::string card(const std::string& title, const std::string& content, const std::string& style = "card") {
    return "<section class=\"" + style + "\"><h2>" + escaped(title) + "</h2>\n" + content + "</section>\n";
}

std::string list(const std::vector<std::string>& lines, const std::string& attributes) {
    std::string out = "<ul " + attributes + ">";
    for (const std::string& text : lines) out += "<li>" + escaped(text) + "</li>\n";
    return out + "</ul>\n";
}

std::string unit_of(const SweepMetric& metric) {
    return metric.unit.empty() ? std::string() : " (" + std::string(metric.unit) + ")";
}

/// The colour of a point: its value on the axis that has the most of them, unless there is one axis only.
std::size_t colour_axis(const SweepReport& report) {
    std::size_t axis = 0;
    for (std::size_t a = 1; a < report.axes.size(); ++a)
        if (report.axes[a].values.size() < report.axes[axis].values.size()) axis = a;
    return axis;
}

std::size_t colour_of(const SweepReport& report, const SweepPoint& point) {
    if (report.axes.empty() || point.values.empty()) return 0;
    const std::size_t axis = colour_axis(report);
    const auto& values = report.axes[axis].values;
    std::size_t v = 0;
    while (v + 1 < values.size() && values[v] != point.values[axis]) ++v;
    return v;
}

std::string legend(const SweepReport& report) {
    if (report.axes.empty()) return {};
    const SweepAxis& axis = report.axes[colour_axis(report)];
    std::string out = "<div class=\"legend\">";
    for (std::size_t v = 0; v < axis.values.size(); ++v)
        out += "<span><i style=\"background:" + plot_colour(v) + "\"></i>" +
               escaped(axis.key + " = " + axis.values[v]) + "</span>";
    return out + "</div>\n";
}

/// What tells a point from the others of its colour.
std::string plot_label(const SweepReport& report, std::size_t number) {
    if (report.points.size() > kMostNames) return std::to_string(number + 1);
    const SweepPoint& point = report.points[number];
    std::string text;
    for (std::size_t a = 0; a < point.values.size(); ++a) (text += text.empty() ? "" : " ") += point.values[a];
    return text;
}

std::string plot_of(const SweepReport& report, std::size_t metric, bool wide) {
    Plot plot;
    plot.x_label = "cost: time of the steps, s";
    plot.y_label = "error of " + std::string(report.metrics[metric].name) + unit_of(report.metrics[metric]);
    if (wide) plot.width = 1100, plot.height = 420;
    for (std::size_t p = 0; p < report.points.size(); ++p) {
        const SweepPoint& point = report.points[p];
        if (point.cost.starts == 0) continue;
        if (point.reference) plot.reference_x = point.cost.mean;
        const SweepValue& error = point.errors[metric];
        if (error.starts == 0 || point.reference) continue;
        plot.points.push_back({point.cost.mean, error.mean, error.spread, plot_label(report, p),
                               point.label + ": error " + with_spread(error, report.metrics[metric].unit) + ", cost " +
                                   brief(point.cost.mean) + " s",
                               colour_of(report, point), metric == report.headline && point.on_front, p == report.base,
                               within_chance(error)});
    }
    return plot.points.empty() ? std::string() : svg(plot);
}

/// That of the headline, and the others.
std::pair<std::string, std::string> plots(const SweepReport& report) {
    std::string main, others;
    for (std::size_t m = 0; m < report.metrics.size(); ++m) {
        const bool headline = m == report.headline;
        const bool lost = report.chaotic && report.metrics[m].needs_reference && !headline; // where poses say nothing
        const std::string plot = lost ? std::string() : plot_of(report, m, headline);
        if (plot.empty()) continue;
        const std::string title = (headline ? "Error against cost: " : "") + std::string(report.metrics[m].name);
        const std::string hint =
            "<p class=\"hint\">" + escaped(std::string(report.metrics[m].description)) +
            (headline ? ". Line: the front, what nothing beats in both. Ring: where changes start from. "
                        "Bars: standard error over the starts; hollow: could be chance. On the lower edge: 0."
                      : "") +
            "</p>\n";
        if (headline)
            main = card(title, legend(report) + plot + hint);
        else
            others += card(title, plot + hint);
    }
    return {main, others.empty() ? others : "<div id=\"charts\">" + others + "</div>\n"};
}

/// "0.9 % of the reference's value", where there is one to be compared with.
std::string share_text(const SweepReport& report, const SweepPoint& point, std::size_t m) {
    if (report.metrics[m].truth != SweepMetric::Truth::reference) return {};
    for (const SweepPoint& r : report.points)
        if (r.reference && r.values_of[m].mean != 0)
            return "<br><span class=\"of\">" + brief(100 * std::abs(point.errors[m].mean / r.values_of[m].mean)) +
                   " %</span>";
    return {};
}

/// A row per point; `figure` gives what stands in the column of a metric.
template <class Figure>
std::string table_of_points(const SweepReport& report, Figure&& figure) {
    std::string out = "<div class=\"scroll\"><table class=\"grid-table\"><tr><th>#</th><th>point</th><th>starts</th>"
                      "<th>cost (s)</th>";
    for (const SweepMetric& m : report.metrics)
        out += "<th title=\"" + escaped(std::string(m.description)) + "\">" +
               escaped(std::string(m.name) + unit_of(m)) + "</th>";
    out += "</tr>\n";
    for (std::size_t p = 0; p < report.points.size(); ++p) {
        const SweepPoint& point = report.points[p];
        out += std::string(point.on_front ? "<tr class=\"best\">" : "<tr>") + cell(std::to_string(p + 1)) +
               cell(escaped(point.label) + (point.reference ? " <span class=\"of\">reference</span>" : "") +
                    (p == report.base ? " <span class=\"of\">base</span>" : "")) +
               cell(std::to_string(point.complete)) + cell(with_spread(point.cost, ""));
        for (std::size_t m = 0; m < report.metrics.size(); ++m) out += cell(figure(point, m));
        out += "</tr>\n";
    }
    return out + "</table></div>";
}

std::string values_table(const SweepReport& report) {
    return table_of_points(report, [](const SweepPoint& p, std::size_t m) { return with_spread(p.values_of[m], ""); }) +
           "<p class=\"hint\">Mean ± standard deviation over the starts. Bold: on the front.</p>\n";
}

std::string errors_table(const SweepReport& report) {
    return table_of_points(report,
                           [&](const SweepPoint& p, std::size_t m) {
                               if (p.reference || p.errors[m].starts == 0) return std::string("-");
                               return with_spread(p.errors[m], "") + share_text(report, p, m);
                           }) +
           "<p class=\"hint\">Distance of the mean from the reference's, start by start, ± its standard error; in "
           "percent of the "
           "reference's value. Of position, rotation, creep and residual the value is the error.</p>\n";
}

std::string changes_table(const SweepReport& report) {
    const SweepMetric& metric = report.metrics[report.headline];
    std::string out =
        "<div class=\"scroll\"><table class=\"grid-table\"><tr><th>gain</th><th>change</th><th>error of " +
        escaped(std::string(metric.name) + unit_of(metric)) + "</th><th>x</th><th>cost (s)</th><th>x</th></tr>\n";
    for (const SweepChange& c : report.changes)
        out += "<tr>" + cell(brief(std::exp(c.gain))) + cell(escaped(c.key + ": " + c.from + " -> " + c.to)) +
               cell(with_spread(c.error_from, "") + " -> " + with_spread(c.error_to, "")) + cell(brief(c.error_ratio)) +
               cell(brief(c.cost_from.mean) + " -> " + brief(c.cost_to.mean)) + cell(brief(c.cost_ratio)) + "</tr>\n";
    return out + "</table></div><p class=\"hint\">Gain: by how much cost times error shrinks. x 1: errors within two "
                 "standard "
                 "errors, costs within 10 %, are called the same.</p>\n";
}

std::string about(const SweepReport& report, const Record& record) {
    const BuildInfo build = build_info();
    std::string out = "<table class=\"words\">" + row_of("time simulated", brief(report.duration) + " s") +
                      row_of("threads of a run", std::to_string(record.threads)) +
                      row_of("mean size of the bodies", brief(report.size) + " m") +
                      row_of("flotilla", std::string(build.version) + ", " + record.commit) +
                      row_of("compiler", std::string(build.compiler)) + row_of("processor", io::processor_name()) +
                      row_of("written", io::utc_now());
    std::string starts;
    for (const std::string& name : report.starts) (starts += starts.empty() ? "" : ", ") += name;
    std::string words;
    for (const std::string& word : record.command_line) (words += words.empty() ? "" : " ") += word;
    out += row_of("command line", words) + row_of("starts", starts) + "</table>\n<table class=\"words\">";
    for (const SweepMetric& m : report.metrics)
        out += row_of(std::string(m.name) + unit_of(m), std::string(m.description));
    return out + "</table>\n";
}

std::string badge(const std::string& text, const std::string& style = "") {
    return "<span class=\"badge " + style + "\">" + escaped(text) + "</span>\n";
}

std::string badges(const SweepReport& report) {
    const bool all = report.complete == report.members;
    const bool referred = std::any_of(report.points.begin(), report.points.end(),
                                      [](const SweepPoint& p) { return p.reference && p.complete > 0; });
    return badge(std::to_string(report.complete) + " of " + std::to_string(report.members) + " runs complete",
                 all ? "proved" : "unsure") +
           badge(std::to_string(report.points.size()) + " points, " + std::to_string(report.starts.size()) +
                 (report.starts.size() == 1 ? " start" : " starts")) +
           badge(!referred        ? "no reference"
                 : report.chaotic ? "chaotic: poses part from the reference's, statistics count"
                                  : "poses stay with the reference's");
}

} // namespace

void write_sweep_page(const std::filesystem::path& folder, const Plan& plan, const Record& record,
                      const SweepReport& report) {
    const std::string name = escaped(plan.title);
    const auto [front, others] = plots(report);
    std::string html =
        "<!doctype html>\n<!-- Written by flotilla sweep; needs no network and no other file. -->\n"
        "<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
        "<title>flotilla sweep: " +
        name + "</title>\n<style>\n";
    html.append(report::page_style()).append(kStyle);
    html += "</style></head>\n<body>\n<header><h1><span class=\"brand\">flotilla</span> sweep: " + name +
            "</h1><p id=\"badges\">" + badges(report) + "</p></header>\n";
    if (!report.problems.empty()) html += list(report.problems, "id=\"problems\"");
    html += "<main>\n" + (report.remarks.empty() ? "" : card("Remarks", list(report.remarks, ""))) +
            card("What to change first", list(report.advice, "class=\"advice\"")) + front +
            card("Points", values_table(report)) + card("Errors", errors_table(report)) +
            card("Single changes from the base", changes_table(report)) + others +
            card("About", about(report, record)) + "</main>\n</body></html>\n";
    io::write_file(folder / kSweepHtml, html);
}

} // namespace flotilla::sweep
