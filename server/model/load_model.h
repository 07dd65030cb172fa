// SPDX-License-Identifier: Apache-2.0
// From a SCENE argument to a model: a file in any supported format, or "kind:triangles:seed" for a generator.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

struct LoadOptions {
  double metres_per_unit = 0;            // --units; 0: what the file says, else 1
  std::string up;                        // --up: "x", "y", "z"; empty: what the format says (OBJ, PLY, STL, OFF: y)
  glm::dvec3 shift{0};                   // --shift: added to every world position in double, after units and up
  std::filesystem::path import_program;  // farfield-import; empty: beside the running program
  std::size_t memory_limit_bytes = std::size_t{8} << 30;  // of the import process
  std::chrono::seconds time_limit{600};                   // processor time of the import process
};

/// Reads a file or runs a generator ("pipes:1000000:1"). Assimp formats are read in a child process that may crash
/// without harm. Every position in the result is finite; triangles with non-finite or out-of-range vertices, and
/// triangles without area, are dropped with a warning that counts them.
/// Errors: kNotFound, kBadData (one line: file, what is wrong, what to do), kLimitExceeded.
Result<Model> load_model(const std::string& scene_argument, const LoadOptions& options = {});

}  // namespace farfield
