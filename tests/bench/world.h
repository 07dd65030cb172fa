// SPDX-License-Identifier: Apache-2.0
// What all methods share: the scene, the sampled poses, and truth for them, rendered once.
#pragma once

#include <memory>
#include <optional>

#include "common/trace/trace.h"
#include "server/scene/reference_image.h"
#include "tests/bench/bench_options.h"
#include "tests/bench/border_pairs.h"
#include "tests/bench/viewer_cells.h"

namespace farfield::bench {

struct World {
  BenchOptions options;
  std::shared_ptr<const Scene> scene;
  Trace trace;                        // world frame
  std::vector<Pose> poses;            // sampled, scene frame
  std::vector<ReferenceImage> truth;  // one per pose
  std::optional<ViewerCells> cells;   // nothing: no method of the run has cells
  std::vector<std::vector<std::uint8_t>> is_far;  // per pose, ViewerCells::far_pixels; empty without cells
  std::shared_ptr<const BorderPairs> border;      // null: not asked for, or no cells

  /// Empty without cells.
  std::vector<std::uint8_t> is_far_at(std::size_t pose) const { return is_far.empty() ? std::vector<std::uint8_t>() : is_far[pose]; }
  Pose scene_from_world(const Pose& world) const { return {world.position - scene->origin(), world.world_from_camera}; }
};

/// Loads, builds and renders truth, with progress on stderr. `has_cells`: some method of the run has.
/// Errors: as load_model, Scene::build, read_trace.
Result<World> make_world(const BenchOptions& options, bool has_cells);

}  // namespace farfield::bench
