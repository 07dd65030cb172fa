// SPDX-License-Identifier: Apache-2.0
// What a model turned out to be, on one screen: for `farfield-scene info` and for logs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/model/load_model.h"

namespace farfield {

struct ImportReport {
  std::string scene;  // as the user named it
  std::size_t drawn_triangles = 0;
  std::size_t stored_triangles = 0;  // each mesh once, however often it is placed
  std::size_t meshes = 0, instances = 0, materials = 0;
  std::size_t textures = 0;
  std::uint64_t texture_texels = 0;
  Box bounds;  // world, metres
  double metres_per_unit = 1;
  std::string up = "y";                              // the file's axis that became +Y
  bool is_units_given = false, is_up_given = false;  // by options; else assumed from the format
  glm::dvec3 shift{0};
  std::vector<std::string> warnings;
  double seconds = 0;
  std::uint64_t peak_memory_bytes = 0;  // the larger of this process and the import process
};

/// Peak memory is read from the operating system, so it covers everything this process did before.
ImportReport make_import_report(const std::string& scene_argument, const Model& model, const LoadOptions& options,
                                double seconds);

/// A screenful of text, ending in a line break. Of many warnings the first dozen, and how many more.
std::string report_text(const ImportReport& report);

/// One JSON object with every field and every warning, ending in a line break. Lengths in metres, sizes in bytes.
std::string report_json(const ImportReport& report);

}  // namespace farfield
