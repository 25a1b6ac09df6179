// SPDX-License-Identifier: MIT
#include "sweep/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace flotilla::sweep {
namespace {

constexpr double kLeft = 70, kRight = 18, kTop = 14, kBottom = 44; // px
constexpr double kLetter = 6.4, kLine = 13;                        // px, of labels

std::string px(double x) {
    char text[24];
    std::snprintf(text, sizeof text, "%.1f", x);
    return text;
}

std::string tick_text(double value) {
    char text[24];
    std::snprintf(text, sizeof text, "%.12g", value);
    if (value >= 1e-3 && value < 1e5) return text;
    std::snprintf(text, sizeof text, "%.0e", value);
    return text;
}

/// A logarithmic axis; its ends leave room around the values.
class Axis {
  public:
    Axis(double least, double most, double from, double to) : from_(from), to_(to) {
        const double room = std::max(0.08 * std::log(most / least), std::log(1.4));
        low_ = std::log(least) - room;
        high_ = std::log(most) + room;
    }
    [[nodiscard]] double at(double value) const {
        if (value <= 0) return from_;
        const double part = std::clamp((std::log(value) - low_) / (high_ - low_), 0.0, 1.0);
        return from_ + part * (to_ - from_);
    }
    [[nodiscard]] std::vector<double> ticks() const { return log_ticks(std::exp(low_), std::exp(high_)); }

