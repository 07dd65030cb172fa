// SPDX-License-Identifier: Apache-2.0
#include "server/visibility/enclosures.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "server/visibility/sphere_rays.h"
#include "server/visibility/standpoints.h"

namespace farfield {
namespace {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(int a, int b) { parent_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

 private:
  std::vector<int> parent_;
};

// Sets lane `lane` to run from `from` to `to`.
void set_segment(RayPacket& rays, int lane, const glm::dvec3& from, const glm::dvec3& to) {
  set_ray(rays, lane, from, to - from, {});
  rays.far[lane] = 1;
}

constexpr int kNobody = -1;  // label of a voxel: no viewpoint is seen, or those of several enclosures are
constexpr int kDivided = -2;

// Walls of a large building divide many voxels: beyond these the borders stay as coarse as they are. Every voxel takes
// at most two bits of a mask, so none is larger than 8 kB.
constexpr std::size_t kMaxVoxels = std::size_t{1} << 15;
static_assert(kMaxVoxels / 4 <= EnclosureMask::kMaxBytes);

struct Voxel {
  int label = kNobody;
  std::uint32_t first_child = 0;
};

// The octree of labels, grown breadth first.
class Octree {
 public:
  Octree(const Scene& scene, const Box& box, const std::vector<glm::dvec3>& viewpoints, const std::vector<int>& groups,
         int group_count)
      : scene_(scene),
        box_(box),
        viewpoints_(viewpoints),
        groups_(groups),
        group_count_(group_count),
        joined_(group_count) {}

  /// Returns: whether more than one enclosure is left.
  bool grow(int depth) {
    std::vector<Place> level{{0, {0, 0, 0}}};
    voxels_.assign(1, {});
    // So deep every voxel is divided: what is smaller than an eighth of the box and lies within one may go unnoticed.
    constexpr int kAlways = 3;
    for (int at = 0; at < depth; ++at) {
      std::vector<Place> next;
      for (const Place& place : level) {
        if (at >= kAlways && (!is_mixed(label_[place.voxel]) || voxels_.size() + 8 > kMaxVoxels)) continue;
        voxels_[place.voxel] = {kDivided, static_cast<std::uint32_t>(voxels_.size())};
        for (int child = 0; child < 8; ++child) {
          const glm::ivec3 corner = 2 * place.corner + glm::ivec3(child & 1, child >> 1 & 1, child >> 2);
          next.push_back({static_cast<std::uint32_t>(voxels_.size()), corner});
          voxels_.push_back({});
        }
      }
      label_.resize(voxels_.size(), 0);
      level = std::move(next);
      if (at + 1 < kAlways) continue;
      for (const Place& place : level) label_[place.voxel] = seen_from_voxel(place.corner, at + 1);
      if (is_one()) return false;
    }
    for (std::size_t v = 0; v < voxels_.size(); ++v)
      if (voxels_[v].label != kDivided) voxels_[v].label = label_of(label_[v]);
    return true;
  }
  int group(int g) { return joined_.find(g); }
  EnclosureMask mask(int label) const {
    EnclosureMaskWriter writer;
    write(writer, 0, label);
    return *EnclosureMask::from_bytes(writer.take());
  }
  bool holds(int label) const {
    return std::any_of(voxels_.begin(), voxels_.end(), [&](const Voxel& v) { return v.label == label; });
  }

 private:
  struct Place {
    std::uint32_t voxel;
    glm::ivec3 corner;  // in voxels of its depth
  };

  bool is_one() {
    for (int g = 1; g < group_count_; ++g)
      if (joined_.find(g) != 0) return false;
    return true;
  }
  /// The one enclosure of a set of groups, or kNobody.
  int label_of(std::uint32_t seen) {
    int label = kNobody;
    for (int g = 0; g < group_count_; ++g) {
      if (!(seen >> g & 1)) continue;
      if (label != kNobody && label != joined_.find(g)) return kNobody;
      label = joined_.find(g);
    }
    return label;
  }
  bool is_mixed(std::uint32_t seen) { return seen != 0 && label_of(seen) == kNobody; }

