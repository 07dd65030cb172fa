// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/measure_frames.h"

#include "tests/bench/distribution.h"

namespace farfield::bench {

Status measure_frames(const World& world, const DrawFrame& draw, MethodResult& result, bool has_cells) {
  ErrorAverage errors(world.options.display);
  std::vector<double> times, triangles, samples;
  for (std::size_t k = 0; k < world.poses.size(); ++k) {
    if (k == 0) {
      if (const auto first = draw(world.poses[k]); !first) return tl::unexpected(first.error());
    }
    Result<DrawnFrame> frame = draw(world.poses[k]);
    if (!frame) return tl::unexpected(frame.error());
    times.push_back(frame->ms), triangles.push_back(frame->triangles), samples.push_back(frame->samples);
    errors.add(frame->seen, world.truth[k], world.is_far_at(k));
    result.pictures.push_back(std::move(frame->seen.rgb));
  }
  result.frame_p50 = percentile(times, 0.50), result.frame_p95 = percentile(times, 0.95), result.frame_p99 = percentile(times, 0.99);
  result.triangles = mean(triangles), result.samples = mean(samples);
  result.error = errors.figures();
  if (!has_cells || !world.border) return {};
  const auto rgb_of = [&](std::size_t index) {
    return draw(world.border->poses()[index]).map([](DrawnFrame&& frame) { return std::move(frame.seen.rgb); });
  };
  const Result<BorderFlip> border = world.border->judge(world.options.display, rgb_of);
  if (!border) return tl::unexpected(border.error());
  result.border_flip = *border;
  return {};
}

}  // namespace farfield::bench
