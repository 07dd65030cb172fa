// SPDX-License-Identifier: Apache-2.0
// The client without a screen: talks to the server, decodes, and always has a leaf set to draw. Every front end (the
// window, the headless program, the load tester, the benchmark) is a loop around one of these:
//
//   ClientCore core(options);
//   core.start();
//   for each frame: core.set_pose(pose, seconds); draw(core.view()); core.count_frame(view, eye);
//
// Threads: one network thread and options.decode_threads for decoding, all its own. Every function may be called from
// any thread; none but wait_… blocks longer than it takes to copy a pointer.
// Frames: poses and eyes are in the scene frame; SceneDescription carries world poses over.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "client/session/client_options.h"
#include "client/session/client_status.h"
#include "client/store/leaf_view.h"

namespace farfield::client {

class StreamSession;

class ClientCore {
 public:
  explicit ClientCore(ClientOptions options);
  /// Says goodbye and joins its threads: some milliseconds, at most about a second.
  ~ClientCore();
  ClientCore(const ClientCore&) = delete;
  ClientCore& operator=(const ClientCore&) = delete;

  /// Begins to connect; once. The outcome is in status().
  void start();
  void stop();

  /// The viewer is at `pose` (scene frame) at `time_s` of any steady clock. Call it every frame: poses that change
  /// nothing are not sent, and the leaf set on the screen follows at once where it is here already. Poses before the
  /// Welcome are kept. Non-finite poses are ignored.
  void set_pose(const Pose& pose, double time_s);

  /// What to draw now; null until something has arrived, never null again after.
  std::shared_ptr<const LeafView> view() const;
  /// Counts a frame that showed `view` to an eye there. Returns: whether it was late (design.md section 9).
  bool count_frame(const LeafView* view, const glm::dvec3& eye);

  ClientStatus status() const;
  /// Of the newest Welcome; empty before the first.
  std::optional<SceneDescription> scene() const;
  ClientStatistics statistics() const;

  /// Blocks until the first Welcome. Errors: the final failure; kUnavailable after `timeout`, with the newest error.
  Result<SceneDescription> wait_welcome(std::chrono::milliseconds timeout);
  /// Blocks until the view is the complete leaf set of the leaf that holds `eye`, as last given to set_pose, with
  /// everything the server sends for it decoded: the lockstep of the benchmark. Errors: as wait_welcome().
  Result<std::shared_ptr<const LeafView>> wait_complete(const glm::dvec3& eye, std::chrono::milliseconds timeout);

 private:
  std::unique_ptr<StreamSession> session_;
};

}  // namespace farfield::client
