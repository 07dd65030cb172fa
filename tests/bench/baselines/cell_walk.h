// SPDX-License-Identifier: Apache-2.0
// The cells a trace leads through, as Farfield divides the scene: the leaf that holds each viewpoint, and the near geometry in
// and around it. Baselines use the same cells, so that methods differ in what they do with the far field alone.
#pragma once

#include <map>
#include <set>

#include "client/store/leaf_view.h"
#include "server/encode/tile_maker.h"
#include "tests/bench/world.h"

namespace farfield::bench {

/// A leaf where the trace first enters it.
struct EnteredCell {
  CellId leaf;
  glm::dvec3 eye{0};         // scene frame
  std::size_t near_bytes = 0;     // of chunks first needed while in it, as encoded …
  std::size_t texture_bytes = 0;  // … and of textures, all levels
};

/// Belongs to one thread.
class CellWalk {
 public:
  explicit CellWalk(const World& world);

  /// Distinct leaves in the order of the trace. Errors: the planner's.
  Result<std::vector<EnteredCell>> entered();
  Result<CellId> leaf_at(const glm::dvec3& eye) { return sources_.leaves->leaf_at(eye, nullptr); }
  /// The near geometry for a viewpoint, decoded, without impostors. Kept until another is asked for.
  Result<std::shared_ptr<const client::LeafView>> near_view(const glm::dvec3& eye);

  const NestedShells& shells() const { return shells_; }
  const ImpostorSettings& settings() const { return settings_; }

 private:
  Result<SharedPlan> plan_for(const glm::dvec3& eye);
  void count_near(const LeafPlan& plan, EnteredCell& cell);
  client::PlacedChunk placed_chunk(std::uint32_t chunk, const glm::dvec3& centre);

  const World& world_;
  ImpostorSettings settings_;
  NestedShells shells_;
  ImpostorSources sources_;
  std::map<CellId, SharedPlan> plans_;
  std::map<ContentHash, std::size_t> texture_index_;
  std::map<ContentHash, std::shared_ptr<const client::DecodedTexture>> textures_;
  std::map<std::uint32_t, std::shared_ptr<const client::DecodedChunk>> chunks_;
  std::set<ContentHash> sent_;  // chunks and textures a client has already
  SharedPlan shown_plan_;
  std::shared_ptr<const client::LeafView> shown_;
};

}  // namespace farfield::bench