  /// The groups seen from eight places of a voxel, one bit each.
  std::uint32_t seen_from_voxel(const glm::ivec3& corner, int depth) {
    const glm::dvec3 edge = box_.extent() / static_cast<double>(1 << depth);
    const glm::dvec3 low = box_.min + glm::dvec3(corner) * edge;
    const std::array<int, kPacketSize> targets = choose_targets(low + 0.5 * edge);
    std::uint32_t seen = 0;
    for (int place = 0; place < 8; ++place) {
      // Near the corners, and at no simple fraction: walls like to stand on round coordinates.
      const glm::dvec3 fraction(place & 1 ? 0.9127 : 0.0873, place & 2 ? 0.9241 : 0.0759, place & 4 ? 0.9173 : 0.0827);
      const std::uint32_t here = seen_from(low + fraction * edge, targets);
      for (int a = 0; a < group_count_; ++a)
        for (int b = a + 1; b < group_count_; ++b)
          if (here >> a & here >> b & 1) joined_.join(a, b);
      seen |= here;
    }
    return seen;
  }
  /// Of each group the viewpoints nearest to `point`, as many of each as there is room for. -1: no more.
  std::array<int, kPacketSize> choose_targets(const glm::dvec3& point) const {
    std::array<int, kPacketSize> targets;
    targets.fill(-1);
    const int each = kPacketSize / group_count_;
    std::vector<std::pair<double, int>> near;
    for (int g = 0; g < group_count_; ++g) {
      near.clear();
      for (std::size_t v = 0; v < viewpoints_.size(); ++v)
        if (groups_[v] == g) near.emplace_back(glm::distance(point, viewpoints_[v]), static_cast<int>(v));
      const int count = std::min(each, static_cast<int>(near.size()));
      std::partial_sort(near.begin(), near.begin() + count, near.end());
      for (int k = 0; k < count; ++k) targets[g * each + k] = near[k].second;
    }
    return targets;
  }
  std::uint32_t seen_from(const glm::dvec3& point, const std::array<int, kPacketSize>& targets) const {
    RayPacket rays;
    rays.active = 0;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      set_segment(rays, lane, point, viewpoints_[std::max(0, targets[lane])]);
      if (targets[lane] >= 0) rays.active |= 1u << lane;
    }
    const std::uint32_t open = rays.active & ~scene_.occluded(rays);
    std::uint32_t seen = 0;
    for (int lane = 0; lane < kPacketSize; ++lane)
      if (open >> lane & 1) seen |= 1u << groups_[targets[lane]];
    return seen;
  }
  /// Whether all of a voxel is `label`, or nothing of it: then there is nothing to divide for.
  bool is_uniform(std::uint32_t voxel, int label, bool& is_inside) const {
    const Voxel& v = voxels_[voxel];
    if (v.label != kDivided) {
      is_inside = v.label == label;
      return true;
    }
    if (!is_uniform(v.first_child, label, is_inside)) return false;
    for (std::uint32_t child = 1; child < 8; ++child) {
      bool is_other = false;
      if (!is_uniform(v.first_child + child, label, is_other) || is_other != is_inside) return false;
    }
    return true;
  }
  void write(EnclosureMaskWriter& writer, std::uint32_t voxel, int label) const {
    bool is_inside = false;
    if (is_uniform(voxel, label, is_inside)) {
      writer.fill(is_inside);
      return;
    }
    writer.divide();
    for (std::uint32_t child = 0; child < 8; ++child) write(writer, voxels_[voxel].first_child + child, label);
  }

  const Scene& scene_;
  const Box box_;
  const std::vector<glm::dvec3>& viewpoints_;
  const std::vector<int>& groups_;
  const int group_count_;
  DisjointSets joined_;
  std::vector<Voxel> voxels_;
  std::vector<std::uint32_t> label_;  // groups seen, by voxel
};

}  // namespace

std::vector<int> join_by_sight(const Scene& scene, const std::vector<glm::dvec3>& viewpoints) {
  const int count = static_cast<int>(viewpoints.size());
  DisjointSets sets(viewpoints.size());
  RayPacket rays;
  std::array<std::pair<int, int>, kPacketSize> pairs;
  int filled = 0;
  const auto cast = [&] {
    rays.active = (1u << filled) - 1;
    const std::uint32_t hidden = scene.occluded(rays);
    for (int lane = 0; lane < filled; ++lane)
      if (!(hidden >> lane & 1)) sets.join(pairs[lane].first, pairs[lane].second);
    filled = 0;
  };
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) {
      set_segment(rays, filled, viewpoints[a], viewpoints[b]);
      pairs[filled] = {a, b};
      if (++filled == kPacketSize) cast();
    }
  if (filled > 0) cast();
  std::vector<int> enclosure(viewpoints.size());
  std::vector<int> number(viewpoints.size(), -1);
  int next = 0;
  for (int v = 0; v < count; ++v) {
    int& named = number[sets.find(v)];
    if (named < 0) named = next++;
    enclosure[v] = named;
  }
  return enclosure;
}

