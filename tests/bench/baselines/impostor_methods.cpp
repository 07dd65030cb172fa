// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/impostor_methods.h"

#include <chrono>

#include "common/cells/sampling.h"
#include "tests/bench/baselines/run_cells.h"
#include "tests/bench/baselines/simple_impostors.h"

namespace farfield::bench {
namespace {

using Clock = std::chrono::steady_clock;
double ms_from(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

/// Quantisation moves nothing by more than a quarter of a pixel: far below what simplification and splats do.
double step_for(const CellRequest& request, const glm::dvec3& view) {
  constexpr double kQuantisationPx = 0.25;
  const glm::dvec3 offset = (view - request.space.box.center()) / request.space.side_m;
  return 2 * disparity_tolerance(offset, request.settings.kappa, kQuantisationPx, request.settings.display);
}

Result<MadeCell> encoded_panels(const CellRequest& request, std::span<const MeshPanel> panels, Clock::time_point start) {
  MadeCell cell;
  std::vector<EncodedPanel> bytes;
  std::vector<PanelEncoding> encodings;
  for (const MeshPanel& panel : panels) {
    encodings.push_back({request.settings.colour_quality, step_for(request, panel.frame.position)});
    Result<EncodedPanel> encoded = encode_panel(panel, encodings.back());
    if (!encoded) return tl::unexpected(encoded.error());
    cell.colour_bytes += encoded->image.size(), cell.depth_bytes += encoded->mesh.size();
    bytes.push_back(std::move(*encoded));
  }
  cell.cell_ms = ms_from(start);
  for (std::size_t k = 0; k < panels.size(); ++k) {
    Result<MeshPanel> decoded = decode_panel(panels[k].frame, panels[k].face, bytes[k], encodings[k]);
    if (!decoded) return tl::unexpected(decoded.error());
    cell.panels.push_back(std::move(*decoded));
  }
  return cell;
}

/// Of billboard and tdm: everything from the one view at the cell's centre.
template <class Make>
Result<MadeCell> single_view_cell(const CellRequest& request, int face_samples, Make make) {
  const Clock::time_point start = Clock::now();
  const FarView view = cast_far_view(request.scene, request.space, request.space.box.center(), face_samples);
  const double intra_ms = ms_from(start);
  Result<MadeCell> cell = encoded_panels(request, make(view), start);
  if (cell) cell->intra_ms = intra_ms;
  return cell;
}

Result<MadeCell> layered_cell(const CellRequest& request, int face_samples) {
  const Clock::time_point start = Clock::now();
  const LayeredCellSamples made = make_layered_cell(request.scene, request.space, face_samples);
  const LayeredEncoding encoding{request.settings.colour_quality, step_for(request, request.space.box.center())};
  MadeCell cell;
  std::vector<EncodedLayers> bytes;
  for (const LayeredFace& face : made.cell) {
    Result<EncodedLayers> encoded = encode_layers(face, encoding);
    if (!encoded) return tl::unexpected(encoded.error());
    cell.colour_bytes += encoded->colour.size(), cell.depth_bytes += encoded->depth.size();
    bytes.push_back(std::move(*encoded));
  }
  cell.cell_ms = ms_from(start);
  cell.intra_ms = 1e3 * made.intra_seconds;
  cell.layers.emplace();
  for (std::size_t f = 0; f < bytes.size(); ++f) {
    Result<LayeredFace> decoded = decode_layers(made.cell[f].frame, bytes[f], encoding);
    if (!decoded) return tl::unexpected(decoded.error());
    (*cell.layers)[f] = std::move(*decoded);
  }
  return cell;
}

Knob face_samples_knob(const BenchOptions& options) {
  return {"face_samples", static_cast<double>(options.settings.edge_samples()), "samples along the edge of a cube face", 16, 8192, true, {}};
}

Method billboard_method(const BenchOptions& options) {
  return {"billboard", "a flat image per cell: a cube of six pictures at the far field's median distance", {face_samples_knob(options)},
          [](const World& world, const KnobValues& knobs) {
            return run_cells(world, "billboard", false, [&](const CellRequest& request) {
              return single_view_cell(request, knobs.whole("face_samples"), [&](const FarView& view) { return make_billboard(view, request.space); });
            });
          }};
}

Method tdm_method(const BenchOptions& options) {
  return {"tdm", "one textured depth mesh per cell, skins and all (Sillion 1997)",
          {face_samples_knob(options), {"error_px", 1, "pixels by which simplification may move surfaces", 0.05, 64}},
          [](const World& world, const KnobValues& knobs) {
            return run_cells(world, "tdm", false, [&](const CellRequest& request) {
              return single_view_cell(request, knobs.whole("face_samples"), [&](const FarView& view) {
                return make_depth_sheet(view, request.space, knobs["error_px"], request.settings.display, request.settings.kappa);
              });
            });
          }};
}

Method ldi9_method(const BenchOptions& options) {
  return {"ldi-9", "a layered depth image per cell from one central and eight construction images, 3x3 splats on the CPU (Aliaga 1998)",
          {face_samples_knob(options)}, [](const World& world, const KnobValues& knobs) {
            return run_cells(world, "ldi-9", true, [&](const CellRequest& request) { return layered_cell(request, knobs.whole("face_samples")); });
          }};
}

Method itdm_method(const BenchOptions& options) {
  return {"itdm", "incremental textured depth meshes: four corners, planar Voronoi vertices, redundancy removed (Wilson & Manocha 2003)",
          {face_samples_knob(options), {"void_sr", ViewSearch().void_sr, "solid angle of void at which no more views are taken, steradians", 1e-4, 12},
           {"scans", 0, "scan cubes drawn at most, nearest first with all they depend on; 0: all", 0, 256, true, {}},
           {"triangles", 0, "triangles within the view drawn at most, in whole scan cubes; 0: all", 0, 1e9, true, {}}},
          [](const World& world, const KnobValues& knobs) {
            return run_cells(world, "itdm", false, [&](const CellRequest& request) -> Result<MadeCell> {
              const Clock::time_point start = Clock::now();
              ItdmOptions itdm{{}, knobs.whole("face_samples"), 0.5, request.settings.display, request.settings.kappa};
              itdm.search.void_sr = knobs["void_sr"];
              const ItdmCell made = make_itdm(request.scene, request.space, request.eye_height, itdm);
              Result<MadeCell> cell = encoded_panels(request, made.panels, start);
              if (!cell) return cell;
              cell->tree = made.tree;
              cell->budget = {static_cast<std::size_t>(knobs["scans"]), static_cast<std::size_t>(knobs["triangles"])};
              cell->intra_ms = 1e3 * made.intra_seconds;
              cell->skipped["delta_samples_held"] = static_cast<double>(made.redundant);
              return cell;
            });
          }};
}

}  // namespace

std::vector<Method> impostor_methods(const BenchOptions& options) {
  std::vector<Method> methods{billboard_method(options), tdm_method(options), ldi9_method(options), itdm_method(options)};
  for (Method& method : methods) method.has_cells = true;
  return methods;
}

}  // namespace farfield::bench
