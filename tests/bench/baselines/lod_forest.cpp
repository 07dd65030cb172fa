// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/lod_forest.h"

#include <meshoptimizer.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace farfield::bench {
namespace {

using client::SurfaceVertex;

constexpr std::size_t kGroup = 4;            // nodes merged into one of the next level
constexpr float kWantedShare = 0.5f;         // of the group's triangles: less would cost a large error at once
constexpr float kLargestUsefulShare = 0.8f;  // a group that keeps more is not worth its memory

struct Simplified {
  std::vector<std::uint32_t> indices;
  float error_m = 0;
};

/// Which positions several groups of a level use. Vertices with equal positions and different attributes count as one.
class SharedPositions {
 public:
  SharedPositions(const std::vector<SurfaceVertex>& vertices, const IsFixed& is_fixed)
      : position_of_(vertices.size()), owner_(vertices.size(), kNobody) {
    const auto key = [&](std::uint32_t v) { return std::tie(vertices[v].position.x, vertices[v].position.y, vertices[v].position.z); };
    std::vector<std::uint32_t> order(vertices.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    for (std::size_t k = 0; k < order.size(); ++k)
      position_of_[order[k]] = k > 0 && key(order[k]) == key(order[k - 1]) ? position_of_[order[k - 1]] : order[k];
    for (std::size_t v = 0; v < vertices.size(); ++v)
      if (is_fixed(vertices[v].position)) owner_[position_of_[v]] = kFixed;
  }
  void begin_level() {
    for (std::uint32_t& owner : owner_)
      if (owner != kFixed) owner = kNobody;
  }
  void use(std::uint32_t vertex, std::uint32_t group) {
    std::uint32_t& owner = owner_[position_of_[vertex]];
    if (owner == kNobody)
      owner = group;
    else if (owner != group && owner != kFixed)
      owner = kSeveral;
  }
  void fix(std::uint32_t vertex) { owner_[position_of_[vertex]] = kFixed; }
  bool is_locked(std::uint32_t vertex) const { return owner_[position_of_[vertex]] >= kSeveral; }

 private:
  static constexpr std::uint32_t kFixed = ~0u, kSeveral = ~0u - 1, kNobody = ~0u - 2;
  std::vector<std::uint32_t> position_of_;  // per vertex
  std::vector<std::uint32_t> owner_;        // per position: a group, or one of the above
};

// Of a triangle list over shared vertices.
Simplified simplify(const std::vector<SurfaceVertex>& vertices, std::span<const std::uint32_t> indices, const SharedPositions& shared) {
  std::vector<std::uint32_t> used(indices.begin(), indices.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const std::size_t own = used.size();
  for (std::size_t i = 0; i < own; ++i) {
    // meshoptimizer 0.18 has no list of vertices to keep, but it keeps positions that three or more vertices of the
    // buffer have, since it knows no rule for them. Two more that no triangle uses make three.
    if (shared.is_locked(used[i])) used.insert(used.end(), 2, used[i]);
  }
  std::vector<SurfaceVertex> local(used.size());
  for (std::size_t i = 0; i < used.size(); ++i) local[i] = vertices[used[i]];
  std::vector<std::uint32_t> local_indices(indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i)
    local_indices[i] = static_cast<std::uint32_t>(
        std::lower_bound(used.begin(), used.begin() + static_cast<std::ptrdiff_t>(own), indices[i]) - used.begin());
  Simplified result;
  result.indices.resize(indices.size());
  const auto target = static_cast<std::size_t>(kWantedShare * static_cast<float>(indices.size() / 3)) * 3;
  float relative_error = 0;
  const std::size_t count = meshopt_simplify(result.indices.data(), local_indices.data(), local_indices.size(), &local[0].position.x,
                                             local.size(), sizeof(SurfaceVertex), target, 1.0f, 0, &relative_error);
  result.indices.resize(count);
  for (std::uint32_t& index : result.indices) index = used[index];
  result.error_m = relative_error * meshopt_simplifyScale(&local[0].position.x, local.size(), sizeof(SurfaceVertex));
  return result;
}

void weld(std::span<const SurfaceVertex> vertices, std::span<const std::uint32_t> indices, LodForest& forest) {
  std::vector<std::uint32_t> remap(vertices.size());
  const std::size_t unique =
      meshopt_generateVertexRemap(remap.data(), indices.data(), indices.size(), vertices.data(), vertices.size(), sizeof(SurfaceVertex));
  forest.vertices.resize(unique);
  meshopt_remapVertexBuffer(forest.vertices.data(), vertices.data(), vertices.size(), sizeof(SurfaceVertex), remap.data());
  forest.indices.resize(indices.size());
  meshopt_remapIndexBuffer(forest.indices.data(), indices.data(), indices.size(), remap.data());
}

LodNode chunk_node(const LodForest& forest, std::uint32_t first, std::uint32_t end) {
  LodNode node{.min = glm::vec3(std::numeric_limits<float>::max()), .max = glm::vec3(std::numeric_limits<float>::lowest())};
  node.first_index = first, node.index_count = end - first;
  for (std::uint32_t i = first; i < end; ++i) {
    const glm::vec3& p = forest.vertices[forest.indices[i]].position;
    node.min = glm::min(node.min, p), node.max = glm::max(node.max, p);
  }
  return node;
}

/// A node over `count` nodes from `first`, its triangles apart from the forest's.
struct Group {
  LodNode node;
  std::vector<std::uint32_t> indices;
  bool is_useful = false;
};

Group make_group(const LodForest& forest, std::uint32_t first, std::uint32_t count, const SharedPositions& shared) {
  Group group;
  group.node = {.min = forest.nodes[first].min, .max = forest.nodes[first].max, .first_child = first, .child_count = count};
  std::vector<std::uint32_t> all;
  float children_error = 0;
  for (std::uint32_t n = first; n < first + count; ++n) {
    const LodNode& child = forest.nodes[n];
    group.node.min = glm::min(group.node.min, child.min), group.node.max = glm::max(group.node.max, child.max);
    children_error = std::max(children_error, child.error_m);
    all.insert(all.end(), forest.indices.begin() + child.first_index, forest.indices.begin() + child.first_index + child.index_count);
  }
  if (all.empty()) return group;
  Simplified simplified = simplify(forest.vertices, all, shared);
  group.is_useful = static_cast<float>(simplified.indices.size()) < kLargestUsefulShare * static_cast<float>(all.size());
  group.node.error_m = children_error + simplified.error_m;
  group.indices = std::move(simplified.indices);
  return group;
}

float distance(const glm::vec3& point, const LodNode& node) {
  return glm::distance(point, glm::clamp(point, node.min, node.max));
}

void select(const LodForest& forest, std::uint32_t index, const glm::vec3& eye, float error_per_metre,
            const std::function<bool(const LodNode&)>& may_see, const std::function<void(const LodNode&)>& emit) {
  const LodNode& node = forest.nodes[index];
  if (!may_see(node)) return;
  if (node.child_count == 0 || node.error_m <= error_per_metre * distance(eye, node)) return emit(node);
  for (std::uint32_t c = 0; c < node.child_count; ++c) select(forest, node.first_child + c, eye, error_per_metre, may_see, emit);
}

}  // namespace

LodForest build_lod_forest(std::span<const SurfaceVertex> vertices, std::span<const std::uint32_t> indices,
                           std::span<const std::uint32_t> chunk_ends, const IsFixed& is_fixed) {
  LodForest forest;
  weld(vertices, indices, forest);
  std::uint32_t begin = 0;
  for (const std::uint32_t end : chunk_ends) forest.nodes.push_back(chunk_node(forest, std::exchange(begin, end), end));
  // Groups of one level: first node and count. One node alone is a group too, as long as it gets smaller.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> groups;
  const auto group_level = [&](std::size_t first) {
    groups.clear();
    for (; first < forest.nodes.size(); first += kGroup)
      groups.emplace_back(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(std::min(kGroup, forest.nodes.size() - first)));
  };
  group_level(0);
  SharedPositions shared(forest.vertices, is_fixed);
  const auto for_each_vertex = [&](const std::pair<std::uint32_t, std::uint32_t>& group, const auto& visit) {
    for (std::uint32_t n = group.first; n < group.first + group.second; ++n)
      for (std::uint32_t i = 0; i < forest.nodes[n].index_count; ++i) visit(forest.indices[forest.nodes[n].first_index + i]);
  };
  while (!groups.empty()) {
    shared.begin_level();
    for (std::size_t g = 0; g < groups.size(); ++g)
      for_each_vertex(groups[g], [&](std::uint32_t vertex) { shared.use(vertex, static_cast<std::uint32_t>(g)); });
    std::vector<Group> made(groups.size());
    tbb::parallel_for(std::size_t{0}, groups.size(),
                      [&](std::size_t g) { made[g] = make_group(forest, groups[g].first, groups[g].second, shared); });
    const std::size_t level_begin = forest.nodes.size();
    for (Group& group : made) {
      if (!group.is_useful) {
        // What stays as it is has neighbours at all later levels.
        for_each_vertex({group.node.first_child, group.node.child_count}, [&](std::uint32_t vertex) { shared.fix(vertex); });
        for (std::uint32_t c = 0; c < group.node.child_count; ++c) forest.roots.push_back(group.node.first_child + c);
        continue;
      }
      group.node.first_index = static_cast<std::uint32_t>(forest.indices.size()),
      group.node.index_count = static_cast<std::uint32_t>(group.indices.size());
      forest.indices.insert(forest.indices.end(), group.indices.begin(), group.indices.end());
      forest.nodes.push_back(group.node);
    }
    group_level(level_begin);
  }
  return forest;
}

void select_lods(const LodForest& forest, const glm::vec3& eye, float error_per_metre, const std::function<bool(const LodNode&)>& may_see,
                 const std::function<void(const LodNode&)>& emit) {
  for (const std::uint32_t root : forest.roots) select(forest, root, eye, error_per_metre, may_see, emit);
}

}  // namespace farfield::bench
