// SPDX-License-Identifier: Apache-2.0
// Makes camera traces through a scene that touch nothing: for benchmarks, demonstrations and load tests.
//
// The path is a chain of arcs found by depth-first search with backtracking, every arc checked by rays around the
// body before it is taken; so the speed never changes and no frame stands in a wall. Deterministic by seed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/trace/trace.h"
#include "server/scene/scene.h"

namespace farfield {

enum class TraceKind { kWalk, kFly, kOrbit };

std::optional<TraceKind> trace_kind_of(std::string_view name);  // "walk", "fly", "orbit"
const char* trace_kind_name(TraceKind kind);

struct TraceOptions {
  TraceKind kind = TraceKind::kWalk;
  double speed_m_s = 0;  // 0: walk 1.4 m/s, fly 4 m/s (both times the body's scale), orbit one turn
  double seconds = 20;
  std::uint64_t seed = 1;
  double frames_per_second = 60;
};

/// World coordinates. Constant speed but for half a second of easing at either end. Walks keep 0.3 m from everything
/// and 1.7 m above the floor (steps smoothed); flights keep 0.5 m. A walk in a scene without a floor becomes a
/// flight; `note`, if given, says so. Scenes smaller than 10 m shrink all lengths in proportion.
/// Errors: kInvalidArgument (options), kNotFound (no free path of that length: try another seed or kind).
Result<Trace> generate_trace(const Scene& scene, const TraceOptions& options, std::string* note = nullptr);

/// An eye position, scene frame, where a person can stand: floor below, head room, 0.3 m free all round, not inside a
/// closed solid, something to look at. Errors: kNotFound.
Result<glm::dvec3> standing_point(const Scene& scene, std::uint64_t seed);

}  // namespace farfield