  private:
    double low_, high_, from_, to_;
};

std::pair<double, double> range(const std::vector<double>& values) {
    double least = 0, most = 0;
    for (const double v : values) {
        if (!(v > 0)) continue;
        least = least == 0 ? v : std::min(least, v);
        most = std::max(most, v);
    }
    return least > 0 ? std::pair(least, most) : std::pair(0.1, 1.0);
}

struct Box {
    double x0, y0, x1, y1;
    [[nodiscard]] bool meets(const Box& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

/// Labels beside their markers, where they hide neither another one nor a marker; left out where there is no such
/// place.
class Labels {
  public:
    explicit Labels(const Plot& plot) : inside_{kLeft, kTop, plot.width, plot.height - kBottom} {}

    void keep_clear(double x, double y) { taken_.push_back({x - 6, y - 6, x + 6, y + 6}); }
    std::string place(double x, double y, const std::string& text) {
        const double width = kLetter * static_cast<double>(text.size());
        const std::array<std::pair<double, double>, 6> corners{{{x + 13, y - kLine / 2},
                                                                {x - 13 - width, y - kLine / 2},
                                                                {x - width / 2, y - 12 - kLine},
                                                                {x - width / 2, y + 12},
                                                                {x + 8, y - 9 - kLine},
                                                                {x + 8, y + 9}}};
        for (const auto& [left, top] : corners) {
            const Box box{left, top, left + width, top + kLine};
            const bool in =
                box.x0 >= inside_.x0 && box.x1 <= inside_.x1 && box.y0 >= inside_.y0 && box.y1 <= inside_.y1;
            if (!in || std::any_of(taken_.begin(), taken_.end(), [&](const Box& b) { return b.meets(box); })) continue;
            taken_.push_back(box);
            return "<text x=\"" + px(left) + "\" y=\"" + px(top + kLine - 3) + "\" class=\"label\">" + escaped(text) +
                   "</text>\n";
        }
        return {};
    }

  private:
    Box inside_;
    std::vector<Box> taken_;
};

std::string line(double x0, double y0, double x1, double y1, const std::string& style) {
    return "<line x1=\"" + px(x0) + "\" y1=\"" + px(y0) + "\" x2=\"" + px(x1) + "\" y2=\"" + px(y1) + "\" class=\"" +
           style + "\"/>\n";
}

std::string text_at(double x, double y, const std::string& anchor, const std::string& text,
                    const std::string& more = "") {
    return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" + escaped(text) +
           "</text>\n";
}

std::string axes(const Plot& plot, const Axis& x, const Axis& y) {
    const double right = plot.width - kRight, bottom = plot.height - kBottom;
    std::string out;
    for (const double tick : x.ticks())
        out += line(x.at(tick), kTop, x.at(tick), bottom, "grid") +
               text_at(x.at(tick), bottom + 16, "middle", tick_text(tick));
    for (const double tick : y.ticks())
        out += line(kLeft, y.at(tick), right, y.at(tick), "grid") +
               text_at(kLeft - 7, y.at(tick) + 4, "end", tick_text(tick));
    out += text_at((kLeft + right) / 2, plot.height - 8, "middle", plot.x_label);
    const double middle = (kTop + bottom) / 2;
    return out + text_at(14, middle, "middle", plot.y_label, " transform=\"rotate(-90 14 " + px(middle) + ")\"");
}

std::string front(const Plot& plot, const Axis& x, const Axis& y) {
    std::vector<const PlotPoint*> points;
    for (const PlotPoint& p : plot.points)
        if (p.front) points.push_back(&p);
    std::stable_sort(points.begin(), points.end(), [](const auto* a, const auto* b) { return a->x < b->x; });
    std::string out = "<polyline class=\"front\" points=\"";
    for (const PlotPoint* p : points) out += px(x.at(p->x)) + "," + px(y.at(p->y)) + " ";
    return out + "\"/>\n";
}

std::string marker(const PlotPoint& p, const Axis& x, const Axis& y) {
    const double cx = x.at(p.x), cy = y.at(p.y);
    const std::string at = " cx=\"" + px(cx) + "\" cy=\"" + px(cy) + "\"";
    const std::string colour = plot_colour(p.colour);
    std::string out = "<g><title>" + escaped(p.title) + "</title>\n";
    if (p.uncertainty > 0)
        out += "<line x1=\"" + px(cx) + "\" x2=\"" + px(cx) + "\" y1=\"" + px(y.at(p.y - p.uncertainty)) + "\" y2=\"" +
               px(y.at(p.y + p.uncertainty)) + "\" stroke=\"" + colour + "\" stroke-width=\"1.4\" opacity=\"0.6\"/>\n";
    out += "<circle r=\"5\"" + at + " stroke=\"" + colour + "\" stroke-width=\"2\" fill=\"" +
           (p.hollow ? "var(--card)" : colour) + "\"/>\n";
    if (p.base) out += "<circle r=\"10\"" + at + " class=\"ring\"/>\n";
    return out + "</g>\n";
}

} // namespace

std::string plot_colour(std::size_t number) {
    static constexpr std::array kColours{"#3b82c4", "#e08a2e", "#3aa17e", "#c9503f", "#8a63b8",
                                         "#d4a72c", "#7d8894", "#3fa9b8", "#b85c8a"};
    return kColours[number % kColours.size()];
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) switch (c) {
        case '<': out += "&lt;"; break;
        case '>': out += "&gt;"; break;
        case '&': out += "&amp;"; break;
        case '"': out += "&quot;"; break;
        default: out += c;
        }
    return out;
}

std::vector<double> log_ticks(double low, double high) {
    const double decades = std::log10(high / low);
    std::vector<double> ticks;
    const int every = std::max(1, static_cast<int>(std::ceil(decades / 6)));
    for (int k = static_cast<int>(std::floor(std::log10(low))); std::pow(10.0, k) <= high; ++k)
        for (const double m : {1.0, 2.0, 5.0}) {
            if (m != 1 && decades > 2.5) continue;
            if (decades > 2.5 && k % every != 0) continue;
            if (const double value = m * std::pow(10.0, k); value >= low && value <= high) ticks.push_back(value);
        }
    return ticks;
}

std::string svg(const Plot& plot) {
    std::vector<double> xs, ys;
    for (const PlotPoint& p : plot.points) {
        xs.push_back(p.x);
        ys.insert(ys.end(), {p.y, p.y + p.uncertainty});
    }
    const bool marked = plot.reference_x > 0;
    if (marked) xs.push_back(plot.reference_x);
    const auto [x0, x1] = range(xs);
    const auto [y0, y1] = range(ys);
    const Axis x(x0, x1, kLeft, plot.width - kRight), y(y0, y1, plot.height - kBottom, kTop);
    std::string out = "<svg class=\"front-plot\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + px(plot.width) +
                      " " + px(plot.height) + "\" role=\"img\">\n" + axes(plot, x, y);
    if (marked) {
        const double at = x.at(plot.reference_x);
        out += line(at, kTop, at, plot.height - kBottom, "reference") +
               text_at(at - 5, kTop + 12, "end", "cost of the reference");
    }
    out += front(plot, x, y);
    for (const PlotPoint& p : plot.points) out += marker(p, x, y);
    Labels labels(plot);
    for (const PlotPoint& p : plot.points) labels.keep_clear(x.at(p.x), y.at(p.y));
    for (const PlotPoint& p : plot.points)
        if (!p.label.empty()) out += labels.place(x.at(p.x), y.at(p.y), p.label);
    return out + "</svg>\n";
}

} // namespace flotilla::sweep
