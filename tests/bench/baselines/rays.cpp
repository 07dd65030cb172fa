// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/rays.h"

#include "tests/bench/measure_frames.h"

namespace farfield::bench {
namespace {

Result<MethodResult> run_rays(const World& world, const KnobValues& knobs) {
  MethodResult result;
  const int samples = knobs.whole("samples");
  const auto draw = [&](const Pose& eye) -> Result<DrawnFrame> {
    DrawnFrame frame;
    const BenchClock::time_point start = BenchClock::now();
    frame.seen.rgb = render_reference(*world.scene, eye, world.options.display, samples).rgb;
    frame.ms = ms_since(start);
    return frame;
  };
  if (Status status = measure_frames(world, draw, result); !status) return tl::unexpected(status.error());
  return result;
}

}  // namespace

Method rays_method() {
  return {"rays", "the full model, ray-cast in every frame", {{.name = "samples", .default_value = 1, .description = "rays per pixel", .choices = {1, 4, 16}}}, run_rays};
}

}  // namespace farfield::bench
