// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/world.h"

#include <unistd.h>

#include <iostream>

#include "common/base/one_line.h"
#include "common/trace/trace_file.h"
#include "server/encode/tile_maker.h"

namespace farfield::bench {
namespace {

Status add_cells(World& world) {
  const BenchOptions& options = world.options;
  ImpostorSettings settings = options.settings;
  settings.finest_side_m = finest_side_for(*world.scene, settings.finest_side_m);
  world.cells.emplace(world.scene, settings);
  for (std::size_t k = 0; k < world.poses.size(); ++k) world.is_far.push_back(world.cells->far_pixels(world.poses[k], options.display, world.truth[k]));
  if (options.border_pairs == 0) return {};
  std::cerr << "truth on both sides of cells' borders\n";
  Result<BorderPairs> border = BorderPairs::create(*world.scene, *world.cells, world.trace, options.border_pairs, options.display, options.truth_samples);
  if (!border) return tl::unexpected(border.error());
  world.border = std::make_shared<const BorderPairs>(std::move(*border));
  return {};
}

}  // namespace

Result<World> make_world(const BenchOptions& options, bool has_cells) {
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
  if (has_cells) {
    if (Status status = add_cells(world); !status) return tl::unexpected(status.error());
  }
  return world;
}

}  // namespace farfield::bench
