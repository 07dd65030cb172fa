// SPDX-License-Identifier: Apache-2.0
// Which poses are worth sending: at most so many a second, and none that would change nothing.
//
// The server uses poses to find the leaf that holds the eye and to predict where it goes. A move that shifts the
// nearest thing an impostor can show (kappa·side away) by less than a tenth of a pixel, or a turn by less than a
// pixel, changes neither; crossing a border of a finest cell always may. When a movement ends one more pose is sent,
// so that the server does not go on predicting it; after that standing still is silent.
#pragma once

#include <optional>

#include "common/cells/cell_id.h"
#include "common/math/camera.h"

namespace farfield::client {

class PoseGate {
 public:
  struct Decision {
    bool should_send = false;
    std::optional<double> ask_again_in_s;  // nothing to send now, but then
  };

  /// `kappa`: margin of the near region in sides. Requires: poses_per_second > 0.
  PoseGate(const CellGrid& grid, double kappa, const Display& display, double poses_per_second);

  /// What the screen lacks at a pose. A usable view that has gone is news to the server, and a leaf set that has
  /// come, or been left through the border of an enclosure, which may take but a small step.
  struct Lacks {
    bool usable_view = false;
    bool leaf_set = false;  // the complete one of the eye's leaf
  };
  /// `pose` in the scene frame. `now_s`: any steady clock.
  Decision decide(const Pose& pose, Lacks lacks, double now_s) const;
  void note_sent(const Pose& pose, Lacks lacks, double now_s);
  /// The next pose is sent whatever it is: the server knows none.
  void reset() { last_.reset(); }

 private:
  struct Sent {
    Pose pose;
    Lacks lacks;
    double time_s = 0;
    bool is_rest = false;  // sent because the movement ended
  };
  bool differs(const Pose& pose, Lacks lacks) const;

  CellGrid grid_;
  double smallest_move_m_;
  double smallest_turn_rad_;
  double interval_s_;
  std::optional<Sent> last_;
};

}  // namespace farfield::client
