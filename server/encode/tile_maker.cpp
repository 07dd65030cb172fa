// SPDX-License-Identifier: Apache-2.0
#include "server/encode/tile_maker.h"

#include <algorithm>
#include <cmath>

#include "common/base/thread_clock.h"
#include "common/cells/sampling.h"
#include "server/encode/colour_trial.h"
#include "server/impostor/colour_probe.h"
#include "server/impostor/view_catalogue.h"

namespace farfield {
namespace {

// What delta views hold is seen at the rims of nearer things and for moments: it need not look as clean as the rest.
constexpr int kDeltaQualityDrop = 16;
// A fallback view is shown for moments, at a quarter of the samples.
constexpr int kFallbackQualityDrop = 25;

// Of a delta tile, the blocks that nobody can see.
std::size_t hidden_blocks(const VisibleBlocks& visible, const TileId& id, int edge_samples) {
  const int blocks = (edge_samples + kBlockSamples - 1) / kBlockSamples;
  const auto end = [&](int first) { return std::min((first + 1) * kRegionBlocks, blocks); };
  std::size_t hidden = 0;
  for (int y = id.y * kRegionBlocks; y < end(id.y); ++y)
    for (int x = id.x * kRegionBlocks; x < end(id.x); ++x) hidden += !visible.contains(id.face, x * kBlockSamples, y * kBlockSamples);
  return hidden;
}

// Samples that look the same from everywhere in the cell, up to the tolerance, wherever beyond they are.
std::size_t samples_without_depth(const Tile& tile) {
  std::size_t count = 0;
  for (std::size_t at = 0; at < tile.samples(); ++at) count += tile.coverage[at] && tile.disparity[at] <= tile.disparity_tolerance;
  return count;
}

// How a tile that misses its target is coded finer.
constexpr int kQualityStep = 8;

constexpr double kMostError = 255.0 * 255.0;

double mse_of_psnr(double psnr_db) { return kMostError * std::pow(10.0, -0.1 * psnr_db); }

// Mean squared error of covered samples' colours from coding alone.
double coding_error(const Tile& exact, const CodedSamples& decoded) {
  std::uint64_t sum = 0, covered = 0;
  for (std::size_t at = 0; at < exact.samples(); ++at) {
    std::uint32_t squares = 0;
    for (std::size_t c = 3 * at; c < 3 * at + 3; ++c) {
      const int difference = int{exact.rgb[c]} - int{decoded.rgb[c]};
      squares += static_cast<std::uint32_t>(difference * difference);
    }
    sum += exact.coverage[at] ? squares : 0, covered += exact.coverage[at];
  }
  return covered ? static_cast<double>(sum) / (3.0 * static_cast<double>(covered)) : 0;
}

}  // namespace

int TileMaker::quality_of(const TileId& id) const {
  const int drop = id.is_delta() ? kDeltaQualityDrop : id.view == kFallbackView ? kFallbackQualityDrop : 0;
  return std::max(1, settings_.colour_quality - drop);
}

TileMaker::TileMaker(std::shared_ptr<const Scene> scene, std::shared_ptr<CellTree> tree, std::shared_ptr<ViewSource> views, const NestedShells& shells,
                     const ImpostorSettings& settings, std::shared_ptr<RateControl> rates)
    : scene_(std::move(scene)), views_(std::move(views)), shells_(shells), settings_(settings), rates_(std::move(rates)), tree_(std::move(tree)),
      fallback_gain_(warp_gain(glm::dvec3(0), NestedShells::kFallbackKappa)) {}

Result<Tile> TileMaker::cast(const TileId& id, const CancelFlag& cancel, TileWork& work) {
  TileSkips skips;
  return cast_counted(id, cancel, work, skips);
}

Result<Tile> TileMaker::cast_counted(const TileId& id, const CancelFlag& cancel, TileWork& work, TileSkips& skips) {
  if (id.view == kFallbackView) {
    const CellSpace space = CellSpace::of_fallback(shells_, id.cell);
    const int edge = face_samples(std::max(1, settings_.face_tiles / 4));
    const double tolerance = settings_.tau_px * settings_.display.pixel_pitch() / fallback_gain_;
    Tile tile = cast_dense_tile(*scene_, space, space.box.center(), id, edge, fallback_gain_, tolerance, nullptr, work);
    skips.samples_coloured_once = work.samples_coloured_once;
    return tile;
  }
  const auto views = views_->views(id.cell, cancel);
  if (!views) return tl::unexpected(views.error());
  const std::vector<glm::dvec3>& positions = (*views)->positions;
  if (id.view >= positions.size()) return fail(ErrorCode::kNotFound, "a cell with {} views has no view {}", positions.size(), id.view);
  const CellSpace space = CellSpace::of_shell(shells_, id.cell, tree_->scene_root());
  const Result<bool> is_leaf = tree_->is_leaf(id.cell, cancel);
  if (!is_leaf) return tl::unexpected(is_leaf.error());
  const double gain = (*views)->warp_gains[id.view];
  const double tolerance = settings_.tau_px * settings_.display.pixel_pitch() / gain;
  std::shared_ptr<const VisibleBlocks> visible;
  if (*is_leaf) {
    auto blocks = visible_blocks(space, positions[id.view], id.view, cancel);
    if (!blocks) return tl::unexpected(blocks.error());
    visible = *blocks;
  }
  Tile tile;
  if (id.is_delta()) {
    DeltaSkips delta;
    tile = cast_delta_tile(*scene_, space, positions, id, settings_, gain, tolerance, visible.get(), work, delta);
    skips.delta_blocks_hidden = visible ? hidden_blocks(*visible, id, tile.edge_samples) : 0;
    skips.delta_blocks_not_cast = delta.blocks_probed - delta.blocks_cast - skips.delta_blocks_hidden;
    skips.delta_samples_held = delta.samples_held;
  } else {
    tile = cast_dense_tile(*scene_, space, positions[0], id, settings_.edge_samples(), gain, tolerance, visible.get(), work);
    skips.hidden_samples = tile.samples() - work.rays;
  }
  skips.samples_coloured_once = work.samples_coloured_once;
  (*views)->validated.store_in(tile.certificate);
  tile.certificate.missed_void = (*views)->missed_target;
  return tile;
}

Result<std::shared_ptr<const VisibleBlocks>> TileMaker::visible_blocks(const CellSpace& space, const glm::dvec3& position,
                                                                        int view, const CancelFlag& cancel) {
  constexpr std::size_t kRemembered = 256;  // some 20 kB each
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, blocks] : recent_)
      if (key == std::pair(space.cell, view)) return blocks;
  }
  const auto seen = seen_in_shell(space, cancel);
  if (!seen) return tl::unexpected(seen.error());
  auto made = std::make_shared<const VisibleBlocks>(**seen, position, settings_.edge_samples(static_cast<std::uint8_t>(view)));
  const std::lock_guard lock(mutex_);
  recent_.emplace_front(std::pair(space.cell, view), made);
  if (recent_.size() > kRemembered) recent_.pop_back();
  return made;
}

