// SPDX-License-Identifier: MIT
// Error against cost as SVG, both axes logarithmic; colours are those of the report's page.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace flotilla::sweep {

struct PlotPoint {
    double x = 0;           ///< > 0
    double y = 0;           ///< >= 0; 0 is drawn on the lower edge
    double uncertainty = 0; ///< of y
    std::string label;      ///< beside the marker; may be empty
    std::string title;      ///< shown under the mouse
    std::size_t colour = 0; ///< points of one colour belong together
    bool front = false;     ///< joined by a line
    bool base = false;      ///< ringed
    bool hollow = false;    ///< y cannot be told from 0
};

struct Plot {
    std::string x_label, y_label;
    std::vector<PlotPoint> points;
    double reference_x = std::numeric_limits<double>::quiet_NaN(); ///< a vertical line; nan: none
    double width = 640, height = 320;                              ///< px
};

[[nodiscard]] std::string svg(const Plot& plot);

/// The colour of points with that number, as CSS.
[[nodiscard]] std::string plot_colour(std::size_t number);

/// For HTML text and attributes.
[[nodiscard]] std::string escaped(const std::string& text);

/// Round values in [low, high], low > 0, for a logarithmic axis: 1, 2 and 5 times powers of ten, or powers alone
/// where there are many.
[[nodiscard]] std::vector<double> log_ticks(double low, double high);

} // namespace flotilla::sweep
