// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/delta_tile.h"

#include <algorithm>
#include <cstring>

#include "server/impostor/sharpen_colours.h"
#include "server/impostor/supersample.h"
#include "server/impostor/void_finder.h"

namespace farfield {
namespace {

// Blocks that miss fewer of their 64 samples are left out: what shows between leaves. At three, a hundredth of the bytes
// costs a street with trees a fifteenth more void.
constexpr std::size_t kFewestNeeded = 2;

void set_size(Tile& tile) {
  tile.width = packed_width(tile.blocks.size()), tile.height = packed_height(tile.blocks.size());
}

// Index of sample (x, y) of packed block b.
int packed_index(const Tile& tile, std::size_t b, int x, int y) {
  return (static_cast<int>(b) / kPackedColumns * kBlockSamples + y) * tile.width + static_cast<int>(b) % kPackedColumns * kBlockSamples + x;
}

// The samples of a region's blocks that were cast, [row][column] over the region.
class RegionSamples {
 public:
  RegionSamples(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const VoidFinder& finder)
      : width(finder.columns() * kBlockSamples), height(finder.rows() * kBlockSamples),
        arrays(static_cast<std::size_t>(width) * height), needed(static_cast<std::size_t>(width) * height, 0), scene_(scene), space_(space),
        frame_(frame), finder_(finder),
        is_cast_(static_cast<std::size_t>(width / kPatchSamples) * static_cast<std::size_t>(height / kPatchSamples), 0) {}

  int index(int x, int y) const { return y * width + x; }

