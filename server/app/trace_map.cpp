// SPDX-License-Identifier: Apache-2.0
#include "server/app/trace_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "common/image/tiny_font.h"
#include "server/app/body_probe.h"

namespace farfield {
namespace {

// The drawn rectangle of the world's x-z plane, cut into cells.
struct Plan {
  glm::dvec2 low{0}, high{0};  // world x and z
  int columns = 1, rows = 1;
  std::vector<bool> is_solid;  // [row][column]

  glm::dvec2 cell() const { return (high - low) / glm::dvec2(columns, rows); }
  glm::ivec2 cell_at(const glm::dvec3& world) const {
    const glm::dvec2 at = (glm::dvec2(world.x, world.z) - low) / cell();
    return glm::clamp(glm::ivec2(glm::floor(at)), glm::ivec2(0), glm::ivec2(columns, rows) - 1);
  }
};

/// The path's bounds with a margin; never thinner than a quarter of its length, so that a straight line is seen too.
Plan plan_of(const Trace& trace, int columns, double cell_aspect) {
  const Box bounds = summarise(trace).bounds;
  const glm::dvec3 extent = bounds.extent();
  const double size = std::max({extent.x, extent.z, 0.5 * extent.y, 1e-6});
  const double margin = 0.08 * size;
  const glm::dvec2 half(0.5 * std::max(extent.x, 0.25 * size) + margin, 0.5 * std::max(extent.z, 0.25 * size) + margin);
  const glm::dvec2 middle(bounds.center().x, bounds.center().z);
  Plan plan;
  plan.low = middle - half;
  plan.high = middle + half;
  plan.columns = columns;
  plan.rows = std::clamp(static_cast<int>(std::lround(columns * half.y / half.x / cell_aspect)), 4, 4 * columns);
  return plan;
}

// A cell is solid if any ray through it meets something between knee and eye of the nearest frame.
void mark_solid(Plan& plan, const Trace& trace, const Scene& scene) {
  const BodyProbe probe(scene, BodyProbe::scale_for(scene));
  const double height = 0.75 * probe.eye_height_m();
  plan.is_solid.assign(static_cast<std::size_t>(plan.columns) * static_cast<std::size_t>(plan.rows), false);
  const std::size_t stride = std::max<std::size_t>(1, trace.frames.size() / 200);
  for (int row = 0; row < plan.rows; ++row) {
    for (int column = 0; column < plan.columns; ++column) {
      const glm::dvec2 center = plan.low + plan.cell() * (glm::dvec2(column, row) + 0.5);
      double nearest = std::numeric_limits<double>::infinity(), eye_y = 0;
      for (std::size_t i = 0; i < trace.frames.size(); i += stride) {
        const glm::dvec3& p = trace.frames[i].pose.position;
        const double distance = glm::distance(center, glm::dvec2(p.x, p.z));
        if (distance < nearest) nearest = distance, eye_y = p.y;
      }
      bool is_hit = false;
      for (int k = 0; k < 4 && !is_hit; ++k) {
        const glm::dvec2 at = center + plan.cell() * glm::dvec2(k % 2 - 0.5, k / 2 - 0.5) * 0.5;
        const glm::dvec3 from = glm::dvec3(at.x, eye_y, at.y) - scene.origin();
        is_hit = probe.free_distance(from, {0, -1, 0}, height) < height;
      }
      // Upright walls are thinner than any ray down: look across the cell both ways.
      const glm::dvec3 middle = glm::dvec3(center.x, eye_y - 0.5 * height, center.y) - scene.origin();
      for (const int axis : {0, 2}) {
        glm::dvec3 across{0};
        across[axis] = 1;
        const double length = plan.cell()[axis / 2];
        is_hit = is_hit || probe.free_distance(middle - 0.5 * length * across, across, length) < length;
      }
      plan.is_solid[static_cast<std::size_t>(row * plan.columns + column)] = is_hit;
    }
  }
}

/// A round length near a fifth of the drawing: 1, 2 or 5 times a power of ten.
double scale_bar_m(double width_m) {
  const double power = std::pow(10, std::floor(std::log10(width_m / 5)));
  const double digits = width_m / 5 / power;
  return power * (digits >= 5 ? 5 : digits >= 2 ? 2 : 1);
}

}  // namespace

std::string text_map(const Trace& trace, const Scene* scene, int columns) {
  constexpr double kCharacterAspect = 2;  // terminals draw characters twice as high as wide
  Plan plan = plan_of(trace, columns, kCharacterAspect);
  if (plan.rows > columns / 2) plan = plan_of(trace, std::max(8, columns * (columns / 2) / plan.rows), kCharacterAspect);
  if (scene) mark_solid(plan, trace, *scene);
  std::vector<std::string> lines(static_cast<std::size_t>(plan.rows), std::string(static_cast<std::size_t>(plan.columns), scene ? '.' : ' '));
  const auto put = [&](const glm::ivec2& cell, char c) { lines[static_cast<std::size_t>(cell.y)][static_cast<std::size_t>(cell.x)] = c; };
  for (std::size_t i = 0; i < plan.is_solid.size(); ++i) {
    const int at = static_cast<int>(i);
    if (plan.is_solid[i]) put({at % plan.columns, at / plan.columns}, '#');
  }
  for (const TraceFrame& frame : trace.frames) put(plan.cell_at(frame.pose.position), 'o');
  put(plan.cell_at(trace.frames.back().pose.position), 'E');
  put(plan.cell_at(trace.frames.front().pose.position), 'S');
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  const double bar = scale_bar_m(plan.high.x - plan.low.x);
  const int length = std::max(2, static_cast<int>(std::lround(bar / plan.cell().x)));
  text += fmt::format("|{}| {} m\n", std::string(static_cast<std::size_t>(length - 2), '-'), bar);
  return text;
}

std::string svg_map(const Trace& trace, const Scene* scene) {
  constexpr double kWidthPx = 900;
  Plan plan = plan_of(trace, 225, 1);
  if (scene) mark_solid(plan, trace, *scene);
  const double px = kWidthPx / (plan.high.x - plan.low.x), height = px * (plan.high.y - plan.low.y);
  const auto at = [&](const glm::dvec3& world) { return px * (glm::dvec2(world.x, world.z) - plan.low); };
  std::string svg = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\">\n"
                                "<rect width=\"100%\" height=\"100%\" fill=\"#f7f6f2\"/>\n<g fill=\"#8d939b\">\n", kWidthPx, height);
  const auto out = std::back_inserter(svg);
  const glm::dvec2 cell = px * plan.cell();
  for (int row = 0; row < plan.rows && scene; ++row) {
    for (int column = 0; column < plan.columns; ++column) {  // runs of solid cells as one rectangle
      int end = column;
      while (end < plan.columns && plan.is_solid[static_cast<std::size_t>(row * plan.columns + end)]) ++end;
      if (end == column) continue;
      fmt::format_to(out, "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n", cell.x * column, cell.y * row, cell.x * (end - column), cell.y + 0.2);
      column = end;
    }
  }
  svg += "</g>\n<polyline fill=\"none\" stroke=\"#c4452d\" stroke-width=\"2.5\" stroke-linejoin=\"round\" points=\"";
  const std::size_t stride = std::max<std::size_t>(1, trace.frames.size() / 4000);
  for (std::size_t i = 0; i < trace.frames.size(); i += stride) {
    const glm::dvec2 p = at(trace.frames[i].pose.position);
    fmt::format_to(out, "{:.1f},{:.1f} ", p.x, p.y);
  }
  svg += "\"/>\n<g stroke=\"#2b5f8a\" stroke-width=\"1.2\">\n";
  const std::size_t gaze_stride = std::max<std::size_t>(1, trace.frames.size() / 40);
  for (std::size_t i = 0; i < trace.frames.size(); i += gaze_stride) {
    const Pose& pose = trace.frames[i].pose;
    const glm::dvec3 ahead = pose.world_from_camera * glm::dvec3(0, 0, -1);
    const glm::dvec2 p = at(pose.position), q = p + 16.0 * glm::dvec2(ahead.x, ahead.z);
    fmt::format_to(out, "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", p.x, p.y, q.x, q.y);
  }
  const glm::dvec2 start = at(trace.frames.front().pose.position), end = at(trace.frames.back().pose.position);
  const double bar = scale_bar_m(plan.high.x - plan.low.x);
  fmt::format_to(out, "</g>\n<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"6\" fill=\"#2f8f4e\"/>\n<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"6\" fill=\"#c4452d\"/>\n", start.x, start.y, end.x, end.y);
  fmt::format_to(out, "<path d=\"M12 {0:.1f} v6 h{1:.1f} v-6\" fill=\"none\" stroke=\"#222\"/>\n<text x=\"18\" y=\"{2:.1f}\" font-family=\"sans-serif\" font-size=\"13\">{3} m</text>\n</svg>\n",
                 height - 18, px * bar, height - 18, bar);
  return svg;
}


