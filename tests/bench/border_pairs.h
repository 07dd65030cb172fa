// SPDX-License-Identifier: Apache-2.0
// Does a frame's error change more where the viewer crosses from one leaf cell into the next than it does inside a cell?
// Pairs of poses 1/60 s apart are taken from the trace, some on two sides of a border and some inside one cell. Each
// pose is drawn, its mean FLIP against truth measured, and the figure is the difference within the pair. A method may spread
// what changes over the frames after the border: a pair from the middle of the next quarter second tells of that.
#pragma once

#include <array>
#include <functional>

#include "common/cells/cell_id.h"
#include "common/trace/trace.h"
#include "tests/bench/method_result.h"
#include "tests/bench/scratch_folder.h"
#include "tests/bench/viewer_cells.h"

namespace farfield::bench {

struct BorderPair {
  enum class Place { kInside, kCrossing, kAfterCrossing };  // the last belongs to the crossing before it
  std::size_t step = 0;  // the pair is this step and the next
  Place place = Place::kInside;
};

/// Steps from a crossing to the pair after it: the 8th of 15, where a fade of a quarter second is steepest.
inline constexpr std::size_t kStepsAfterCrossing = 7;

/// Up to `count` pairs that cross a border, each with the one after it where the walk is long enough, and as many that do
/// not, each evenly picked from all there are, in the order of the walk. `leaf_of_step`: the leaf at every step of the walk.
std::vector<BorderPair> pick_border_pairs(std::span<const CellId> leaf_of_step, std::size_t count);

/// The picked poses with truth for them, which lies on disk: it would count as memory of whatever is measured.
class BorderPairs {
 public:
  /// `count` crossings and as many others; `scene_origin` carries the trace's poses into the scene frame. Renders
  /// truth. Errors: kIo.
  static Result<BorderPairs> create(const Scene& scene, const ViewerCells& cells, const Trace& trace, std::size_t count,
                                    const Display& display, int truth_samples);

  /// Scene frame, two per pair.
  const std::vector<Pose>& poses() const { return poses_; }
  /// The same in the world frame, for a client to walk: in the time of the walk from a crossing to the pair after it, about a
  /// second from one place to the next, which is longer than a client fades from one leaf set to the next.
  Trace trace() const;

  /// `rgb_of(i)`: what a method shows of poses()[i]. Errors: those of `rgb_of`, kIo.
  Result<BorderFlip> judge(const Display& display, const std::function<Result<std::vector<std::uint8_t>>(std::size_t)>& rgb_of) const;

 private:
  explicit BorderPairs(ScratchFolder folder) : folder_(std::move(folder)) {}

  ScratchFolder folder_;
  glm::dvec3 scene_origin_{0};
  std::vector<BorderPair> pairs_;
  std::vector<Pose> poses_;
};

}  // namespace farfield::bench