  // Casts the given patches and, as long as a void reaches the edge of a patch, the patch beyond.
  void cast(std::vector<glm::ivec2> wanted) {
    std::vector<glm::ivec2> fresh, all;
    while (!wanted.empty()) {
      fresh.clear();
      std::vector<OpenSample> open;
      for (const glm::ivec2& patch : wanted) {
        if (patch.x < 0 || patch.y < 0 || patch.x >= width / kPatchSamples || patch.y >= height / kPatchSamples) continue;
        std::uint8_t& is_cast = is_cast_[place_of(patch)];
        if (is_cast || !finder_.is_visible(patch.x / kBlockPatches, patch.y / kBlockPatches)) continue;
        is_cast = 1;
        cast_packet(patch * kPatchSamples, open);
        fresh.push_back(patch);
      }
      finder_.drop_held_by_earlier(open);
      for (const OpenSample& sample : open) needed[sample.index] = 1;
      for (const glm::ivec2& patch : fresh) infer_needed(patch);
      wanted.clear();
      for (const glm::ivec2& patch : fresh)
        for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)})
          if (is_needed_at_edge(patch, step)) wanted.push_back(patch + step);
      all.insert(all.end(), fresh.begin(), fresh.end());
    }
    patches = all.size();
    for (const glm::ivec2& patch : all) infer_needed(patch);  // between a patch and one cast after it
  }

  // Those of which something was cast, by column, then row: the order in which the format lists blocks.
  std::vector<glm::ivec2> blocks() const {
    std::vector<glm::ivec2> result;
    for (int x = 0; x < finder_.columns(); ++x)
      for (int y = 0; y < finder_.rows(); ++y) {
        bool any = false;
        for (int k = 0; k < kBlockPatches * kBlockPatches; ++k)
          any = any || is_cast_[place_of(glm::ivec2(x, y) * kBlockPatches + glm::ivec2(k % kBlockPatches, k / kBlockPatches))];
        if (any) result.push_back({x, y});
      }
    return result;
  }

  // A needed sample brings its eight neighbours along, so that its surface meets the one that another view holds, at the
  // corners too.
  std::vector<std::uint8_t> with_border() const {
    std::vector<std::uint8_t> kept = needed;
    const std::uint8_t *const begin = needed.data(), *const end = begin + needed.size();
    const auto next = [&](const std::uint8_t* from) {  // most are not needed
      return static_cast<const std::uint8_t*>(std::memchr(from, 1, static_cast<std::size_t>(end - from)));
    };
    for (const std::uint8_t* found = next(begin); found; found = next(found + 1)) {
      const int at = static_cast<int>(found - begin), column = at % width, row = at / width;
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, height - 1); ++y)
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, width - 1); ++x)
          if (arrays.covered[index(x, y)]) kept[index(x, y)] = 1;
    }
    return kept;
  }

  const int width, height;
  SampleArrays arrays;
  std::vector<std::uint8_t> needed;
  std::size_t patches = 0;  // that were cast
  std::vector<UnevenPacket> uneven;

 private:
  std::size_t place_of(const glm::ivec2& patch) const {
    return static_cast<std::size_t>(patch.y) * static_cast<std::size_t>(width / kPatchSamples) + static_cast<std::size_t>(patch.x);
  }
  bool is_needed_at_edge(const glm::ivec2& patch, const glm::ivec2& step) const {
    for (int k = 0; k < kPatchSamples; ++k) {
      const int x = step.x > 0 ? kPatchSamples - 1 : step.x < 0 ? 0 : k, y = step.y > 0 ? kPatchSamples - 1 : step.y < 0 ? 0 : k;
      if (needed[index(patch.x * kPatchSamples + x, patch.y * kPatchSamples + y)]) return true;
    }
    return false;
  }
  // 4×4 samples from (first.x, first.y) of the region.
  void cast_packet(const glm::ivec2& first, std::vector<OpenSample>& open) {
    int i[kPacketSize], j[kPacketSize], at[kPacketSize];
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const int x = first.x + lane % 4, y = first.y + lane / 4;
      i[lane] = finder_.face_block_x(0) * kBlockSamples + x, j[lane] = finder_.face_block_y(0) * kBlockSamples + y;
      at[lane] = i[lane] < frame_.edge_samples && j[lane] < frame_.edge_samples ? index(x, y) : -1;
    }
    cast_samples(scene_, space_, frame_, i, j, at, arrays, uneven);
    for (int lane = 0; lane < kPacketSize; ++lane)
      if (is_asked_about(first.x + lane % 4, first.y + lane / 4) && at[lane] >= 0 && arrays.covered[at[lane]])
        open.push_back(sample_at(i[lane], j[lane], at[lane]));
  }
  // Whether earlier views hold a sample is asked of every other one, as on a chessboard. One between two that are needed is
  // needed as well.
  static bool is_asked_about(int x, int y) { return (x + y) % 2 == 0; }
  void infer_needed(const glm::ivec2& patch) {
    for (int k = 0; k < kPacketSize; ++k) {
      const int x = patch.x * kPatchSamples + k % kPatchSamples, y = patch.y * kPatchSamples + k / kPatchSamples;
      if (is_asked_about(x, y) || !arrays.covered[index(x, y)]) continue;
      const int beside = (x > 0 && needed[index(x - 1, y)]) + (x + 1 < width && needed[index(x + 1, y)]);
      const int above_or_below = (y > 0 && needed[index(x, y - 1)]) + (y + 1 < height && needed[index(x, y + 1)]);
      if (beside + above_or_below >= 2) needed[index(x, y)] = 1;
    }
  }
  // What was hit, found again from its disparity and plane.
  OpenSample sample_at(int i, int j, int at) const {
    const glm::dvec3 direction = frame_.direction(i, j);
    const double disparity = arrays.disparity[at];
    // From d = side·(n·D)/c: n_u = gradient_i, n_v = gradient_j per pitch, n·D = d fixes the third component.
    const double nu = arrays.gradient_i[at] / frame_.pitch, nv = arrays.gradient_j[at] / frame_.pitch;
    const CubeFace& face = frame_.face;
    glm::dvec3 normal;
    normal[face.u_axis()] = nu;
    normal[face.v_axis()] = nv;
    normal[face.axis] = face.sign * (disparity - nu * direction[face.u_axis()] - nv * direction[face.v_axis()]);
    return {frame_.position + direction * (frame_.side_m / disparity), normal, at};
  }

  const Scene& scene_;
  const CellSpace& space_;
  const ViewFrame& frame_;
  const VoidFinder& finder_;
  std::vector<std::uint8_t> is_cast_;
};

}  // namespace

