// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/void_finder.h"

#include <algorithm>

#include "server/impostor/connectivity.h"
#include "server/impostor/held_points.h"
#include "server/impostor/sample_density.h"

namespace farfield {
namespace {

OpenSample open_at(const RayPacket& rays, const HitPacket& hits, int lane, int index) {
  return {hit_point(rays, hits, lane), {hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]}, index};
}

}  // namespace

VoidFinder::VoidFinder(const Scene& scene, const CellSpace& space, const std::vector<glm::dvec3>& views, const TileId& id,
            const ViewFrame& frame, const ImpostorSettings& settings, const VisibleBlocks* visible, double warp_gain, double slack)
    : scene_(scene), space_(space), views_(views), id_(id), frame_(frame), visible_(visible),
      settings_(settings), one_sample_(connection_limits(frame, warp_gain).one_sample), slack_(slack) {
  const int blocks = (frame.edge_samples + kBlockSamples - 1) / kBlockSamples;
  columns_ = std::min(kRegionBlocks, blocks - id.x * kRegionBlocks);
  rows_ = std::min(kRegionBlocks, blocks - id.y * kRegionBlocks);
}

bool VoidFinder::is_visible(int x, int y) const {
  const int fx = face_block_x(x), fy = face_block_y(y), blocks = (frame_.edge_samples + kBlockSamples - 1) / kBlockSamples;
  if (x < -1 || y < -1 || x > columns_ || y > rows_ || fx < 0 || fy < 0 || fx >= blocks || fy >= blocks) return false;
  return !visible_ || visible_->contains(id_.face, fx * kBlockSamples, fy * kBlockSamples);
}

void VoidFinder::set_probe(RayPacket& rays, int lane, const glm::ivec2& patch, const glm::dvec2& place) const {
  const glm::ivec2 first = glm::ivec2(face_block_x(0), face_block_y(0)) * kBlockSamples + patch * kPatchSamples;
  set_ray(rays, lane, frame_.position, frame_.direction(first.x + place.x, first.y + place.y), space_.shell);
}

std::vector<OpenSample> VoidFinder::probe_once(std::vector<Probe>& probes) const {
  std::vector<OpenSample> open;
  for (int y = -1; y <= rows_; y += 2)
    for (int x = -1; x <= columns_; x += 2) {
      RayPacket rays;
      HitPacket hits;
      rays.active = 0;
      const auto block_of = [&](int lane) { return glm::ivec2(x + lane / 4 % 2, y + lane / 8); };
      const auto patch_of = [&](int lane) { return block_of(lane) * kBlockPatches + glm::ivec2(lane % 2, lane / 2 % 2); };
      const auto index_of = [&](int lane) { return probe_index(patch_of(lane)); };
      for (int lane = 0; lane < kPacketSize; ++lane) {
        const glm::ivec2 block = block_of(lane);
        if (!is_visible(block.x, block.y)) continue;
        rays.active |= 1u << lane;
        // One in each patch, off the grid's diagonals, so that lines along the axes are met by each of the four.
        constexpr glm::dvec2 kPlaces[4] = {{1.0, 2.5}, {0.5, 1.0}, {2.5, 2.0}, {2.0, 0.5}};
        set_probe(rays, lane, patch_of(lane), kPlaces[lane % 4]);
        probes[static_cast<std::size_t>(index_of(lane))] = {kPlaces[lane % 4] + glm::dvec2(patch_of(lane) * kPatchSamples), true, {}};
      }
      if (!rays.active) continue;
      scene_.intersect(rays, hits);
      for (int lane = 0; lane < kPacketSize; ++lane) {
        if (!(rays.active >> lane & 1) || hits.part[lane] == kNoHit) continue;
        probes[static_cast<std::size_t>(index_of(lane))].plane = plane_at(frame_, rays, hits, lane);
        open.push_back(open_at(rays, hits, lane, index_of(lane)));
      }
    }
  return open;
}