namespace {

using Colour = std::array<std::uint8_t, 3>;

void fill_rectangle(Image8& image, glm::dvec2 low, glm::dvec2 high, const Colour& colour) {
  const auto edge = [](double at, int most) { return std::clamp(static_cast<int>(std::lround(at)), 0, most); };
  for (int y = edge(low.y, image.height); y < edge(high.y, image.height); ++y) {
    for (int x = edge(low.x, image.width); x < edge(high.x, image.width); ++x) std::copy(colour.begin(), colour.end(), image.at(x, y));
  }
}

void fill_disc(Image8& image, glm::dvec2 middle, double radius, const Colour& colour) {
  for (int y = static_cast<int>(std::floor(middle.y - radius)); y <= middle.y + radius; ++y) {
    for (int x = static_cast<int>(std::floor(middle.x - radius)); x <= middle.x + radius; ++x) {
      const bool is_inside = x >= 0 && y >= 0 && x < image.width && y < image.height;
      if (is_inside && glm::distance(glm::dvec2(x, y) + 0.5, middle) <= radius) std::copy(colour.begin(), colour.end(), image.at(x, y));
    }
  }
}

void draw_line(Image8& image, glm::dvec2 from, glm::dvec2 to, double radius, const Colour& colour) {
  const int steps = 1 + static_cast<int>(glm::distance(from, to));
  for (int i = 0; i <= steps; ++i) fill_disc(image, glm::mix(from, to, static_cast<double>(i) / steps), radius, colour);
}

}  // namespace

