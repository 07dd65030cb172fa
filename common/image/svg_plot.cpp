// SPDX-License-Identifier: Apache-2.0
#include "common/image/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

namespace farfield {
namespace {

// Colours that differ in lightness too, for readers who do not tell red from green.
constexpr std::array<const char*, 14> kColours{"#1f5fa8", "#d9541e", "#2a9d5c", "#8a4fb0", "#c99a00", "#00879b", "#b0305c",
                                               "#5a5a5a", "#7fb0e6", "#f2a37c", "#123f1e", "#c9a6e6", "#6b4b00", "#000000"};
constexpr int kLeft = 70, kRight = 190, kTop = 40, kBottom = 56;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '&': out += "&amp;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

/// One axis: values to pixels.
class Axis {
 public:
  Axis(bool is_log, double first_px, double last_px) : is_log_(is_log), first_px_(first_px), last_px_(last_px) {}

  bool can_show(double value) const { return std::isfinite(value) && (!is_log_ || value > 0); }
  void include(double value) {
    low_ = std::min(low_, scaled(value));
    high_ = std::max(high_, scaled(value));
  }
  void finish() {
    if (!(low_ <= high_)) low_ = 0, high_ = 1;  // nothing to show
    const double span = high_ - low_;
    const double margin = span > 0 ? 0.05 * span : (is_log_ ? 0.5 : std::max(1.0, std::abs(high_)) * 0.5);
    low_ -= margin;
    high_ += margin;
  }
  double pixel(double value) const { return first_px_ + (scaled(value) - low_) / (high_ - low_) * (last_px_ - first_px_); }

  /// Multiples of 1, 2 or 5 times a power of ten, at most about eight; on logarithmic axes these numbers themselves.
  std::vector<double> ticks() const {
    std::vector<double> result;
    if (is_log_) {
      const bool is_wide = high_ - low_ > 2.5;
      for (int power = static_cast<int>(std::floor(low_)); power <= static_cast<int>(std::ceil(high_)); ++power) {
        for (const double m : {1.0, 2.0, 5.0}) {
          const double value = m * std::pow(10.0, power), at = std::log10(value);
          if (at >= low_ && at <= high_ && (m < 1.5 || !is_wide)) result.push_back(value);
        }
      }
      return result;
    }
    const double rough = (high_ - low_) / 7, power = std::pow(10.0, std::floor(std::log10(rough)));
    double step = 10 * power;
    for (const double m : {5.0, 2.0, 1.0}) {
      if (m * power >= rough) step = m * power;
    }
    for (double k = std::ceil(low_ / step); k * step <= high_; ++k) result.push_back(k * step);
    return result;
  }

 private:
  double scaled(double value) const { return is_log_ ? std::log10(value) : value; }

  bool is_log_;
  double first_px_, last_px_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

class Document {
 public:
  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
    text_ += '\n';
  }
  void text(double x, double y, const char* anchor, const std::string& words, const char* more = "") {
    add(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}"{}>{}</text>)", x, y, anchor, more, escaped(words));
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void draw_axes(const Axis& x, const Axis& y, const PlotOptions& o, Document& svg) {
  const int right = o.width_px - kRight, bottom = o.height_px - kBottom;
  for (const double tick : x.ticks()) {
    svg.add(R"(<line x1="{0:.1f}" y1="{1}" x2="{0:.1f}" y2="{2}" stroke="#ddd"/>)", x.pixel(tick), kTop, bottom);
    svg.text(x.pixel(tick), bottom + 18, "middle", fmt::format("{:.6g}", tick));
  }
  for (const double tick : y.ticks()) {
    svg.add(R"(<line x1="{1}" y1="{0:.1f}" x2="{2}" y2="{0:.1f}" stroke="#ddd"/>)", y.pixel(tick), kLeft, right);
    svg.text(kLeft - 8, y.pixel(tick) + 4, "end", fmt::format("{:.6g}", tick));
  }
  svg.add(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="none" stroke="#444"/>)", kLeft, kTop, right - kLeft,
          bottom - kTop);
  svg.text(0.5 * (kLeft + right), 24, "middle", o.title, R"( font-weight="bold")");
  svg.text(0.5 * (kLeft + right), o.height_px - 12, "middle", o.x_label);
  const double middle = 0.5 * (kTop + bottom);
  svg.text(16, middle, "middle", o.y_label, fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", middle).c_str());
}

void draw_series(const PlotSeries& series, const Axis& x, const Axis& y, const char* colour, Document& svg) {
  std::string line;
  for (std::size_t k = 0; k < series.points.size(); ++k) {
    const auto& [px, py] = series.points[k];
    if (!x.can_show(px) || !y.can_show(py)) continue;
    fmt::format_to(std::back_inserter(line), "{:.1f},{:.1f} ", x.pixel(px), y.pixel(py));
    svg.add(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3.5" fill="{}"/>)", x.pixel(px), y.pixel(py), colour);
    if (series.marked == k)
      svg.add(R"(<circle cx="{:.1f}" cy="{:.1f}" r="8" fill="none" stroke="{}" stroke-width="2"/>)", x.pixel(px), y.pixel(py), colour);
  }
  if (series.is_connected && !line.empty()) {
    svg.add(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.5"/>)", line, colour);
  }
}

void draw_panel(const PlotPanel& panel, Document& svg) {
  const auto& [series, o] = panel;
  Axis x(o.log_x, kLeft, o.width_px - kRight), y(o.log_y, o.height_px - kBottom, kTop);
  for (const PlotSeries& s : series) {
    for (const auto& [px, py] : s.points) {
      if (!x.can_show(px) || !y.can_show(py)) continue;
      x.include(px);
      y.include(py);
    }
  }
  x.finish();
  y.finish();
  draw_axes(x, y, o, svg);
  for (std::size_t k = 0; k < series.size(); ++k) {
    const char* colour = kColours[k % kColours.size()];
    draw_series(series[k], x, y, colour, svg);
    const double at = kTop + 14 + 18.0 * static_cast<double>(k);
    svg.add(R"(<circle cx="{}" cy="{:.1f}" r="4" fill="{}"/>)", o.width_px - kRight + 16, at - 4, colour);
    svg.text(o.width_px - kRight + 26, at, "start", series[k].name);
  }
}

}  // namespace

std::string render_svg_plot(const std::vector<PlotSeries>& series, const PlotOptions& options) {
  return render_svg_plots({{series, options}});
}

std::string render_svg_plots(const std::vector<PlotPanel>& panels) {
  int width = 0, height = 0;
  for (const PlotPanel& panel : panels) width += panel.options.width_px, height = std::max(height, panel.options.height_px);
  Document svg;
  svg.add(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" )"
          R"(font-family="sans-serif" font-size="12">)",
          width, height);
  svg.add(R"(<rect width="100%" height="100%" fill="white"/>)");
  int left = 0;
  for (const PlotPanel& panel : panels) {
    svg.add(R"svg(<g transform="translate({} 0)">)svg", left);
    draw_panel(panel, svg);
    svg.add("</g>");
    left += panel.options.width_px;
  }
  svg.add("</svg>");
  return svg.take();
}

}  // namespace farfield
