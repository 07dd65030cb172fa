// SPDX-License-Identifier: Apache-2.0
// What all methods share: the scene, the sampled poses, and truth for them, rendered once.
#pragma once

#include <memory>

#include "common/trace/trace.h"
#include "server/scene/reference_image.h"
#include "tests/bench/bench_options.h"

namespace farfield::bench {

struct World {
  BenchOptions options;
  std::shared_ptr<const Scene> scene;
  Trace trace;                        // world frame
  std::vector<Pose> poses;            // sampled, scene frame
  std::vector<ReferenceImage> truth;  // one per pose

  Pose scene_from_world(const Pose& world) const { return {world.position - scene->origin(), world.world_from_camera}; }
};

/// Loads, builds and renders truth, with progress on stderr. Errors: as load_model, Scene::build, read_trace.
Result<World> make_world(const BenchOptions& options);

}  // namespace farfield::bench
