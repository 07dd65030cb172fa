// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/video.h"

#include <iostream>

#include "tests/bench/baselines/rotation_warp.h"
#include "tests/bench/baselines/video_codec.h"
#include "tests/bench/baselines/video_schedule.h"
#include "tests/bench/distribution.h"
#include "tests/bench/measure_frames.h"

namespace farfield::bench {
namespace {

/// Both ends of one stream.
struct Stream {
  VideoEncoder encoder;
  VideoDecoder decoder;
};

Result<Stream> open_stream(const VideoSettings& settings) {
  Result<VideoEncoder> encoder = VideoEncoder::create(settings);
  if (!encoder) return tl::unexpected(encoder.error());
  Result<VideoDecoder> decoder = VideoDecoder::create();
  if (!decoder) return tl::unexpected(decoder.error());
  return Stream{std::move(*encoder), std::move(*decoder)};
}

struct Sums {
  std::vector<double> times;
  double bytes = 0;  // of pictures while the viewer walks, the first of each stretch left out
  double pictures = 0;
};

void set_figures(const World& world, const VideoSchedule& schedule, const Sums& sums, MethodResult& result) {
  result.frame_p50 = percentile(sums.times, 0.50), result.frame_p95 = percentile(sums.times, 0.95),
  result.frame_p99 = percentile(sums.times, 0.99);
  if (!(sums.pictures > 0)) return;
  const double per_second = sums.bytes / (sums.pictures * schedule.interval_s);
  result.mbit_s_warm = 8e-6 * per_second;
  result.bytes_colour = result.bytes_total = result.bytes_entry + per_second * world.trace.seconds();
  result.bytes_per_metre = per_second * world.trace.seconds() / std::max(1e-9, length_of(world.trace));
}

Result<MethodResult> run_video(const World& world, const KnobValues& knobs) {
  const Display& display = world.options.display;
  const double delay_s = video_delay_s(world.options.link_model);
  const VideoSchedule schedule = make_video_schedule(world.trace, world.poses.size(), knobs["hz"], delay_s);
  const Display wide = schedule.rendered(display);
  const VideoSettings settings{wide.width,   wide.height,     1 / schedule.interval_s,
                               knobs["crf"], knobs["kbit_s"], knobs.whole("chroma") == 444};
  std::cerr << fmt::format("video: {} pictures of {}x{}, {:.1f} a second, {:.0f} ms old when shown, {:.1f} degrees wider on each side\n",
                           schedule.pictures.size(), wide.width, wide.height, 1 / schedule.interval_s, 1e3 * delay_s,
                           schedule.margin_rad * 180 / 3.14159265358979323846);
  MethodResult result;
  ErrorAverage errors(display);
  Sums sums;
  std::optional<Stream> stream;
  for (const VideoPicture& picture : schedule.pictures) {
    if (picture.is_first) {
      Result<Stream> opened = open_stream(settings);
      if (!opened) return tl::unexpected(opened.error());
      stream.emplace(std::move(*opened));
    }
    const Result<Bytes> bytes =
        stream->encoder.encode(render_reference(*world.scene, world.scene_from_world(picture.predicted), wide, 1).rgb);
    if (!bytes) return tl::unexpected(bytes.error());
    if (picture.is_first && std::isnan(result.bytes_entry)) result.bytes_entry = static_cast<double>(bytes->size());
    if (!picture.is_first && !picture.is_before_walk) sums.bytes += static_cast<double>(bytes->size()), ++sums.pictures;
    const BenchClock::time_point start = BenchClock::now();
    const Result<std::vector<std::uint8_t>> decoded = stream->decoder.decode(*bytes);
    if (!decoded) return tl::unexpected(decoded.error());
    if (picture.judged < 0) continue;
    JudgedFrame frame;
    frame.rgb = warp_by_rotation(*decoded, wide, picture.predicted.world_from_camera, display, picture.shown.world_from_camera);
    sums.times.push_back(ms_since(start));
    const auto k = static_cast<std::size_t>(picture.judged);
    errors.add(frame, world.truth[k], world.is_far_at(k));
    result.pictures.push_back(std::move(frame.rgb));
  }
  set_figures(world, schedule, sums, result);
  result.error = errors.figures();
  if (delay_s > 0) result.realtime_error = result.error;  // the link is part of every picture
  return result;
}

}  // namespace

Method video_method() {
  return {"video",
          "the server renders every frame and sends H.264; the client decodes and turns it",
          {{"crf", 23, "x264's constant rate factor", 0, 51},
           {"kbit_s", 0, "average rate instead, kbit/s; 0: crf decides", 0, 1e6},
           {.name = "hz", .default_value = 30, .description = "pictures a second", .choices = {30, 60}},
           {.name = "chroma", .default_value = 420, .description = "colour at half or full resolution", .choices = {420, 444}}},
          run_video};
}

}  // namespace farfield::bench