Result<std::shared_ptr<const std::vector<glm::vec3>>> TileMaker::seen_in_shell(const CellSpace& space, const CancelFlag& cancel) {
  constexpr std::size_t kRemembered = 4;  // up to some megabytes each
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [cell, points] : recent_points_)
      if (cell == space.cell) return points;
  }
  const auto seen = tree_->visibility(space.cell, cancel);
  if (!seen) return tl::unexpected(seen.error());
  auto made = std::make_shared<const std::vector<glm::vec3>>(points_in_shell(**seen, space));
  const std::lock_guard lock(mutex_);
  recent_points_.emplace_front(space.cell, made);
  if (recent_points_.size() > kRemembered) recent_points_.pop_back();
  return made;
}

bool TileMaker::is_known(ContentHash content, const CellId& cell) {
  constexpr std::size_t kMostContents = 65536;  // some 40 bytes each; beyond, counting begins anew
  const std::lock_guard lock(mutex_);
  if (shown_.size() >= kMostContents) shown_.clear();
  return shown_.try_emplace(content, cell).first->second != cell;
}

Result<int> TileMaker::steer(Tile& tile, const CancelFlag& cancel) const {
  const bool is_steered = rates_ || settings_.has_one_slope;
  if (tile.id.view == kFallbackView || !is_steered) return quality_of(tile.id);
  double slope = slope_of_quality(settings_.colour_quality, settings_.edge_samples());
  if (rates_) {
    const auto coding = rates_->coding(tile.id.cell, cancel);
    if (!coding) return tl::unexpected(coding.error());
    slope = (*coding)->slope;
    tile.disparity_tolerance *= static_cast<float>((*coding)->tolerance_scale);
  }
  return ColourTrial(tile).best_quality(slope, colour_weight(tile.id));
}

