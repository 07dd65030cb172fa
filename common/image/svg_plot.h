// SPDX-License-Identifier: Apache-2.0
// Line and scatter plots as SVG text: run time against error, and the like.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace farfield {

struct PlotSeries {
  std::string name;                              // in the legend; points carry their series' colour
  std::vector<std::pair<double, double>> points;  // (x, y); points that are not finite, or not positive on a
                                                  // logarithmic axis, are left out
  bool is_connected = true;                      // a line through the points, in order
  std::optional<std::size_t> marked = {};        // index of a point with a ring around it
};

struct PlotOptions {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  int width_px = 760, height_px = 480;
};

struct PlotPanel {
  std::vector<PlotSeries> series;
  PlotOptions options;
};

/// A whole SVG document. Axes reach from the smallest to the largest value, with ticks at round numbers.
std::string render_svg_plot(const std::vector<PlotSeries>& series, const PlotOptions& options);
/// Several, side by side. A series' colour is that of its place in the list, so equal lists have equal colours.
std::string render_svg_plots(const std::vector<PlotPanel>& panels);

}  // namespace farfield
