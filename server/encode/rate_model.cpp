// SPDX-License-Identifier: Apache-2.0
#include "server/encode/rate_model.h"

#include <algorithm>
#include <cmath>

#include "common/codec/colour_codec.h"
#include "common/codec/coverage_codec.h"
#include "common/codec/disparity_codec.h"
#include "server/model/random_stream.h"

namespace farfield {
namespace {

constexpr int kIntraSamples = 64, kDeltaSamples = 32, kLeastOfView = 3;
// Bytes of a tile go with this power of the share of the view in which it shows: measured on 12 shells of three scenes, where sixty
// intra tiles tell the bytes of all within 3 to 10 % (one standard deviation), and at a power of a half within up to 16 %.
constexpr double kBytesPower = 0.3;
constexpr double kHeaderBytes = 64;  // and the sizes of the streams

// Systematic sampling with probabilities in proportion to size (Madow 1949), those too large for it taken for certain.
void sample_some(std::span<const CellNeed> needs, std::size_t first, std::size_t last, int wanted, RandomStream& random, std::vector<SampledTile>& samples) {
  if (static_cast<std::size_t>(wanted) >= last - first) {
    for (std::size_t at = first; at < last; ++at) samples.push_back({at, needs[at].leaf_share});
    return;
  }
  std::vector<double> chances;
  double all = 0;
  for (std::size_t at = first; at < last; ++at) {
    chances.push_back(needs[at].leaf_share * std::pow(std::max(1e-9f, needs[at].view_share), kBytesPower));
    all += chances.back();
  }
  // Raised until they add up to what is wanted; each round takes those that are certain out of the sum.
  double left = wanted;
  for (bool is_settled = false; !is_settled && left > 0 && all > 0;) {
    is_settled = true;
    const double factor = left / all;
    left = wanted, all = 0;
    for (double& chance : chances) {
      if (chance < 1 && chance * factor >= 1) is_settled = false;
      chance = chance >= 1 ? 1 : std::min(1.0, chance * factor);
      if (chance >= 1) left -= 1; else all += chance;
    }
  }
  double sum = 0, next = random.unit();
  for (std::size_t k = 0; k < chances.size(); ++k) {
    if (sum += chances[k]; sum <= next) continue;
    samples.push_back({first + k, needs[first + k].leaf_share / chances[k]});
    next += 1;
  }
}

}  // namespace

std::vector<SampledTile> sample_tiles(std::span<const CellNeed> needs) {
  std::vector<SampledTile> samples;
  if (needs.empty()) return samples;
  const CellId& cell = needs[0].id.cell;
  RandomStream random(0x72617465, cell.level, cell.x, cell.y, cell.z);
  const auto deltas = static_cast<double>(std::count_if(needs.begin(), needs.end(), [](const CellNeed& need) { return need.id.is_delta(); }));
  for (std::size_t first = 0; first < needs.size();) {
    const std::uint8_t view = needs[first].id.view;
    std::size_t last = first;
    while (last < needs.size() && needs[last].id.view == view) ++last;
    const auto size = static_cast<int>(last - first);
    const int wanted = view == kIntraView ? kIntraSamples : std::max(kLeastOfView, static_cast<int>(std::lround(kDeltaSamples * size / deltas)));
    sample_some(needs, first, last, std::min(wanted, size), random, samples);
    first = last;
  }
  return samples;
}

double colour_weight(const TileId& id) {
  // Nine fifths of the step: 16 less of quality 80.
  constexpr double kDeltaStep = 1.8;
  return id.is_delta() ? 1 / (kDeltaStep * kDeltaStep) : 1;
}

void RateModel::add(Tile tile, double count) {
  Known known;
  known.count = count;
  const TileBits bits(tile);
  const auto disparity_bytes = [&] { return static_cast<double>(encode_disparity(tile, bits).size()); };
  const double fine = disparity_bytes();
  const float tolerance = tile.disparity_tolerance;
  tile.disparity_tolerance = 2 * tolerance;
  const double coarse = disparity_bytes();
  tile.disparity_tolerance = tolerance;
  known.other_bytes = kHeaderBytes + static_cast<double>(tile.blocks.size() + encode_topology(tile, bits).size()) + fine;
  known.saved_by_coarse_depth = fine - coarse;
  known.tile = std::make_unique<const Tile>(std::move(tile));
  known.trial = std::make_unique<ColourTrial>(*known.tile);
  tiles_.push_back(std::move(known));
}

std::vector<RateModel::Outcome> RateModel::of_views(double slope) {
  std::vector<Outcome> views;
  for (const Known& known : tiles_) {
    const TileId& id = known.tile->id;
    if (views.size() <= id.view) views.resize(id.view + std::size_t{1});
    const double weight = colour_weight(id);
    const ColourOutcome colour = known.trial->at(known.trial->best_quality(slope, weight));
    Outcome& view = views[id.view];
    view.bytes += known.count * (known.other_bytes + colour.bytes);
    view.saved_by_coarse_depth += known.count * known.saved_by_coarse_depth;
    view.error += known.count * colour.error, view.weighted_error += known.count * weight * colour.error;
    view.solid_angle += known.count * known.trial->solid_angle();
  }
  return views;
}

double RateModel::void_mean_square() const {
  double spread = 0, angle = 0;
  for (const Known& known : tiles_) spread += known.count * known.trial->spread(), angle += known.count * known.trial->solid_angle();
  return angle > 0 ? 2 * spread / angle : 0;
}

}  // namespace farfield