Result<Bytes> TileMaker::encode_certified(const Tile& tile, int first_quality, TileBytes& accounting, StageSeconds& stages) {
  StageClock clock;
  if (tile.id.view == kFallbackView) {
    Result<Bytes> encoded = encode_tile(tile, {first_quality}, &accounting);
    clock.lap(stages.encode);
    return encoded;
  }
  const CellSpace space = CellSpace::of_shell(shells_, tile.id.cell, tree_->scene_root());
  const ColourProbes probes(*scene_, space, space.box.center() + glm::dvec3(tile.view_offset) * space.side_m, tile, settings_.display);
  clock.lap(stages.certify);
  const double target = settings_.targets.coding_psnr_db > 0 ? mse_of_psnr(settings_.targets.coding_psnr_db) : kMostError;
  const bool may_refine = settings_.rate.cell_bytes <= 0;  // else the budget goes first
  int quality = first_quality;
  for (;;) {
    CodedSamples decoded;
    Result<Bytes> encoded = encode_tile(tile, {quality}, &accounting, &decoded);
    if (!encoded) return encoded;
    clock.lap(stages.encode);
    const bool misses = coding_error(tile, decoded) > target;
    if (misses && may_refine && quality < kFinestQuality) {
      refined_ += quality == first_quality;
      quality = std::min(kFinestQuality, quality + kQualityStep);
      continue;
    }
    Certificate certificate = tile.certificate;
    probes.measure(tile, decoded, certificate);
    certificate.missed_colour = misses;
    set_certificate(*encoded, certificate);
    ++certified_, missed_ += misses || certificate.missed_void;
    clock.lap(stages.certify);
    return encoded;
  }
}

Result<std::shared_ptr<const EncodedTile>> TileMaker::make(const TileId& id, const CancelFlag& cancel) {
  if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
  const double start = thread_seconds();
  TileWork work;
  auto result = std::make_shared<EncodedTile>();
  Result<Tile> tile = cast_counted(id, cancel, work, result->skips);
  if (!tile) return tl::unexpected(tile.error());
  result->rays = static_cast<std::uint32_t>(work.rays);
  const bool is_empty = std::find(tile->coverage.begin(), tile->coverage.end(), 1) == tile->coverage.end();
  if (is_empty) {
    result->skips.empty_tiles = 1;
    result->bytes = std::make_shared<const Bytes>();
  } else {
    TileBytes bytes;
    StageClock clock;
    const Result<int> quality = steer(*tile, cancel);
    clock.lap(work.seconds.encode);
    if (!quality) return tl::unexpected(quality.error());
    Result<Bytes> encoded = encode_certified(*tile, *quality, bytes, work.seconds);
    if (!encoded) return tl::unexpected(encoded.error());
    result->hash = hash_bytes(*encoded);
    result->bytes = std::make_shared<const Bytes>(std::move(*encoded));
    result->covered_samples = bytes.covered_samples;
    result->skips.samples_without_depth = samples_without_depth(*tile);
    if (is_known(bytes.content, id.cell)) result->skips.identical_tiles = 1, result->skips.identical_bytes = result->bytes->size();
    result->colour_bytes = bytes.colour;
    result->disparity_bytes = bytes.disparity;
    result->other_bytes = bytes.topology + bytes.other;
  }
  result->seconds = thread_seconds() - start, result->stages = work.seconds;
  const std::lock_guard lock(mutex_);
  skipped_ += result->skips;
  return std::shared_ptr<const EncodedTile>(result);
}

double finest_side_for(const Scene& scene, double wanted_m) {
  const glm::dvec3 extent = scene.bounds().extent();
  const double largest = std::max({extent.x, extent.y, extent.z, 1e-9});
  // 64 finest cells along a scene are enough to walk through it; rounded down to a power of two, so that cell borders
  // are exact.
  return std::exp2(std::floor(std::log2(std::min(wanted_m, largest / 64))));
}

ImpostorSources make_impostor_sources(std::shared_ptr<const Scene> scene, const ImpostorSettings& settings) {
  const NestedShells shells{CellGrid{settings.finest_side_m}, settings.kappa};
  ImpostorSources sources;
  sources.tree = std::make_shared<CellTree>(scene, shells, settings.near_triangles);
  sources.views = std::make_shared<ViewCatalogue>(scene, sources.tree, shells, settings);
  std::shared_ptr<RateControl> rates;
  if (settings.rate.is_set()) {
    const auto sampler = std::make_shared<TileMaker>(scene, sources.tree, sources.views, shells, settings);
    rates = std::make_shared<RateControl>(scene, sources.tree, sources.views, shells, settings, [sampler](const TileId& id, const CancelFlag& cancel) {
      TileWork work;
      return sampler->cast(id, cancel, work);
    });
    sources.views = rates;
  }
  sources.leaves = std::make_shared<LeafPlanner>(scene, sources.tree, sources.views, shells, settings);
  sources.tiles = std::make_shared<TileMaker>(scene, sources.tree, sources.views, shells, settings, rates);
  return sources;
}

}  // namespace farfield
