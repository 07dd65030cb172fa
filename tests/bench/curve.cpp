// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace farfield::bench {
namespace {

bool is_known(const CurvePoint& point, const CostAxis& axis) {
  return std::isfinite(point.*axis.cost) && std::isfinite(point.flip);
}
bool is_positive(const CurvePoint& point, const CostAxis& axis) {
  return is_known(point, axis) && point.*axis.cost > 0 && point.flip > 0;
}

// The curve's points that have a cost, cheapest first: sweeps need not be monotone.
std::vector<std::size_t> by_cost(std::span<const CurvePoint> points, const CostAxis& axis,
                                 bool (*is_usable)(const CurvePoint&, const CostAxis&)) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_usable(points[i], axis)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return points[a].*axis.cost < points[b].*axis.cost; });
  return order;
}

std::string where(const Curve& curve, const CurvePoint& point, const CostAxis& axis) {
  const std::string knob = curve.knob.empty() ? "" : fmt::format(" at {} {:g}", curve.knob, point.value);
  return fmt::format("{}{} ({:.4g} {}, FLIP {:.4f})", curve.method, knob, point.*axis.cost, axis.unit, point.flip);
}

}  // namespace

CurvePoint point_of(double value, const MethodResult& result) {
  return {value, result.frame_p50, result.mbit_s_warm, result.error.flip_mean, result.error.psnr_mean};
}

std::optional<std::size_t> knee_of(std::span<const CurvePoint> points, const CostAxis& axis) {
  const std::vector<std::size_t> order = by_cost(points, axis, is_positive);
  if (order.size() < 3) return std::nullopt;
  const CurvePoint &first = points[order.front()], &last = points[order.back()];
  const double width = std::log(last.*axis.cost / first.*axis.cost), height = std::log(first.flip / last.flip);
  if (!(width > 0) || !(height > 0)) return std::nullopt;  // dearer buys nothing
  std::optional<std::size_t> knee;
  double farthest = 0;
  for (const std::size_t i : order) {
    // In scaled axes the chord runs from (0, 1) to (1, 0); twice the squared distance to it grows with 1 - x - y.
    const double x = std::log(points[i].*axis.cost / first.*axis.cost) / width, y = std::log(points[i].flip / last.flip) / height;
    if (1 - x - y > farthest) farthest = 1 - x - y, knee = i;
  }
  // The ends lie on the chord; rounding of the logarithms must not make a knee of them.
  return knee == order.front() || knee == order.back() ? std::nullopt : knee;
}

double least_cost_for(std::span<const Curve> curves, const CostAxis& axis, double flip) {
  double least = std::nan("");
  const auto take = [&](double cost) { least = std::isnan(least) ? cost : std::min(least, cost); };
  for (const Curve& curve : curves) {
    const std::vector<std::size_t> order = by_cost(curve.points, axis, is_known);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const CurvePoint& b = curve.points[order[k]];
      if (b.flip <= flip) take(b.*axis.cost);
      if (k == 0) continue;
      const CurvePoint& a = curve.points[order[k - 1]];
      if (!is_positive(a, axis) || !is_positive(b, axis) || !(a.flip > flip) || !(b.flip < flip)) continue;
      const double share = std::log(a.flip / flip) / std::log(a.flip / b.flip);
      take(a.*axis.cost * std::pow(b.*axis.cost / a.*axis.cost, share));
    }
  }
  return least;
}

std::vector<std::string> dominance_report(const std::string& name, std::span<const Curve> mine, const Curve& theirs, const CostAxis& axis) {
  const bool has_mine = std::any_of(mine.begin(), mine.end(), [&](const Curve& c) {
    return std::any_of(c.points.begin(), c.points.end(), [&](const CurvePoint& p) { return is_known(p, axis); });
  });
  std::vector<std::string> lines;
  bool has_theirs = false;
  for (const CurvePoint& point : theirs.points) {
    if (!has_mine || !is_known(point, axis)) continue;
    has_theirs = true;
    const double cost = least_cost_for(mine, axis, point.flip);
    if (cost <= point.*axis.cost) continue;
    const std::string here = fmt::format("{}: {} does not lie below and left of {}", axis.name, name, where(theirs, point, axis));
    if (std::isnan(cost))
      lines.push_back(here + ": no value of its knobs has so small an error");
    else
      lines.push_back(fmt::format("{}: for that error it needs {:.4g} {}", here, cost, axis.unit));
  }
  if (has_theirs && lines.empty())
    lines.push_back(
        fmt::format("{}: {} lies below and left of {}{}", axis.name, name, theirs.method, theirs.knob.empty() ? "" : ":" + theirs.knob));
  return lines;
}

}  // namespace farfield::bench