Image8 png_map(const Trace& trace, const Scene* scene) {
  constexpr double kWidthPx = 900;
  constexpr Colour kPaper{0xf7, 0xf6, 0xf2}, kSolid{0x8d, 0x93, 0x9b}, kPath{0xc4, 0x45, 0x2d}, kGaze{0x2b, 0x5f, 0x8a}, kStart{0x2f, 0x8f, 0x4e}, kInk{0x22, 0x22, 0x22};
  Plan plan = plan_of(trace, 225, 1);
  if (scene) mark_solid(plan, trace, *scene);
  const double px = kWidthPx / (plan.high.x - plan.low.x);
  Image8 image(static_cast<int>(kWidthPx), std::max(1, static_cast<int>(std::lround(px * (plan.high.y - plan.low.y)))), 3);
  fill_rectangle(image, {0, 0}, {image.width, image.height}, kPaper);
  const auto at = [&](const glm::dvec3& world) { return px * (glm::dvec2(world.x, world.z) - plan.low); };
  const glm::dvec2 cell = px * plan.cell();
  for (std::size_t i = 0; i < plan.is_solid.size(); ++i) {
    const glm::dvec2 corner(static_cast<int>(i) % plan.columns, static_cast<int>(i) / plan.columns);
    if (plan.is_solid[i]) fill_rectangle(image, cell * corner, cell * (corner + 1.0), kSolid);
  }
  const std::size_t stride = std::max<std::size_t>(1, trace.frames.size() / 4000);
  for (std::size_t i = stride; i < trace.frames.size(); i += stride) {
    draw_line(image, at(trace.frames[i - stride].pose.position), at(trace.frames[i].pose.position), 1.25, kPath);
  }
  const std::size_t gaze_stride = std::max<std::size_t>(1, trace.frames.size() / 40);
  for (std::size_t i = 0; i < trace.frames.size(); i += gaze_stride) {
    const Pose& pose = trace.frames[i].pose;
    const glm::dvec3 ahead = pose.world_from_camera * glm::dvec3(0, 0, -1);
    draw_line(image, at(pose.position), at(pose.position) + 16.0 * glm::dvec2(ahead.x, ahead.z), 0.7, kGaze);
  }
  fill_disc(image, at(trace.frames.front().pose.position), 6, kStart);
  fill_disc(image, at(trace.frames.back().pose.position), 6, kPath);
  const double bar = scale_bar_m(plan.high.x - plan.low.x), low = image.height - 12;
  fill_rectangle(image, {12, low - 2}, {12 + px * bar, low}, kInk);
  draw_text(image, 14, image.height - 30, fmt::format("{} m", bar), 2, kInk);
  return image;
}

}  // namespace farfield
