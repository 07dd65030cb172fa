// SPDX-License-Identifier: Apache-2.0
// farfield-scene: looks at models and generates them. Data on stdout, talk on stderr.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "server/model/load_model.h"

namespace farfield {

struct SceneInfoOptions {
  std::string scene;  // a file, or KIND:TRIANGLES:SEED
  LoadOptions load;
  bool is_json = false;
};

struct SceneGenerateOptions {
  std::string scene;             // KIND:TRIANGLES:SEED
  std::filesystem::path output;  // .glb
  bool is_json = false;
};

/// Loads a scene and writes its report to `out`. Errors: as load_model().
Status run_scene_info(const SceneInfoOptions& options, std::ostream& out);

/// Generates a scene, writes it as GLB, and reports it to `out`. Errors: kInvalidArgument (not a generated scene, not
/// a .glb name), as load_model() and write_glb().
Status run_scene_generate(const SceneGenerateOptions& options, std::ostream& out);

/// The whole program. Returns: 0 done, 1 failed (one line on stderr), 2 wrong usage.
int run_scene_tool(int argument_count, const char* const* arguments);

}  // namespace farfield
