// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/delta_tile.h"

#include <algorithm>
#include <array>

namespace farfield {
namespace {

// Surfaces that an earlier view holds so obliquely that its samples stretch over more than this many of this view's count
// as void. At two, a tenth more bytes gain a tenth of a decibel.
constexpr double kLargestStretch = 3.0;

// Blocks that miss fewer of their 64 samples are left out: single leaves seen between leaves. They are a tenth of the
// bytes in foliage, and their voids a few thousandths of a percent of a frame.
constexpr std::size_t kFewestNeeded = 5;

class DeltaCaster {
 public:
  DeltaCaster(const Scene& scene, const CellSpace& space, const std::vector<glm::dvec3>& views, const TileId& id,
              const ViewFrame& frame, const ImpostorSettings& settings, double slack)
      : scene_(scene), space_(space), views_(views), id_(id), frame_(frame),
        intra_stretch_(kLargestStretch * settings.edge_samples() / frame.edge_samples), slack_(slack) {
    const int blocks = (frame.edge_samples + kBlockSamples - 1) / kBlockSamples;
    columns_ = std::min(kRegionBlocks, blocks - id.x * kRegionBlocks);
    rows_ = std::min(kRegionBlocks, blocks - id.y * kRegionBlocks);
  }

  // Four rays per block, four blocks a packet; a block with a void brings its eight neighbours along, also those across
  // the region's border: one ring of blocks around the region is probed with it.
  std::vector<BlockPlace> find_blocks(const VisibleBlocks* visible, DeltaSkips& skips) const {
    const int face_blocks = (frame_.edge_samples + kBlockSamples - 1) / kBlockSamples;
    const auto is_probed = [&](int x, int y) {
      const int fx = face_block_x(x), fy = face_block_y(y);
      if (x < -1 || y < -1 || x > columns_ || y > rows_ || fx < 0 || fy < 0 || fx >= face_blocks || fy >= face_blocks) return false;
      return !visible || visible->contains(id_.face, fx * kBlockSamples, fy * kBlockSamples);
    };
    const int stride = columns_ + 2;
    std::vector<std::uint8_t> wanted(static_cast<std::size_t>(stride) * (rows_ + 2), 0);
    for (int y = -1; y <= rows_; y += 2)
      for (int x = -1; x <= columns_; x += 2) {
        RayPacket rays;
        HitPacket hits;
        rays.active = 0;
        const auto block_of = [&](int lane) { return glm::ivec2(x + lane / 4 % 2, y + lane / 8); };
        for (int lane = 0; lane < kPacketSize; ++lane) {
          const glm::ivec2 block = block_of(lane);
          if (!is_probed(block.x, block.y)) continue;
          rays.active |= 1u << lane;
          // Off the grid's diagonals, so that lines along the axes are met by each of the four.
          constexpr double kPlaces[4][2] = {{1.0, 2.5}, {4.5, 1.0}, {2.5, 6.0}, {6.0, 4.5}};
          const double i = face_block_x(block.x) * kBlockSamples + kPlaces[lane % 4][0];
          const double j = face_block_y(block.y) * kBlockSamples + kPlaces[lane % 4][1];
          set_ray(rays, lane, frame_.position, frame_.direction(i, j), space_.shell);
        }
        if (!rays.active) continue;
        scene_.intersect(rays, hits);
        const std::uint32_t missing = unheld(rays, hits);
        for (int lane = 0; lane < kPacketSize; ++lane) {
          const glm::ivec2 block = block_of(lane);
          if (missing >> lane & 1) wanted[static_cast<std::size_t>(block.y + 1) * stride + block.x + 1] = 1;
        }
      }
    std::vector<BlockPlace> blocks;
    for (int x = 0; x < columns_; ++x)
      for (int y = 0; y < rows_; ++y) {
        if (!is_probed(x, y)) continue;
        bool near = false;
        for (int dy = 0; dy <= 2; ++dy)
          for (int dx = 0; dx <= 2; ++dx) near = near || wanted[static_cast<std::size_t>(y + dy) * stride + x + dx];
        if (near) blocks.push_back({static_cast<std::uint16_t>(face_block_x(x)), static_cast<std::uint16_t>(face_block_y(y))});
      }
    skips.blocks_probed += static_cast<std::size_t>(columns_) * rows_;
    skips.blocks_cast += blocks.size();
    return blocks;
  }

