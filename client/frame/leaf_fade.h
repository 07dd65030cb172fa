// SPDX-License-Identifier: Apache-2.0
// How one leaf set gives way to the next on the screen: not from a frame to the next but within a fraction of a second,
// as levels of detail are blended. At a cell's border whole walls change from geometry to impostor; all at once, that is seen.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "client/store/leaf_view.h"

namespace farfield::client {

/// Belongs to the thread that draws. While it fades it keeps the former leaf set alive, whatever the client's store has
/// given up: up to one leaf set beyond the bound on memory, for as long as a fade lasts.
class LeafFade {
 public:
  /// Up to this far outside its leaf, in its sides, a leaf set is still mixed in, less and less on the way. Its geometry is
  /// exact for two sides around the leaf and its shells are made for eyes within, so that errors of its parallax stay within
  /// half as much again.
  static constexpr double kReachSides = 1.0;

  /// `seconds`: how long a fade takes at most, >= 0.
  explicit LeafFade(double seconds) : seconds_(seconds) {}

  struct Mix {
    std::shared_ptr<const LeafView> shown;   // never null
    std::shared_ptr<const LeafView> former;  // null: `shown` alone is drawn
    double share = 1;                        // of `shown`, 0 … 1
  };

  /// `newest`, not null, is what `eye` (scene frame) has to be shown at `time_s` of any clock; without a time it is shown at
  /// once, and so are sets that are not complete and fallback views: who sees these waits for what comes after. A set that
  /// arrives during a fade has its turn when that has ended, as where an eye cuts the corner of a cell.
  Mix next(const std::shared_ptr<const LeafView>& newest, const glm::dvec3& eye, std::optional<double> time_s);

  /// What next() may give as `former`, none of them null: what has to stay drawable. Empty where nothing fades.
  std::vector<std::shared_ptr<const LeafView>> in_use(std::optional<double> time_s) const;

 private:
  bool may_fade(const LeafView& newest, std::optional<double> time_s) const;

  double seconds_;
  std::shared_ptr<const LeafView> shown_, former_;
  double start_s_ = 0;   // of the fade
  std::optional<double> last_s_;  // of the last frame
};

}  // namespace farfield::client
