// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/dense_tile.h"

#include <algorithm>

#include "server/impostor/sharpen_colours.h"
#include "server/impostor/supersample.h"

namespace farfield {
namespace {

// Rows of samples between which those are shaded again that want it: their rays are still near at hand.
constexpr int kStripe = 16;
static_assert(kTileSamples % kStripe == 0);

}  // namespace

Tile cast_dense_tile(const Scene& scene, const CellSpace& space, const glm::dvec3& view, const TileId& id, int edge_samples,
                     double warp_gain, double tolerance, const VisibleBlocks* visible, TileWork& work) {
  Tile tile;
  tile.id = id;
  tile.edge_samples = edge_samples;
  tile.view_offset = glm::vec3((view - space.box.center()) / space.side_m);
  tile.disparity_tolerance = static_cast<float>(tolerance);
  tile.width = tile.height = kTileSamples;
  const std::size_t size = tile.samples();
  const ViewFrame frame = ViewFrame::of(space, view, id.face, edge_samples);
  const int first_i = id.x * kTileStride, first_j = id.y * kTileStride;

  StageClock clock;
  SampleArrays samples(size);
  std::vector<UnevenPacket> uneven;
  for (int y = 0; y < kTileSamples; y += 4) {
    for (int x = 0; x < kTileSamples; x += 4) {
      int i[kPacketSize], j[kPacketSize], index[kPacketSize];
      bool any = false;
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const int column = x + lane % 4, row = y + lane / 4;
        i[lane] = first_i + column, j[lane] = first_j + row;
        const bool is_wanted = !visible || visible->contains(id.face, i[lane], j[lane]);
        index[lane] = is_wanted ? row * kTileSamples + column : -1;
        any = any || is_wanted;
      }
      if (!any) continue;
      cast_samples(scene, space, frame, i, j, index, samples, uneven);
    }
    if ((y + 4) % kStripe != 0) continue;
    clock.lap(work.seconds.intra);
    shade_uneven(scene, frame, uneven, samples.covered, samples);
    uneven.clear();
    clock.lap(work.seconds.colours);
  }
  work.rays += static_cast<std::size_t>(std::count(samples.known.begin(), samples.known.end(), 1));

  tile.coverage = samples.covered;
  if (std::find(tile.coverage.begin(), tile.coverage.end(), 1) == tile.coverage.end()) return tile;
  std::vector<int> sample_i(size), sample_j(size);
  for (int index = 0; index < static_cast<int>(size); ++index) {
    sample_i[index] = first_i + index % kTileSamples;
    sample_j[index] = first_j + index / kTileSamples;
  }
  const ConnectionLimits limits = connection_limits(frame, warp_gain);
  const TileNeighbours neighbours(tile);
  find_cuts(scene, space, frame, samples, limits, neighbours, sample_i, sample_j, tile);
  clock.lap(work.seconds.cuts);
  supersample_colours(scene, space, frame, limits, neighbours, sample_i, sample_j, tile, samples);
  work.count_colours(tile, samples);
  tile.disparity = std::move(samples.disparity);
  sharpen_colours(tile, samples.rgb);
  tile.rgb = std::move(samples.rgb);
  clock.lap(work.seconds.colours);
  return tile;
}

}  // namespace farfield