  // Lanes that hit something no earlier view holds.
  std::uint32_t unheld(const RayPacket& rays, const HitPacket& hits) const {
    std::uint32_t open = 0;
    glm::dvec3 points[kPacketSize], normals[kPacketSize];
    for (int lane = 0; lane < kPacketSize; ++lane) {
      if (!(rays.active >> lane & 1) || hits.part[lane] == kNoHit) continue;
      points[lane] = hit_point(rays, hits, lane);
      open |= 1u << lane;
      normals[lane] = {hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]};
    }
    for (int view = 0; view < id_.view && open; ++view) {
      RayPacket segments;
      segments.active = 0;
      for (int lane = 0; lane < kPacketSize; ++lane) {
        if (!(open >> lane & 1) || stretches(points[lane], normals[lane], view)) continue;
        segments.active |= 1u << lane;
        set_segment(segments, lane, views_[view], points[lane], space_, slack_);
      }
      if (!segments.active) continue;
      open &= ~segments.active | scene_.occluded(segments);
    }
    return open;
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
  int face_block_x(int x) const { return id_.x * kRegionBlocks + x; }
  int face_block_y(int y) const { return id_.y * kRegionBlocks + y; }

  const Scene& scene_;
  const CellSpace& space_;
  const std::vector<glm::dvec3>& views_;
  const TileId& id_;
  const ViewFrame& frame_;
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

struct PackedSamples {
  SampleArrays arrays;
  std::vector<std::uint8_t> needed;
  std::vector<int> i, j;  // on the face, -1: padding
};

PackedSamples cast_blocks(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const DeltaCaster& caster,
                          const Tile& tile) {
  PackedSamples s{SampleArrays(tile.samples()), std::vector<std::uint8_t>(tile.samples(), 0),
                  std::vector<int>(tile.samples(), -1), std::vector<int>(tile.samples(), -1)};
  for (std::size_t b = 0; b < tile.blocks.size(); ++b)
    for (int quarter = 0; quarter < 4; ++quarter) {
      int i[kPacketSize], j[kPacketSize], index[kPacketSize];
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const int x = quarter % 2 * 4 + lane % 4, y = quarter / 2 * 4 + lane / 4;
        i[lane] = tile.blocks[b].x * kBlockSamples + x, j[lane] = tile.blocks[b].y * kBlockSamples + y;
        index[lane] = packed_index(tile, b, x, y);
        if (i[lane] >= frame.edge_samples || j[lane] >= frame.edge_samples) index[lane] = -1;
        if (index[lane] >= 0) s.i[index[lane]] = i[lane], s.j[index[lane]] = j[lane];
      }
      cast_samples(scene, space, frame, i, j, index, s.arrays);
      // What was hit is found again from its disparity and plane, in the form the visibility test wants.
      RayPacket rays;
      HitPacket hits;
      rays.active = 0;
      for (int lane = 0; lane < kPacketSize; ++lane) {
        hits.part[lane] = kNoHit;
        if (index[lane] < 0 || !s.arrays.covered[index[lane]]) continue;
        rays.active |= 1u << lane;
        const glm::dvec3 direction = frame.direction(i[lane], j[lane]);
        set_ray(rays, lane, frame.position, direction, space.shell);
        hits.part[lane] = 0;
        const double disparity = s.arrays.disparity[index[lane]];
        hits.distance[lane] = static_cast<float>(frame.side_m / disparity);
        // From d = side·(n·D)/c: n_u = gradient_i, n_v = gradient_j per pitch, n·D = d fixes the third component.
        float normal[3];
        const double nu = s.arrays.gradient_i[index[lane]] / frame.pitch, nv = s.arrays.gradient_j[index[lane]] / frame.pitch;
        const CubeFace& face = frame.face;
        normal[face.u_axis()] = static_cast<float>(nu);
        normal[face.v_axis()] = static_cast<float>(nv);
        normal[face.axis] = static_cast<float>(face.sign * (disparity - nu * direction[face.u_axis()] - nv * direction[face.v_axis()]));
        hits.normal_x[lane] = normal[0], hits.normal_y[lane] = normal[1], hits.normal_z[lane] = normal[2];
      }
      const std::uint32_t missing = rays.active ? caster.unheld(rays, hits) : 0;
      for (int lane = 0; lane < kPacketSize; ++lane)
        if (index[lane] >= 0) s.needed[index[lane]] = missing >> lane & 1;
    }
  return s;
}

// A needed sample brings its four neighbours along, so that its surface meets the one that another view holds.
std::vector<std::uint8_t> with_border(const Tile& tile, const PackedSamples& s) {
  const TileNeighbours neighbours(tile);
  std::vector<std::uint8_t> kept = s.needed;
  for (int index = 0; index < static_cast<int>(tile.samples()); ++index) {
    if (!s.needed[index]) continue;
    for (const int other : {neighbours.right(index), neighbours.down(index), neighbours.left(index), neighbours.up(index)})
      if (other >= 0 && s.arrays.covered[other]) kept[other] = 1;
  }
  return kept;
}

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
  const DeltaCaster caster(scene, space, views, id, frame, settings, std::min(0.05, tolerance * nearest));
  tile.blocks = caster.find_blocks(visible, skips);
  if (tile.blocks.empty()) return tile;
  set_size(tile);
  PackedSamples s = cast_blocks(scene, space, frame, caster, tile);
  work.rays += tile.samples();
  std::vector<std::uint8_t> kept = with_border(tile, s);

