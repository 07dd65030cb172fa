// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/baseline_frame.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>

#include "client/frame/resolve_gl_frame.h"
#include "client/warp/fill_voids.h"

namespace farfield::bench {
namespace {

constexpr int kVoidRadius = 8;  // pixels, as Farfield's client

SkyTest sky_of(const client::LeafView& near, const Pose& eye, const Display& display) {
  return {near.background_visible ? near.sky : DirectionMask(), glm::dmat3(glm::mat3_cast(eye.world_from_camera)), display};
}

/// Pixels of near geometry as they are, all others open, in the background's colour.
void begin_frame(const std::vector<std::uint8_t>& colour, const std::vector<float>& depth, double near_plane_m, const glm::u8vec3& background,
                 client::Frame& frame) {
  for (std::size_t k = 0; k < frame.pixels(); ++k) {
    const bool is_near = colour[4 * k + 3] != 0;
    frame.coverage[k] = is_near ? client::Coverage::kNear : client::Coverage::kBackground;
    frame.disparity[k] = is_near ? static_cast<float>(depth[k] / near_plane_m) : 0.0f;
    for (int c = 0; c < 3; ++c) frame.rgba[4 * k + static_cast<std::size_t>(c)] = is_near ? colour[4 * k + static_cast<std::size_t>(c)] : background[c];
    frame.rgba[4 * k + 3] = 255;
  }
}

}  // namespace

Result<std::unique_ptr<BaselineFrame>> BaselineFrame::create(const Display& display, int samples_per_pixel) {
  std::unique_ptr<BaselineFrame> result(new BaselineFrame);
  result->display_ = display;
  auto context = client::GlContext::create_surfaceless();
  if (!context) return tl::unexpected(context.error());
  result->context_ = std::move(*context);
  const client::GlAbilities& abilities = result->context_->abilities();
  auto target = client::Framebuffer::create(abilities, display.width, display.height, samples_per_pixel);
  if (!target) return tl::unexpected(target.error());
  result->target_ = std::move(*target);
  client::NearOptions options;
  options.frame_upload_bytes = std::numeric_limits<std::size_t>::max();  // every frame is whole
  auto near = client::NearRenderer::create(abilities, options);
  if (!near) return tl::unexpected(near.error());
  result->near_ = std::move(*near);
  auto panels = PanelRenderer::create(abilities);
  if (!panels) return tl::unexpected(panels.error());
  result->panels_ = std::move(*panels);
  return result;
}

BaselineDrawn BaselineFrame::draw(const client::LeafView& near, const Pose& eye, client::Frame& frame) {
  const auto start = std::chrono::steady_clock::now();
  // As near as the client's: a thousandth of the cell.
  const client::ViewTransform view = client::ViewTransform::of(display_, eye, 1e-3 * near.leaf_box.extent().x);
  frame.width = display_.width, frame.height = display_.height;
  frame.rgba.resize(4 * frame.pixels()), frame.disparity.resize(frame.pixels()), frame.coverage.resize(frame.pixels());
  colour_.resize(4 * frame.pixels()), depth_.resize(frame.pixels());
  target_.begin();
  BaselineDrawn drawn = layers_ ? draw_layers(near, eye, view, frame) : draw_panels(near, eye, view, frame);
  drawn.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return drawn;
}

void BaselineFrame::show(std::span<const MeshPanel> panels, ScanTree tree, const ScanBudget& budget) {
  panels_.upload(panels);
  layers_ = nullptr, scans_ = std::move(tree), scan_budget_ = budget;
}

std::vector<std::uint8_t> BaselineFrame::selected_panels(const client::ViewTransform& view) const {
  if (scans_.positions.empty() || (scan_budget_.scans == 0 && scan_budget_.triangles == 0)) return {};
  const std::vector<std::size_t> in_view = panels_.triangles_in_view(view);
  std::vector<std::size_t> of_scans(scans_.positions.size(), 0);
  for (std::size_t k = 0; k < in_view.size(); ++k) of_scans[k / kCubeFaces] += in_view[k];
  std::vector<std::uint8_t> shown(in_view.size(), 0);
  for (const std::size_t scan : select_scans(scans_, view.eye, scan_budget_, of_scans))
    std::fill_n(shown.begin() + static_cast<std::ptrdiff_t>(scan * kCubeFaces), kCubeFaces, std::uint8_t{1});
  return shown;
}

BaselineDrawn BaselineFrame::draw_panels(const client::LeafView& near, const Pose& eye, const client::ViewTransform& view, client::Frame& frame) {
  BaselineDrawn drawn;
  drawn.triangles = near_->draw(near, view).triangles;
  drawn.triangles += panels_.draw(view, selected_panels(view));
  target_.resolve();
  glFinish();
  target_.read_colour(colour_);
  target_.read_depth(depth_);
  client::resolve_gl_frame({display_.width, display_.height, colour_, depth_, view.near_plane_m},
                           {near.background, sky_of(near, eye, display_), kVoidRadius}, frame);
  return drawn;
}

BaselineDrawn BaselineFrame::draw_layers(const client::LeafView& near, const Pose& eye, const client::ViewTransform& view, client::Frame& frame) {
  BaselineDrawn drawn;
  drawn.triangles = near_->draw(near, view).triangles;
  glFinish();
  target_.read_colour(colour_);
  target_.read_depth(depth_);
  begin_frame(colour_, depth_, view.near_plane_m, near.background, frame);
  drawn.samples = painter_.paint(eye, display_, frame);
  client::fill_voids(frame, sky_of(near, eye, display_), kVoidRadius);
  return drawn;
}

}  // namespace farfield::bench
