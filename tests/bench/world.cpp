// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/world.h"

#include <unistd.h>

#include <iostream>

#include "common/base/one_line.h"
#include "common/trace/trace_file.h"

namespace farfield::bench {

Result<World> make_world(const BenchOptions& options) {
  World world;
  world.options = options;
  Result<Trace> trace = read_trace(options.trace);
  if (!trace) return tl::unexpected(trace.error());
  if (trace->frames.empty()) return fail(ErrorCode::kInvalidArgument, "{}: the trace holds no pose", options.trace.string());
  world.trace = std::move(*trace);
  Result<Model> model = load_model(options.scene, options.load);
  if (!model) return tl::unexpected(model.error());
  for (const std::string& warning : model->warnings) std::cerr << "warning: " << one_line(warning) << '\n';
  Result<std::shared_ptr<const Scene>> scene = Scene::build(std::move(*model));
  if (!scene) return fail_within(options.scene, scene.error());
  if (isatty(STDERR_FILENO)) std::cerr << "loaded " << one_line(options.scene) << '\n';
  world.scene = *scene;
  const Result<Trace> sampled = resampled(world.trace, std::min(options.frames, world.trace.frames.size()));
  if (!sampled) return tl::unexpected(sampled.error());
  for (const TraceFrame& frame : sampled->frames) world.poses.push_back(world.scene_from_world(frame.pose));
  for (std::size_t k = 0; k < world.poses.size(); ++k) {
    world.truth.push_back(render_reference(*world.scene, world.poses[k], options.display, options.truth_samples));
    if (k % 8 == 7) std::cerr << "truth: " << k + 1 << " of " << world.poses.size() << " frames\n";
  }
  return world;
}

}  // namespace farfield::bench