  // Blocks in which nothing is missing were only brought along: leave them out.
  std::vector<std::size_t> full;
  for (std::size_t b = 0; b < tile.blocks.size(); ++b) {
    std::size_t count = 0;
    for (int k = 0; k < kBlockSamples * kBlockSamples; ++k) {
      const int index = packed_index(tile, b, k % kBlockSamples, k / kBlockSamples);
      count += s.needed[index];
      skips.samples_held += s.arrays.covered[index] && !kept[index];
    }
    if (count >= kFewestNeeded) full.push_back(b);
  }
  Tile packed = tile;
  packed.blocks.clear();
  for (const std::size_t b : full) packed.blocks.push_back(tile.blocks[b]);
  if (packed.blocks.empty()) return packed;
  set_size(packed);
  const std::size_t size = packed.samples();
  SampleArrays arrays(size);
  std::vector<int> sample_i(size, -1), sample_j(size, -1);
  packed.coverage.assign(size, 0), packed.cut_right.assign(size, 0), packed.cut_down.assign(size, 0);
  for (std::size_t b = 0; b < full.size(); ++b)
    for (int k = 0; k < kBlockSamples * kBlockSamples; ++k) {
      const int from = packed_index(tile, full[b], k % kBlockSamples, k / kBlockSamples);
      const int to = packed_index(packed, b, k % kBlockSamples, k / kBlockSamples);
      packed.coverage[to] = kept[from];
      sample_i[to] = s.i[from], sample_j[to] = s.j[from];
      arrays.known[to] = s.arrays.known[from];
      arrays.covered[to] = s.arrays.covered[from];
      arrays.disparity[to] = s.arrays.disparity[from];
      arrays.gradient_i[to] = s.arrays.gradient_i[from], arrays.gradient_j[to] = s.arrays.gradient_j[from];
      for (int c = 0; c < 3; ++c) arrays.rgb[3 * std::size_t(to) + c] = s.arrays.rgb[3 * std::size_t(from) + c];
    }
  find_cuts(scene, space, frame, arrays, connection_limits(frame, warp_gain), TileNeighbours(packed), sample_i, sample_j, packed);
  packed.disparity = std::move(arrays.disparity);
  packed.rgb = std::move(arrays.rgb);
  return packed;
}

}  // namespace farfield
