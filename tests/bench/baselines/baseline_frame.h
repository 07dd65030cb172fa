// SPDX-License-Identifier: Apache-2.0
// A baseline's frame: near geometry and impostor to a finished image in memory, by the same renderers and with the same
// closing of cracks and voids as Farfield's client. Belongs to the thread that made it.
#pragma once

#include <memory>

#include "client/gl/framebuffer.h"
#include "client/near/near_renderer.h"
#include "tests/bench/baselines/layer_painter.h"
#include "tests/bench/baselines/panel_renderer.h"
#include "tests/bench/baselines/scan_selection.h"

namespace farfield::bench {

struct BaselineDrawn {
  double ms = 0;  // from the pose to the finished image
  std::size_t triangles = 0, samples = 0;
};

class BaselineFrame {
 public:
  /// `samples_per_pixel`: of OpenGL, 1 or 4; layered images need 1. Errors: no OpenGL.
  static Result<std::unique_ptr<BaselineFrame>> create(const Display& display, int samples_per_pixel);

  /// Either of the two; both must outlive their use.
  void show(std::span<const MeshPanel> panels) { show(panels, {}, {}); }
  /// Of a tree of scans, kCubeFaces panels each in the tree's order, what `budget` allows for each frame; an empty tree: all.
  void show(std::span<const MeshPanel> panels, ScanTree tree, const ScanBudget& budget);
  void show(const LayeredCell& layers) { painter_.set_cell(layers), layers_ = &layers; }

  /// `near`: geometry, near region, sky and background.
  BaselineDrawn draw(const client::LeafView& near, const Pose& eye, client::Frame& frame);

 private:
  BaselineFrame() = default;
  BaselineDrawn draw_panels(const client::LeafView& near, const Pose& eye, const client::ViewTransform& view, client::Frame& frame);
  std::vector<std::uint8_t> selected_panels(const client::ViewTransform& view) const;
  BaselineDrawn draw_layers(const client::LeafView& near, const Pose& eye, const client::ViewTransform& view, client::Frame& frame);

  Display display_;
  std::unique_ptr<client::GlContext> context_;  // destroyed last
  client::Framebuffer target_;
  std::unique_ptr<client::NearRenderer> near_;
  PanelRenderer panels_;
  ScanTree scans_;
  ScanBudget scan_budget_;
  LayerPainter painter_;
  const LayeredCell* layers_ = nullptr;
  std::vector<std::uint8_t> colour_;
  std::vector<float> depth_;
};

}  // namespace farfield::bench