namespace {

// Free places of a lattice that none of `viewpoints` sees, a few for each group of places that see each other.
std::vector<glm::dvec3> find_hidden_places(const Scene& scene, const Box& box,
                                           const std::vector<glm::dvec3>& viewpoints) {
  constexpr int kEdge = 8;
  std::vector<glm::dvec3> hidden;
  std::vector<std::pair<double, int>> near(viewpoints.size());
  for (int z = 0; z < kEdge; ++z)
    for (int y = 0; y < kEdge; ++y)
      for (int x = 0; x < kEdge; ++x) {
        // Off the voxels' centres by no simple fraction: walls like to stand on round coordinates.
        const glm::dvec3 place =
            box.min + box.extent() * (glm::dvec3(x, y, z) + glm::dvec3(0.4731, 0.5171, 0.4873)) / double{kEdge};
        for (std::size_t v = 0; v < viewpoints.size(); ++v)
          near[v] = {glm::distance(place, viewpoints[v]), static_cast<int>(v)};
        const auto count = std::min<std::ptrdiff_t>(kPacketSize, static_cast<std::ptrdiff_t>(near.size()));
        std::partial_sort(near.begin(), near.begin() + count, near.end());
        RayPacket rays;
        rays.active = static_cast<std::uint32_t>((1ull << count) - 1);
        for (int lane = 0; lane < kPacketSize; ++lane)
          set_segment(rays, lane, place, viewpoints[near[std::min<std::ptrdiff_t>(lane, count - 1)].second]);
        if ((rays.active & ~scene.occluded(rays)) == 0) hidden.push_back(place);
      }
  // What is smaller than this many voxels is a nook, and stays with the rest.
  constexpr std::size_t kLeastPlaces = 4;
  std::vector<glm::dvec3> found;
  while (hidden.size() >= kLeastPlaces) {
    const glm::dvec3 first = hidden.front();
    std::vector<glm::dvec3> together{first}, others;
    for (std::size_t k = 1; k < hidden.size(); k += kPacketSize) {
      const std::size_t count = std::min<std::size_t>(kPacketSize, hidden.size() - k);
      RayPacket rays;
      rays.active = static_cast<std::uint32_t>((1ull << count) - 1);
      for (std::size_t lane = 0; lane < kPacketSize; ++lane)
        set_segment(rays, static_cast<int>(lane), first, hidden[k + std::min(lane, count - 1)]);
      const std::uint32_t blocked = scene.occluded(rays);
      for (std::size_t lane = 0; lane < count; ++lane)
        (blocked >> lane & 1 ? others : together).push_back(hidden[k + lane]);
    }
    hidden = std::move(others);
    if (together.size() < kLeastPlaces || !is_free(scene, first)) continue;
    const std::size_t taken = std::min(kEnclosureViewpoints, together.size());
    for (std::size_t k = 0; k < taken; ++k) found.push_back(together[k * together.size() / taken]);
  }
  return found;
}

}  // namespace

Enclosures find_enclosures(const Scene& scene, const Box& box, const std::vector<glm::dvec3>& viewpoints,
                           double finest_voxel_m) {
  Enclosures result{viewpoints, std::vector<int>(viewpoints.size(), -1), {}};
  std::vector<glm::dvec3> all = viewpoints;
  const std::vector<glm::dvec3> hidden = find_hidden_places(scene, box, viewpoints);
  all.insert(all.end(), hidden.begin(), hidden.end());
  std::vector<int> groups = join_by_sight(scene, all);
  const int count = *std::max_element(groups.begin(), groups.end()) + 1;
  if (count < 2) return result;
  // The largest first, and the rest left out.
  std::vector<int> by_size(static_cast<std::size_t>(count));
  std::iota(by_size.begin(), by_size.end(), 0);
  std::stable_sort(by_size.begin(), by_size.end(), [&](int a, int b) {
    return std::count(groups.begin(), groups.end(), a) > std::count(groups.begin(), groups.end(), b);
  });
  std::vector<int> place(static_cast<std::size_t>(count), -1);
  const int kept = std::min(count, kMaxEnclosures);
  for (int k = 0; k < kept; ++k) place[by_size[k]] = k;
  for (int& group : groups) group = place[group];

  int depth = 3;
  for (double edge = box.extent().x / 8; edge > finest_voxel_m && depth < EnclosureMask::kMaxDepth; edge /= 2) ++depth;
  Octree octree(scene, box, all, groups, kept);
  if (!octree.grow(depth)) return result;
  std::vector<int> mask_of(static_cast<std::size_t>(kept), -1);
  for (int g = 0; g < kept; ++g) {
    if (octree.group(g) != g || !octree.holds(g)) continue;
    mask_of[g] = static_cast<int>(result.masks.size());
    result.masks.push_back(octree.mask(g));
  }
  if (result.masks.size() < 2) result.masks.clear();
  const auto mask_at = [&](std::size_t v) {
    return groups[v] < 0 || result.masks.empty() ? -1 : mask_of[octree.group(groups[v])];
  };
  for (std::size_t v = 0; v < all.size(); ++v) {
    const bool is_given = v < viewpoints.size();
    if (!is_given && (mask_at(v) < 0 || octree.group(groups[v]) != groups[v])) continue;  // a nook after all
    if (!is_given) {
      result.viewpoints.push_back(all[v]);
      result.of_viewpoint.push_back(-1);
    }
    result.of_viewpoint[is_given ? v : result.of_viewpoint.size() - 1] = mask_at(v);
  }
  return result;
}

}  // namespace farfield
