// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/run_cells.h"

#include <algorithm>
#include <iostream>
#include <list>

#include "tests/bench/baselines/baseline_frame.h"
#include "tests/bench/baselines/cell_walk.h"
#include "tests/bench/distribution.h"
#include "tests/bench/measure_frames.h"

namespace farfield::bench {
namespace {

/// Where two sums of bytes meet: what was made, and what the walk needs.
struct CellFigures {
  std::vector<double> cell_ms, intra_ms, ratio, colour, depth;
  std::map<CellId, std::size_t> made;  // bytes

  /// Returns: whether it is new.
  bool add(const CellId& leaf, const MadeCell& cell) {
    if (!made.emplace(leaf, cell.bytes()).second) return false;
    cell_ms.push_back(cell.cell_ms), intra_ms.push_back(cell.intra_ms);
    if (cell.intra_ms > 0) ratio.push_back(cell.cell_ms / cell.intra_ms);
    colour.push_back(static_cast<double>(cell.colour_bytes)), depth.push_back(static_cast<double>(cell.depth_bytes));
    return true;
  }
  void report(const World& world, const std::vector<EnteredCell>& entered, MethodResult& result) const {
    result.cell_p50 = percentile(cell_ms, 0.5), result.cell_p95 = percentile(cell_ms, 0.95), result.cell_max = largest(cell_ms);
    result.intra_p50 = percentile(intra_ms, 0.5), result.cell_to_intra = percentile(ratio, 0.5);
    result.cell_count = static_cast<double>(cell_ms.size());
    result.bytes_per_cell = mean(colour) + mean(depth);
    result.bytes_near = result.bytes_textures = result.bytes_total = 0;
    for (const EnteredCell& cell : entered) {
      const auto found = made.find(cell.leaf);
      const double near = static_cast<double>(cell.near_bytes), textures = static_cast<double>(cell.texture_bytes);
      const double bytes = near + textures + (found != made.end() ? static_cast<double>(found->second) : result.bytes_per_cell);
      result.bytes_near += near, result.bytes_textures += textures, result.bytes_total += bytes;
      if (&cell == entered.data()) result.bytes_entry = bytes;
    }
    const double impostors = result.bytes_total - result.bytes_near - result.bytes_textures;
    result.bytes_colour = impostors * mean(colour) / std::max(1.0, result.bytes_per_cell);
    result.bytes_disparity = impostors - result.bytes_colour;
    const double warm = result.bytes_total - result.bytes_entry;
    result.mbit_s_warm = 8e-6 * warm / std::max(1e-9, world.trace.seconds());
    result.bytes_per_metre = warm / std::max(1e-9, length_of(world.trace));
  }
};

/// Cells of frames before, as a client keeps them: borders are crossed to and fro.
constexpr std::size_t kHeldBytes = std::size_t{1} << 30;
using HeldCell = std::pair<CellId, MadeCell>;

class CellRun {
 public:
  CellRun(const World& world, const std::string& name, const MakeCell& make, BaselineFrame& renderer, MethodResult& result)
      : world_(world), name_(name), make_(make), renderer_(renderer), result_(result), walk_(world) {}

  Status run() {
    const auto entered = walk_.entered();
    if (!entered) return tl::unexpected(entered.error());
    if (Status status = enter(entered->front().leaf, entered->front().eye); !status) return status;
    for (const EnteredCell& cell : *entered) eyes_.emplace(cell.leaf, cell.eye);
    if (Status status = measure_frames(world_, [&](const Pose& eye) { return draw(eye); }, result_, true); !status) return status;
    figures_.report(world_, *entered, result_);
    return {};
  }

 private:
  Status enter(const CellId& leaf, const glm::dvec3& eye) {
    if (!held_.empty() && held_.front().first == leaf) return {};
    const auto found = std::find_if(held_.begin(), held_.end(), [&](const HeldCell& held) { return held.first == leaf; });
    if (found != held_.end()) {
      held_.splice(held_.begin(), held_, found);
    } else {
      std::cerr << name_ << ": making cell " << figures_.made.size() + 1 << '\n';
      Result<MadeCell> made = make_({*world_.scene, far_space(walk_.shells(), leaf), eye.y, walk_.settings()});
      if (!made) return tl::unexpected(made.error());
      if (figures_.add(leaf, *made))
        for (const auto& [what, count] : made->skipped) result_.skipped[what] += count;
      held_.emplace_front(leaf, std::move(*made));
      drop_oldest();
    }
    const MadeCell& cell = held_.front().second;
    if (cell.layers) renderer_.show(*cell.layers);
    else renderer_.show(cell.panels, cell.tree, cell.budget);
    return {};
  }
  void drop_oldest() {
    std::size_t bytes = 0;
    for (auto held = held_.begin(); held != held_.end();) {
      bytes += held->second.memory_bytes();
      held = held != held_.begin() && bytes > kHeldBytes ? held_.erase(held) : std::next(held);
    }
  }

  Result<DrawnFrame> draw(const Pose& eye) {
    const Result<CellId> leaf = walk_.leaf_at(eye.position);
    if (!leaf) return tl::unexpected(leaf.error());
    const bool is_new = held_.empty() || held_.front().first != *leaf;
    const auto first_eye = eyes_.find(*leaf);
    if (Status status = enter(*leaf, first_eye != eyes_.end() ? first_eye->second : eye.position); !status) return tl::unexpected(status.error());
    const auto near = walk_.near_view(eye.position);
    if (!near) return tl::unexpected(near.error());
    if (is_new || near->get() != near_) renderer_.draw(**near, eye, frame_);  // uploads, which a client does ahead
    near_ = near->get();
    const BaselineDrawn drawn = renderer_.draw(**near, eye, frame_);
    DrawnFrame result;
    result.seen = judged(frame_);
    result.ms = drawn.ms, result.triangles = static_cast<double>(drawn.triangles);
    if (held_.front().second.layers) result.samples = static_cast<double>(drawn.samples);
    return result;
  }

  const World& world_;
  const std::string& name_;
  const MakeCell& make_;
  BaselineFrame& renderer_;
  MethodResult& result_;
  CellWalk walk_;
  CellFigures figures_;
  std::map<CellId, glm::dvec3> eyes_;
  std::list<HeldCell> held_;  // the one shown first
  const client::LeafView* near_ = nullptr;
  client::Frame frame_;
};

}  // namespace

std::size_t MadeCell::memory_bytes() const {
  std::size_t bytes = 0;
  for (const MeshPanel& panel : panels) bytes += panel.rgb.size() + panel.mesh.vertices.size() * sizeof(FaceVertex) + panel.mesh.indices.size() * sizeof(std::uint32_t);
  if (layers)
    for (const LayeredFace& face : *layers) bytes += face.first.size() * sizeof(std::uint32_t) + face.samples.size() * sizeof(LayeredSample);
  return bytes;
}

Result<MethodResult> run_cells(const World& world, const std::string& name, bool is_layered, const MakeCell& make) {
  MethodResult result;
  result.name = name;
  const int wanted = world.options.client_samples == 0 ? 4 : world.options.client_samples;
  auto renderer = BaselineFrame::create(world.options.display, is_layered ? 1 : wanted);
  if (!renderer) return tl::unexpected(renderer.error());
  CellRun run(world, name, make, **renderer, result);
  if (Status status = run.run(); !status) return tl::unexpected(status.error());
  return result;
}

}  // namespace farfield::bench
