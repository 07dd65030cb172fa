// SPDX-License-Identifier: Apache-2.0
// Runs a method that makes one impostor per cell along the trace.
#pragma once

#include <optional>

#include "tests/bench/baselines/layered_image.h"
#include "tests/bench/baselines/mesh_panel.h"
#include "tests/bench/baselines/scan_selection.h"
#include "tests/bench/method_result.h"
#include "tests/bench/world.h"

namespace farfield::bench {

/// A cell's impostor as a client holds it after decoding.
struct MadeCell {
  std::vector<MeshPanel> panels;
  ScanTree tree;                      // of panels that depend on each other, and how many are drawn
  ScanBudget budget;
  std::optional<LayeredCell> layers;  // instead of panels
  double cell_ms = 0;                 // from casting to the last encoded byte, on all cores
  double intra_ms = 0;                // of that, casting the central or intra view alone
  std::size_t colour_bytes = 0, depth_bytes = 0;
  std::map<std::string, double> skipped;

  std::size_t bytes() const { return colour_bytes + depth_bytes; }
  std::size_t memory_bytes() const;
};

struct CellRequest {
  const Scene& scene;
  CellSpace space;
  double eye_height = 0;  // of the viewer who enters, scene frame
  const ImpostorSettings& settings;
};
using MakeCell = std::function<Result<MadeCell>(const CellRequest&)>;

/// `is_layered`: drawn with one sample per pixel. Errors: of making and decoding, or no OpenGL.
Result<MethodResult> run_cells(const World& world, const std::string& name, bool is_layered, const MakeCell& make);

}  // namespace farfield::bench
