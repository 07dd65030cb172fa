// SPDX-License-Identifier: Apache-2.0
// What a session asks for: leaf plans, tiles, chunks and texture levels of one scene, by priority and cancellable.
// The boundary between sessions, which know viewers, and the schedule, which knows work.
//
// Threads: every function may be called from any thread. A callback runs at most once, on any thread, possibly before
// the call that asked returns (whatever is at hand is answered at once); it must return quickly and must not throw.
// After its ticket was released a callback may still be on its way once: receivers guard themselves.
// Frames: scene frame throughout. Lifetime: a service outlives every ticket it gave out.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <memory>
#include <string>
#include <utility>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/impostor/settings.h"
#include "common/math/box.h"
#include "server/cells/leaf_plan.h"
#include "server/encode/tile_source.h"
#include "server/schedule/transition_table.h"

namespace farfield {

/// What makes one piece of work more urgent than another: what somebody waits for before what is only expected, then
/// the sooner, then the larger share of the view.
struct WorkPriority {
  double seconds_until_needed = 0;  // 0: somebody waits for it now; below: and other work waits for it
  float view_share = 0;             // of the sphere of directions, 0 … 1
  bool prefetch = false;            // the viewer is elsewhere still

  bool is_before(const WorkPriority& other) const {
    if (prefetch != other.prefetch) return !prefetch;
    if (seconds_until_needed < other.seconds_until_needed) return true;
    if (other.seconds_until_needed < seconds_until_needed) return false;
    return view_share > other.view_share;
  }
};

/// Interest in one answer. Destroying or releasing it withdraws the interest: work that nobody else wants is cancelled.
class Ticket {
 public:
  Ticket() = default;
  /// `withdraw` runs once, on the thread that drops the ticket; empty: there is nothing to withdraw.
  explicit Ticket(std::function<void()> withdraw) : withdraw_(std::move(withdraw)) {}
  Ticket(Ticket&& other) noexcept : withdraw_(std::exchange(other.withdraw_, nullptr)) {}
  Ticket& operator=(Ticket&& other) noexcept {
    if (this != &other) {
      release();
      withdraw_ = std::exchange(other.withdraw_, nullptr);
    }
    return *this;
  }
  Ticket(const Ticket&) = delete;
  Ticket& operator=(const Ticket&) = delete;
  ~Ticket() { release(); }

  void release() {
    if (const auto withdraw = std::exchange(withdraw_, nullptr)) withdraw();
  }

 private:
  std::function<void()> withdraw_;
};

/// What a client is told about a scene, and what every key derives from.
struct SceneDescription {
  std::string name;                // in the catalogue
  ContentHash hash = 0;            // of the scene's content and the settings together
  glm::dvec3 world_origin{0};      // world position of the scene frame's zero
  Box bounds;                      // scene frame
  ImpostorSettings settings;
  glm::u8vec3 background{0};       // sRGB
  glm::dvec3 start{0};             // a viewpoint where a person can stand
  std::uint64_t triangles = 0;     // drawn: every instance counted
};

/// A chunk as a leaf set lists it.
struct PlacedSceneChunk {
  ContentHash hash = 0;            // of its content as the scene holds it (SceneChunk::hash), not of its encoded bytes
  int texture = -1;                // index for texture(), -1 for none
  Box bounds;
  glm::dmat4x3 scene_from_chunk{1};
};

struct SceneTexture {
  ContentHash hash = 0;
  int width = 0, height = 0;       // of level 0
  int level_count = 0;
};

template <class T>
using Answer = std::function<void(Result<T>)>;

/// One scene's work. See the head of this file for threads and lifetime.
class CellService {
 public:
  virtual ~CellService() = default;

  virtual const SceneDescription& scene() const = 0;
  /// Requires: chunk < the scene's chunks (as listed by a LeafPlan). Cheap after the first call for a chunk.
  virtual PlacedSceneChunk chunk_placement(std::uint32_t chunk) const = 0;
  /// Requires: texture came from chunk_placement().
  virtual SceneTexture texture(std::uint32_t texture) const = 0;

  /// The plan of the leaf that holds `viewpoint`. Errors: kCancelled, kUnavailable (overload); with a prefetch priority
  /// kNotFound, where nobody can stand in that leaf: who comes there after all asks again.
  [[nodiscard]] virtual Ticket leaf(const glm::dvec3& viewpoint, const WorkPriority& priority,
                                    Answer<std::shared_ptr<const LeafPlan>> answer) = 0;
  /// The fallback view around `viewpoint`: LeafPlan::is_fallback. Errors: kCancelled, kUnavailable (overload).
  [[nodiscard]] virtual Ticket fallback(const glm::dvec3& viewpoint, const WorkPriority& priority,
                                        Answer<std::shared_ptr<const LeafPlan>> answer) = 0;
  /// Single-flight over all sessions. Errors: kCancelled, kUnavailable.
  [[nodiscard]] virtual Ticket tile(const TileId& id, const WorkPriority& priority,
                                    Answer<std::shared_ptr<const EncodedTile>> answer) = 0;
  [[nodiscard]] virtual Ticket chunk(std::uint32_t chunk, const WorkPriority& priority, Answer<SharedBytes> answer) = 0;
  [[nodiscard]] virtual Ticket texture_level(std::uint32_t texture, int level, const WorkPriority& priority,
                                             Answer<SharedBytes> answer) = 0;

  /// What viewers' ways teach: see transition_table.h. Microseconds, but for some milliseconds
  /// now and then when all of it is handed to the store. A service that learns nothing knows nothing.
  virtual void note_transition(const std::optional<CellId>& previous, const CellId& current, const CellId& next, const glm::dvec3& entry) {
    static_cast<void>(previous), static_cast<void>(current), static_cast<void>(next), static_cast<void>(entry);
  }
  virtual Departures departures(const std::optional<CellId>& previous, const CellId& current) const {
    static_cast<void>(previous), static_cast<void>(current);
    return {};
  }
};

}  // namespace farfield
