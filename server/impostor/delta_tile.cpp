// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/delta_tile.h"

#include <algorithm>
#include <cstring>

#include "server/impostor/held_points.h"
#include "server/impostor/supersample.h"

namespace farfield {
namespace {

// Surfaces that an earlier view holds so obliquely that its samples stretch over more than this many of this view's count
// as void. At two, up to a twentieth more bytes gain a few hundredths of a decibel.
constexpr double kLargestStretch = 3.0;

// Blocks that miss fewer of their 64 samples are left out: what shows between leaves. At three, a hundredth of the bytes
// costs a street with trees a fifteenth more void.
constexpr std::size_t kFewestNeeded = 2;

// A block is cast in patches of a packet each, where a probe finds a void or one reaches on from the next patch: what is
// missing runs along the rims of nearer things, through a third of a block's samples.
constexpr int kPatchSamples = 4;
constexpr int kBlockPatches = kBlockSamples / kPatchSamples;
static_assert(kPatchSamples * kPatchSamples == kPacketSize);

// What a ray of this view hit, until an earlier view is found to hold it.
struct OpenSample {
  glm::dvec3 point, normal;  // scene frame; the normal of any length
  int index;
};

class DeltaCaster {
 public:
  DeltaCaster(const Scene& scene, const CellSpace& space, const std::vector<glm::dvec3>& views, const TileId& id,
              const ViewFrame& frame, const ImpostorSettings& settings, const VisibleBlocks* visible, double slack)
      : scene_(scene), space_(space), views_(views), id_(id), frame_(frame), visible_(visible),
        intra_stretch_(kLargestStretch * settings.edge_samples() / frame.edge_samples), slack_(slack) {
    const int blocks = (frame.edge_samples + kBlockSamples - 1) / kBlockSamples;
    columns_ = std::min(kRegionBlocks, blocks - id.x * kRegionBlocks);
    rows_ = std::min(kRegionBlocks, blocks - id.y * kRegionBlocks);
  }

  int columns() const { return columns_; }  // of blocks; regions at a face's end have fewer
  int rows() const { return rows_; }
  int face_block_x(int x) const { return id_.x * kRegionBlocks + x; }
  int face_block_y(int y) const { return id_.y * kRegionBlocks + y; }
  /// Whether block (x, y) of the region, or of the ring of blocks around it, is on the face and visible to somebody.
  bool is_visible(int x, int y) const {
    const int fx = face_block_x(x), fy = face_block_y(y), blocks = (frame_.edge_samples + kBlockSamples - 1) / kBlockSamples;
    if (x < -1 || y < -1 || x > columns_ || y > rows_ || fx < 0 || fy < 0 || fx >= blocks || fy >= blocks) return false;
    return !visible_ || visible_->contains(id_.face, fx * kBlockSamples, fy * kBlockSamples);
  }

  // Patches whose one ray meets a void; four blocks a packet. The ring of blocks around the region is probed with it: a
  // void that reaches across the border counts for the patch inside.
  std::vector<glm::ivec2> find_voids() const {
    const int stride = (columns_ + 2) * kBlockPatches;
    std::vector<OpenSample> open;
    for (int y = -1; y <= rows_; y += 2)
      for (int x = -1; x <= columns_; x += 2) {
        RayPacket rays;
        HitPacket hits;
        rays.active = 0;
        const auto block_of = [&](int lane) { return glm::ivec2(x + lane / 4 % 2, y + lane / 8); };
        for (int lane = 0; lane < kPacketSize; ++lane) {
          const glm::ivec2 block = block_of(lane);
          if (!is_visible(block.x, block.y)) continue;
          rays.active |= 1u << lane;
          // One in each patch, off the grid's diagonals, so that lines along the axes are met by each of the four.
          constexpr double kPlaces[4][2] = {{1.0, 2.5}, {4.5, 1.0}, {2.5, 6.0}, {6.0, 4.5}};
          const double i = face_block_x(block.x) * kBlockSamples + kPlaces[lane % 4][0];
          const double j = face_block_y(block.y) * kBlockSamples + kPlaces[lane % 4][1];
          set_ray(rays, lane, frame_.position, frame_.direction(i, j), space_.shell);
        }
        if (!rays.active) continue;
        scene_.intersect(rays, hits);
        for (int lane = 0; lane < kPacketSize; ++lane) {
          if (!(rays.active >> lane & 1) || hits.part[lane] == kNoHit) continue;
          const glm::ivec2 patch = (block_of(lane) + 1) * kBlockPatches + glm::ivec2(lane % 2, lane / 2 % 2);
          open.push_back({hit_point(rays, hits, lane), {hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]},
                          patch.y * stride + patch.x});
        }
      }
    drop_held_by_earlier(open);
    std::vector<glm::ivec2> patches;
    const glm::ivec2 last = glm::ivec2(columns_, rows_) * kBlockPatches - 1;
    for (const OpenSample& sample : open)
      patches.push_back(glm::clamp(glm::ivec2(sample.index % stride, sample.index / stride) - kBlockPatches, glm::ivec2(0), last));
    return patches;
  }

