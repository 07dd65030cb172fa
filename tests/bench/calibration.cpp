// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration.h"

#include <fmt/format.h>

#include <fstream>
#include <limits>

#include "common/image/svg_plot.h"
#include "tests/bench/distribution.h"
#include "tests/bench/promises.h"

namespace farfield::bench {
namespace {

struct Figure {
  const char *title, *unit;
  double FramePromise::*promised;
  double FramePromise::*expected;  // null: none
  double KeptPromise::*measured;
  bool is_logarithmic, is_at_most;
};
constexpr Figure kFigures[] = {
    {"Void share", "of the frame", &FramePromise::void_share, &FramePromise::expected_void_share, &KeptPromise::void_share, true, true},
    {"Impostor PSNR", "dB", &FramePromise::psnr_db, &FramePromise::expected_psnr_db, &KeptPromise::psnr_db, false, false},
    {"Warp error, p99", "pixels", &FramePromise::warp_px, nullptr, &KeptPromise::warp_px, false, true}};

// A void share of 0 is drawn here on the logarithmic axis.
constexpr double kLeastShare = 1e-6;

double drawn(const Figure& figure, double value) { return figure.is_logarithmic ? std::max(value, kLeastShare) : value; }

std::string figure_line(const Figure& figure, std::span<const KeptPromise> frames) {
  std::vector<double> kept, promised, measured, error;
  for (const KeptPromise& frame : frames) {
    const double promise = frame.promise.*figure.promised, value = frame.*figure.measured;
    if (!std::isfinite(promise) || !std::isfinite(value)) continue;
    kept.push_back(figure.is_at_most ? value <= promise : value >= promise);
    promised.push_back(promise), measured.push_back(value);
    if (figure.expected) error.push_back(value - frame.promise.*figure.expected);
  }
  std::string line = fmt::format("{:>7.1f} {:>11.4g} {:>11.4g}", 100 * mean(kept), mean(promised), mean(measured));
  if (figure.expected) line += fmt::format(" {:>11.3g} … {:.3g}", smallest(error), largest(error));
  return line;
}

}  // namespace

Result<std::vector<CalibrationRun>> read_calibration(const std::filesystem::path& report) {
  std::ifstream in(report);
  if (!in) return fail(ErrorCode::kIo, "{}: cannot be read", report.string());
  try {
    const nlohmann::json json = nlohmann::json::parse(in);
    std::vector<CalibrationRun> runs;
    for (const nlohmann::json& method : json.at("methods")) {
      CalibrationRun run{json.at("scene").at("name").get<std::string>() + " " + method.at("name").get<std::string>(), {}};
      for (const nlohmann::json& frame : method.at("certificate").at("frames")) run.frames.push_back(kept_promise_from(frame));
      if (!run.frames.empty()) runs.push_back(std::move(run));
    }
    return runs;
  } catch (const nlohmann::json::exception& error) {
    return fail(ErrorCode::kBadData, "{}: not a report of farfield-bench with certificates ({})", report.string(), error.what());
  }
}

std::string calibration_plot(std::span<const CalibrationRun> runs) {
  std::vector<PlotPanel> panels;
  for (const Figure& figure : kFigures) {
    PlotPanel& panel = panels.emplace_back();
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const CalibrationRun& run : runs) {
      PlotSeries series{run.name, {}, false};
      for (const KeptPromise& frame : run.frames) {
        const double promise = drawn(figure, frame.promise.*figure.promised), value = drawn(figure, frame.*figure.measured);
        if (!std::isfinite(frame.promise.*figure.promised) || !std::isfinite(frame.*figure.measured)) continue;
        series.points.emplace_back(promise, value);
        low = std::min({low, promise, value}), high = std::max({high, promise, value});
      }
      panel.series.push_back(std::move(series));
    }
    if (low <= high) panel.series.push_back({"as promised", {{low, low}, {high, high}}, true});
    panel.options.title = fmt::format("{}: kept {} the line", figure.title, figure.is_at_most ? "below" : "above");
    panel.options.x_label = fmt::format("promised ({})", figure.unit), panel.options.y_label = fmt::format("measured ({})", figure.unit);
    panel.options.log_x = panel.options.log_y = figure.is_logarithmic;
  }
  return render_svg_plots(panels);
}

std::string calibration_table(std::span<const CalibrationRun> runs) {
  CalibrationRun all{"all", {}};
  std::size_t widest = 4;
  for (const CalibrationRun& run : runs) {
    all.frames.insert(all.frames.end(), run.frames.begin(), run.frames.end());
    widest = std::max(widest, run.name.size());
  }
  std::string text;
  for (const Figure& figure : kFigures) {
    text += fmt::format("{:<{}}  kept %    promised    measured   measured - expected\n", figure.title, widest);
    for (const CalibrationRun& run : runs) text += fmt::format("{:<{}} {}\n", run.name, widest, figure_line(figure, run.frames));
    text += fmt::format("{:<{}} {}\n", all.name, widest, figure_line(figure, all.frames));
  }
  return text;
}

}  // namespace farfield::bench
