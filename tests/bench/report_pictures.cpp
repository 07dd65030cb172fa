// SPDX-License-Identifier: Apache-2.0
// The report's pictures: run time against error, and frames above truth.
#include "common/base/complete_file.h"
#include "common/image/contact_sheet.h"
#include "common/image/png.h"
#include "common/image/svg_plot.h"
#include "tests/bench/report.h"

namespace farfield::bench {
namespace {

// Every second pixel of a sheet is enough to see by: averages of 2×2.
Image8 halved(const std::vector<std::uint8_t>& rgb, int width, int height) {
  Image8 image(width / 2, height / 2, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto at = [&](int dx, int dy) { return rgb[3 * (static_cast<std::size_t>(2 * y + dy) * width + 2 * x + dx) + c]; };
        image.at(x, y)[c] = static_cast<std::uint8_t>((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4);
      }
  return image;
}

}  // namespace

Status write_plot(const std::filesystem::path& file, const std::vector<MethodResult>& methods, const std::vector<Curve>& curves) {
  std::vector<PlotPanel> panels;
  for (const CostAxis& axis : kCostAxes) {
    PlotPanel& panel = panels.emplace_back();
    for (const Curve& curve : curves) {
      PlotSeries series{curve.method + ":" + curve.knob, {}, true, knee_of(curve.points, axis)};
      for (const CurvePoint& point : curve.points) series.points.emplace_back(point.*axis.cost, point.flip);
      panel.series.push_back(std::move(series));
    }
    for (const MethodResult& m : methods) panel.series.push_back({m.name, {{point_of(0, m).*axis.cost, m.error.flip_mean}}, false});
    panel.options.title = fmt::format("{} against error", axis.name);
    panel.options.title[0] = static_cast<char>(std::toupper(panel.options.title[0]));
    panel.options.x_label = fmt::format("{}, {} ({})", axis.name, axis.unit, axis.cost == &CurvePoint::frame_ms ? "median" : "once warm");
    panel.options.y_label = "mean FLIP against truth";
    panel.options.log_x = panel.options.log_y = true;
  }
  return write_complete_file(file, render_svg_plots(panels));
}

Status write_contact_sheet(const std::filesystem::path& file, const World& world, const std::vector<MethodResult>& methods) {
  constexpr std::size_t kColumns = 6;
  const std::size_t count = std::min(kColumns, world.poses.size());
  const auto index = [&](std::size_t column) { return count < 2 ? 0 : column * (world.poses.size() - 1) / (count - 1); };
  const Display& display = world.options.display;
  std::vector<std::vector<SheetImage>> rows;
  for (const MethodResult& m : methods) {
    if (m.name == "rays" || m.pictures.size() != world.poses.size()) continue;
    std::vector<SheetImage>& row = rows.emplace_back();
    for (std::size_t c = 0; c < count; ++c) row.push_back({c == 0 ? m.name : "", halved(m.pictures[index(c)], display.width, display.height)});
  }
  std::vector<SheetImage>& row = rows.emplace_back();
  for (std::size_t c = 0; c < count; ++c) row.push_back({c == 0 ? "truth" : "", halved(world.truth[index(c)].rgb, display.width, display.height)});
  return write_png(file.string(), make_contact_sheet(rows));
}

Status write_frames(const std::filesystem::path& folder, const World& world, const std::vector<MethodResult>& methods) {
  const Display& display = world.options.display;
  const auto write = [&](const std::string& name, std::size_t k, const std::vector<std::uint8_t>& rgb) {
    Image8 image(display.width, display.height, 3);
    image.values = rgb;
    return write_png((folder / fmt::format("{:04}-{}.png", k, name)).string(), image);
  };
  for (std::size_t k = 0; k < world.poses.size(); ++k) {
    if (Status status = write("truth", k, world.truth[k].rgb); !status) return status;
    for (const MethodResult& m : methods) {
      if (k >= m.pictures.size()) continue;
      if (Status status = write(m.name, k, m.pictures[k]); !status) return status;
    }
  }
  return {};
}

}  // namespace farfield::bench