  // What is left no earlier view holds.
  void drop_held_by_earlier(std::vector<OpenSample>& open) const {
    for (int view = 0; view < id_.view && !open.empty(); ++view)
      drop_held(
          scene_, space_, slack_, PointSpacing::kDense, views_[view], open,
          [&](const OpenSample& sample) { return stretches(sample.point, sample.normal, view); }, [](const OpenSample&) {});
  }

 private:
  // Sample density of a view on a surface element goes with cos/r² per solid angle: its root ratio of densities along
  // the direction of steepest slant is (cos/r) of one view against (cos/r) of the other.
  bool stretches(const glm::dvec3& point, const glm::dvec3& normal, int earlier) const {
    const glm::dvec3 from_here = point - frame_.position, from_there = point - views_[earlier];
    const double here = std::abs(glm::dot(normal, from_here)) / glm::dot(from_here, from_here);
    const double there = std::abs(glm::dot(normal, from_there)) / glm::dot(from_there, from_there);
    return here > (earlier == kIntraView ? intra_stretch_ : kLargestStretch) * there;
  }

  const Scene& scene_;
  const CellSpace& space_;
  const std::vector<glm::dvec3>& views_;
  const TileId& id_;
  const ViewFrame& frame_;
  const VisibleBlocks* visible_;
  const double intra_stretch_;  // the intra view has more samples
  const double slack_;
  int columns_ = 0, rows_ = 0;
};

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
  RegionSamples(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const DeltaCaster& caster)
      : width(caster.columns() * kBlockSamples), height(caster.rows() * kBlockSamples),
        arrays(static_cast<std::size_t>(width) * height), needed(static_cast<std::size_t>(width) * height, 0), scene_(scene), space_(space),
        frame_(frame), caster_(caster),
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
        if (is_cast || !caster_.is_visible(patch.x / kBlockPatches, patch.y / kBlockPatches)) continue;
        is_cast = 1;
        cast_packet(patch * kPatchSamples, open);
        fresh.push_back(patch);
      }
      caster_.drop_held_by_earlier(open);
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
    for (int x = 0; x < caster_.columns(); ++x)
      for (int y = 0; y < caster_.rows(); ++y) {
        bool any = false;
        for (int k = 0; k < kBlockPatches * kBlockPatches; ++k)
          any = any || is_cast_[place_of(glm::ivec2(x, y) * kBlockPatches + glm::ivec2(k % kBlockPatches, k / kBlockPatches))];
        if (any) result.push_back({x, y});
      }
    return result;
  }

  // A needed sample brings its four neighbours along, so that its surface meets the one that another view holds.
  std::vector<std::uint8_t> with_border() const {
    std::vector<std::uint8_t> kept = needed;
    const std::uint8_t *const begin = needed.data(), *const end = begin + needed.size();
    const auto next = [&](const std::uint8_t* from) {  // most are not needed
      return static_cast<const std::uint8_t*>(std::memchr(from, 1, static_cast<std::size_t>(end - from)));
    };
    for (const std::uint8_t* found = next(begin); found; found = next(found + 1)) {
      const int at = static_cast<int>(found - begin), x = at % width, y = at / width;
      const auto keep = [&](bool is_inside, int other) {
        if (is_inside && arrays.covered[other]) kept[other] = 1;
      };
      keep(x + 1 < width, at + 1), keep(x > 0, at - 1);
      keep(y + 1 < height, at + width), keep(y > 0, at - width);
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
      i[lane] = caster_.face_block_x(0) * kBlockSamples + x, j[lane] = caster_.face_block_y(0) * kBlockSamples + y;
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
  const DeltaCaster& caster_;
  std::vector<std::uint8_t> is_cast_;
};

}  // namespace

Tile cast_delta_tile(const Scene& scene, const CellSpace& space, const std::vector<glm::dvec3>& views, const TileId& id,
                     const ImpostorSettings& settings, double warp_gain, double tolerance, const VisibleBlocks* visible, TileWork& work, DeltaSkips& skips) {
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
  const DeltaCaster caster(scene, space, views, id, frame, settings, visible, std::min(0.05, tolerance * nearest));
  skips.blocks_probed += static_cast<std::size_t>(caster.columns()) * caster.rows();
  std::vector<glm::ivec2> voids = caster.find_voids();
  if (voids.empty()) return tile;
  RegionSamples region(scene, space, frame, caster);
  region.cast(std::move(voids));
  const std::vector<glm::ivec2> blocks = region.blocks();
  skips.blocks_cast += blocks.size();
  work.rays += region.patches * kPacketSize;
  const std::vector<std::uint8_t> kept = region.with_border();
  shade_uneven(scene, frame, region.uneven, kept, region.arrays);

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
    tile.blocks.push_back({static_cast<std::uint16_t>(caster.face_block_x(block.x)), static_cast<std::uint16_t>(caster.face_block_y(block.y))});
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
  supersample_colours(scene, space, frame, limits, neighbours, sample_i, sample_j, tile, arrays);
  work.count_colours(tile, arrays);
  tile.disparity = std::move(arrays.disparity);
  tile.rgb = std::move(arrays.rgb);
  return tile;
}

}  // namespace farfield