// Patches of the region that a rim between two probes may pass: the farther one's, where the void would be. Before the
// sky it is the nearer one's: what earlier views do not see there is the nearer thing's own far side.
std::vector<glm::ivec2> VoidFinder::beside_rims(const std::vector<Probe>& probes, const std::vector<std::uint8_t>& is_wanted) const {
  std::vector<std::uint8_t> is_beside(probes.size(), 0);
  const auto compare = [&](std::size_t first, std::size_t second) {
    const Probe &a = probes[first], &b = probes[second];
    if (!a.is_cast || !b.is_cast || are_one_surface(a, b)) return;
    const bool is_first_farther = a.plane.disparity < b.plane.disparity, is_sky = !(std::min(a.plane.disparity, b.plane.disparity) > 0);
    is_beside[is_first_farther != is_sky ? first : second] = 1;
  };
  const auto columns = static_cast<std::size_t>(probe_columns());
  for (std::size_t index = 0; index < probes.size(); ++index) {
    if ((index + 1) % columns != 0) compare(index, index + 1);
    if (index + columns < probes.size()) compare(index, index + columns);
  }
  std::vector<glm::ivec2> patches;
  for (int y = 0; y < rows_ * kBlockPatches; ++y)
    for (int x = 0; x < columns_ * kBlockPatches; ++x) {
      const auto index = static_cast<std::size_t>(probe_index({x, y}));
      if (is_beside[index] && !is_wanted[index]) patches.push_back({x, y});
    }
  return patches;
}

// Each lies on the other's plane, within what moves it by a sample.
bool VoidFinder::are_one_surface(const Probe& a, const Probe& b) const {
  if (!(a.plane.disparity > 0) || !(b.plane.disparity > 0)) return !(a.plane.disparity > 0) && !(b.plane.disparity > 0);
  const glm::dvec2 step = b.place - a.place;
  const double at_b = a.plane.disparity + a.plane.gradient_i * step.x + a.plane.gradient_j * step.y;
  const double at_a = b.plane.disparity - b.plane.gradient_i * step.x - b.plane.gradient_j * step.y;
  return std::abs(at_b - b.plane.disparity) <= one_sample_ && std::abs(at_a - a.plane.disparity) <= one_sample_;
}

std::vector<OpenSample> VoidFinder::probe_again(const std::vector<glm::ivec2>& patches) const {
  std::vector<OpenSample> open;
  // On the diagonal that the first probes leave out, so that narrow voids along either axis are met.
  constexpr glm::dvec2 kPlaces[] = {{0.4, 0.6}, {2.6, 2.4}};
  constexpr std::size_t kRays = std::size(kPlaces), kTogether = kPacketSize / kRays;
  for (std::size_t base = 0; base < patches.size(); base += kTogether) {
    const std::size_t lanes = kRays * std::min(kTogether, patches.size() - base);
    RayPacket rays;
    HitPacket hits;
    rays.active = (1u << lanes) - 1;
    for (std::size_t lane = 0; lane < lanes; ++lane) set_probe(rays, static_cast<int>(lane), patches[base + lane / kRays], kPlaces[lane % kRays]);
    scene_.intersect(rays, hits);
    for (std::size_t lane = 0; lane < lanes; ++lane)
      if (hits.part[lane] != kNoHit) open.push_back(open_at(rays, hits, static_cast<int>(lane), probe_index(patches[base + lane / kRays])));
  }
  return open;
}

std::vector<glm::ivec2> VoidFinder::find_voids() const {
  std::vector<Probe> probes(static_cast<std::size_t>(probe_columns()) * static_cast<std::size_t>((rows_ + 2) * kBlockPatches));
  std::vector<std::uint8_t> is_wanted(probes.size(), 0);
  const auto want = [&](std::vector<OpenSample> open) {
    drop_held_by_earlier(open);
    for (const OpenSample& sample : open) is_wanted[static_cast<std::size_t>(sample.index)] = 1;
  };
  want(probe_once(probes));
  want(probe_again(beside_rims(probes, is_wanted)));
  std::vector<glm::ivec2> patches;
  const glm::ivec2 last = glm::ivec2(columns_, rows_) * kBlockPatches - 1;
  for (int index = 0; index < static_cast<int>(probes.size()); ++index)
    if (is_wanted[static_cast<std::size_t>(index)]) patches.push_back(glm::clamp(probe_patch(index), glm::ivec2(0), last));
  return patches;
}

void VoidFinder::drop_held_by_earlier(std::vector<OpenSample>& open) const {
  for (int view = 0; view < id_.view && !open.empty(); ++view)
    drop_held(
        scene_, space_, slack_, PointSpacing::kDense, views_[view], open,
        [&](const OpenSample& sample) { return stretches(sample.point, sample.normal, view); }, [](const OpenSample&) {});
}

bool VoidFinder::stretches(const glm::dvec3& point, const glm::dvec3& normal, int earlier) const {
  const double here = slant_density(normal, point - frame_.position), there = slant_density(normal, point - views_[earlier]);
  return here > largest_stretch(settings_, static_cast<std::uint8_t>(earlier)) * there;
}

}  // namespace farfield