Tile cast_delta_tile(const Scene& scene, const CellSpace& space, const std::vector<glm::dvec3>& views, const TileId& id,
                     const ImpostorSettings& settings, double warp_gain, double tolerance, const VisibleBlocks* visible, TileWork& work, DeltaSkips& skips) {
  StageClock clock;
  Tile tile;
  tile.id = id;
  const int edge_samples = settings.edge_samples(id.view);
  tile.edge_samples = edge_samples;
  const glm::dvec3 view = views[id.view];
  tile.view_offset = glm::vec3((view - space.box.center()) / space.side_m);
  tile.disparity_tolerance = static_cast<float>(tolerance);
  const ViewFrame frame = ViewFrame::of(space, view, id.face, edge_samples);
  // A blocker nearer to the point than the tolerance can tell is the point itself: relative slack tolerance·z.
  const double nearest = exit_distance(space.shell.inside, view, frame.face.direction(0.0, 0.0)) / space.side_m;
  const VoidFinder finder(scene, space, views, id, frame, settings, visible, warp_gain, std::min(0.05, tolerance * nearest));
  skips.blocks_probed += static_cast<std::size_t>(finder.columns()) * finder.rows();
  std::vector<glm::ivec2> voids = finder.find_voids();
  clock.lap(work.seconds.search);
  if (voids.empty()) return tile;
  RegionSamples region(scene, space, frame, finder);
  region.cast(std::move(voids));
  const std::vector<glm::ivec2> blocks = region.blocks();
  skips.blocks_cast += blocks.size();
  work.rays += region.patches * kPacketSize;
  const std::vector<std::uint8_t> kept = region.with_border();
  clock.lap(work.seconds.delta);
  shade_uneven(scene, frame, region.uneven, kept, region.arrays);
  clock.lap(work.seconds.colours);

  std::vector<glm::ivec2> full;
  for (const glm::ivec2& block : blocks) {
    std::size_t count = 0;
    for (int k = 0; k < kBlockSamples * kBlockSamples; ++k) {
      const int index = region.index(block.x * kBlockSamples + k % kBlockSamples, block.y * kBlockSamples + k / kBlockSamples);
      count += region.needed[index];
      skips.samples_held += region.arrays.covered[index] && !kept[index];
    }
    if (count < kFewestNeeded) continue;
    full.push_back(block);
    tile.blocks.push_back({static_cast<std::uint16_t>(finder.face_block_x(block.x)), static_cast<std::uint16_t>(finder.face_block_y(block.y))});
  }
  if (full.empty()) return tile;
  set_size(tile);
  const std::size_t size = tile.samples();
  SampleArrays arrays(size);
  std::vector<int> sample_i(size, -1), sample_j(size, -1);
  tile.coverage.assign(size, 0);
  for (std::size_t b = 0; b < full.size(); ++b)
    for (int k = 0; k < kBlockSamples * kBlockSamples; ++k) {
      const int x = k % kBlockSamples, y = k / kBlockSamples;
      const int from = region.index(full[b].x * kBlockSamples + x, full[b].y * kBlockSamples + y);
      const int to = packed_index(tile, b, x, y);
      const int i = tile.blocks[b].x * kBlockSamples + x, j = tile.blocks[b].y * kBlockSamples + y;
      if (i >= edge_samples || j >= edge_samples) continue;
      tile.coverage[to] = kept[from];
      sample_i[to] = i, sample_j[to] = j;
      arrays.known[to] = region.arrays.known[from];
      arrays.covered[to] = region.arrays.covered[from];
      arrays.disparity[to] = region.arrays.disparity[from];
      arrays.gradient_i[to] = region.arrays.gradient_i[from], arrays.gradient_j[to] = region.arrays.gradient_j[from];
      arrays.part[to] = region.arrays.part[from], arrays.refined[to] = region.arrays.refined[from];
      for (int c = 0; c < 3; ++c) arrays.rgb[3 * std::size_t(to) + c] = region.arrays.rgb[3 * std::size_t(from) + c];
    }
  const ConnectionLimits limits = connection_limits(frame, warp_gain);
  const TileNeighbours neighbours(tile);
  find_cuts(scene, space, frame, arrays, limits, neighbours, sample_i, sample_j, tile);
  clock.lap(work.seconds.cuts);
  supersample_colours(scene, space, frame, limits, neighbours, sample_i, sample_j, tile, arrays);
  work.count_colours(tile, arrays);
  tile.disparity = std::move(arrays.disparity);
  sharpen_colours(tile, arrays.rgb);
  tile.rgb = std::move(arrays.rgb);
  clock.lap(work.seconds.colours);
  return tile;
}

}  // namespace farfield
