// SPDX-License-Identifier: Apache-2.0
#include "client/session/client_core.h"

#include <cmath>
#include <utility>

#include "client/session/stream_session.h"
#include "client/session/wire_convert.h"

namespace farfield::client {
namespace {

bool is_finite(const Pose& pose) {
  const glm::dvec3& p = pose.position;
  const glm::dquat& q = pose.world_from_camera;
  return std::isfinite(p.x + p.y + p.z) && std::isfinite(q.x + q.y + q.z + q.w);
}

bool is_over(ClientState state) { return state == ClientState::kFailed || state == ClientState::kStopped; }

Error timeout_error(const ClientStatus& status, const char* what, std::chrono::milliseconds timeout) {
  if (is_over(status.state) && !status.error.message.empty()) return status.error;
  const std::string& last = status.error.message;
  return {ErrorCode::kUnavailable,
          fmt::format("{} within {} ms ({}{}{})", what, timeout.count(), client_state_name(status.state),
                      last.empty() ? "" : ": ", last)};
}

}  // namespace

const char* client_state_name(ClientState state) {
  switch (state) {
    case ClientState::kConnecting: return "connecting";
    case ClientState::kStreaming: return "streaming";
    case ClientState::kReconnecting: return "reconnecting";
    case ClientState::kFailed: return "failed";
    case ClientState::kStopped: return "stopped";
  }
  return "unknown";
}

ClientCore::ClientCore(ClientOptions options) : session_(std::make_unique<StreamSession>(std::move(options))) {}
ClientCore::~ClientCore() = default;

void ClientCore::start() { session_->start(); }
void ClientCore::stop() { session_->stop(); }

void ClientCore::set_pose(const Pose& pose, double time_s) {
  if (!is_finite(pose) || !std::isfinite(time_s)) return;
  CoreBoard& board = session_->board();
  {
    const std::lock_guard lock(board.mutex);
    board.pose = CoreBoard::TimedPose{pose, time_s};
    if (std::exchange(board.is_pose_announced, true)) return;
  }
  session_->notice_pose();
}

std::shared_ptr<const LeafView> ClientCore::view() const {
  const std::lock_guard lock(session_->board().mutex);
  return session_->board().view;
}

bool ClientCore::count_frame(const LeafView* view, const glm::dvec3& eye) {
  CoreBoard& board = session_->board();
  const std::lock_guard lock(board.mutex);
  const bool late = is_late(view, board.scene ? position_on_wire(board.scene->frame.grid, eye) : eye);
  ++board.statistics.frames;
  if (late) ++board.statistics.late_frames;
  if (view && view->is_fallback) ++board.statistics.fallback_frames;
  return late;
}

ClientStatus ClientCore::status() const {
  const std::lock_guard lock(session_->board().mutex);
  return session_->board().status;
}

std::optional<SceneDescription> ClientCore::scene() const {
  const std::lock_guard lock(session_->board().mutex);
  return session_->board().scene;
}

ClientStatistics ClientCore::statistics() const {
  const std::lock_guard lock(session_->board().mutex);
  return session_->board().statistics;
}

Result<SceneDescription> ClientCore::wait_welcome(std::chrono::milliseconds timeout) {
  CoreBoard& board = session_->board();
  std::unique_lock lock(board.mutex);
  board.changed.wait_for(lock, timeout, [&] { return board.scene || is_over(board.status.state); });
  if (board.scene) return *board.scene;
  return tl::unexpected(timeout_error(board.status, "no welcome from the server", timeout));
}

Result<std::shared_ptr<const LeafView>> ClientCore::wait_complete(const glm::dvec3& eye,
                                                                  std::chrono::milliseconds timeout) {
  CoreBoard& board = session_->board();
  std::unique_lock lock(board.mutex);
  const auto is_there = [&] {
    return board.scene && board.is_settled && !is_late(board.view.get(), position_on_wire(board.scene->frame.grid, eye));
  };
  board.changed.wait_for(lock, timeout, [&] { return is_there() || is_over(board.status.state); });
  if (is_there()) return board.view;
  return tl::unexpected(timeout_error(board.status, "no complete leaf set", timeout));
}

}  // namespace farfield::client
