// SPDX-License-Identifier: Apache-2.0
// Scenes made ready once: what loading and building gave is kept in the store's folder, so that the next start only reads it.
//
//   FOLDER/prepared/HASH.scene   HASH: of the scene argument and the load options
//     fingerprint of the programs' source, argument, the files read (source_files.h), warnings, place to stand, scene; u64 hash of it all
//
// A file of another build, of changed sources, or damaged is not used, and replaced. Least recently used files go when they are too many.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/model/load_model.h"
#include "server/scene/scene.h"

namespace farfield {

/// A scene and what else is found once about it.
struct PreparedScene {
  std::shared_ptr<const Scene> scene;
  std::optional<glm::dvec3> standing;  // where viewers start, scene frame; none was found: empty
};

/// A scene that is built already. O(rays of the search for a place).
PreparedScene prepared(std::shared_ptr<const Scene> scene);
/// Loads and builds on the calling thread; seconds to minutes. `log`: progress and warnings, one line each; may be empty.
/// Errors: as load_model() and Scene::build().
Result<PreparedScene> prepare_scene(const std::string& argument, const LoadOptions& load, const std::function<void(const std::string&)>& log);

/// One thread at a time. Several processes may share a folder.
class PreparedScenes {
 public:
  /// `capacity_bytes`: of all files together; what is larger is not kept.
  PreparedScenes(const std::filesystem::path& folder, std::uint64_t capacity_bytes) : folder_(folder / "prepared"), capacity_bytes_(capacity_bytes) {}
  /// Gives up what is still being written.
  ~PreparedScenes() = default;

  /// From the folder if it is there and still right, else as prepare_scene(), and then written by a thread of its own. That it cannot be
  /// written is said in the log, and harms nothing.
  Result<PreparedScene> open(const std::string& argument, const LoadOptions& load, std::function<void(const std::string&)> log);
  /// Waits until everything is written.
  void finish();

 private:
  std::filesystem::path folder_;
  std::uint64_t capacity_bytes_;
  std::vector<std::jthread> writers_;
};

}  // namespace farfield
