// SPDX-License-Identifier: Apache-2.0
// What the network thread and everyone else share: results go up, the newest pose comes down.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>

#include "client/session/client_status.h"
#include "client/store/leaf_view.h"

namespace farfield::client {

struct CoreBoard {
  struct TimedPose {
    Pose pose;  // scene frame
    double time_s = 0;
  };

  mutable std::mutex mutex;  // guards everything here; held for copies only
  std::condition_variable changed;
  std::shared_ptr<const LeafView> view;
  bool is_settled = false;  // nothing more is on its way for `view`
  ClientStatus status;
  std::optional<SceneDescription> scene;
  ClientStatistics statistics;
  std::optional<TimedPose> pose;
  bool is_pose_announced = false;  // the network thread has been told and has not looked yet
};

}  // namespace farfield::client
