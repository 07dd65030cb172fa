// SPDX-License-Identifier: Apache-2.0
// Makes cells ahead of time, as viewers would ask for them, so that the stores behind a service are filled.
//
// What is stored already is only found, so a bake that was stopped goes on where it was, and one that is repeated costs next to nothing.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <vector>

#include "server/app/bake_places.h"
#include "server/schedule/scheduled_cell_service.h"

namespace farfield {

struct BakeProgress {
  std::uint64_t places = 0, places_done = 0;
  std::uint64_t leaves = 0;         // found or made
  std::uint64_t blocked = 0;        // places nobody can stand at
  std::uint64_t failed = 0;         // leaves or tiles that could not be made
  std::uint64_t tiles = 0;          // found or made, each once
  std::uint64_t tiles_made = 0;     // of them by rays
  std::uint64_t bytes = 0;          // encoded, of all tiles
  double seconds = 0;
  /// What is still to be expected at the pace and density so far; nothing before the first hundredth of the places.
  std::optional<double> seconds_left;
  std::optional<std::uint64_t> bytes_expected;  // of all tiles, when everything is done
  std::string first_error;
};

/// Where to bake: `place(i)` for i < `count`. May be called from several threads.
struct BakeWork {
  std::uint64_t count = 0;
  std::function<glm::dvec3(std::uint64_t)> place;  // scene frame
  /// False: every place is somewhere a viewer was or will be. True: most are air or wall, and walls are left out.
  bool is_survey = false;
};

/// Asks for leaves, and for every tile of each, with several places under way at once. Returns when all is done, or soon after `is_stopped`.
/// `report` is called about every second from the calling thread.
BakeProgress bake(MeasuredCellService& service, const BakeWork& work, int threads, const std::atomic<bool>& is_stopped,
                  const std::function<void(const BakeProgress&)>& report);

}  // namespace farfield
