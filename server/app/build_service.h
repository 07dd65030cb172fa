// SPDX-License-Identifier: Apache-2.0
// From a SCENE argument to a cell service: load, build, find a start, wire the stages together.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/app/prepared_scenes.h"
#include "server/schedule/scheduled_cell_service.h"

namespace farfield {

/// NAME=SCENE or SCENE.
struct SceneArgument {
  std::string name;   // in the catalogue
  std::string scene;  // what load_model() takes
};
/// A scene without a name is called by its file's stem, or as it is written if it is generated.
/// Errors: kInvalidArgument.
Result<SceneArgument> parse_scene_argument(const std::string& text);

struct ServiceOptions {
  LoadOptions load;
  ImpostorSettings settings;
  std::shared_ptr<PreparedScenes> prepared;  // may be null: every start loads and builds
  std::shared_ptr<TileStore> store;
  std::shared_ptr<JobPool> pool;
  std::shared_ptr<JobPool> prompt_pool;  // see CellServiceParts
  std::shared_ptr<BlobStore> blobs;      // may be null
  std::shared_ptr<GenerationLease> lease;  // likewise
  std::function<void(const std::string&)> log;  // progress and warnings, one line each; may be empty
};

/// With settings fitted to the scene.
std::shared_ptr<MeasuredCellService> service_for_scene(const std::string& name, const PreparedScene& prepared, const ServiceOptions& options);

/// Reads, or loads and builds, on the calling thread; up to minutes. Errors: as prepare_scene().
Result<std::shared_ptr<MeasuredCellService>> build_service(const SceneArgument& argument, const ServiceOptions& options);

}  // namespace farfield
