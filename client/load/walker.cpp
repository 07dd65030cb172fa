// SPDX-License-Identifier: Apache-2.0
#include "client/load/walker.h"

#include <utility>

namespace farfield::client {

void WalkerFigures::add(const WalkerFigures& other) {
  connect.add(other.connect), first_picture.add(other.first_picture), first_cell.add(other.first_cell);
  cell_ready.add(other.cell_ready), away.add(other.away);
  never_connected += other.never_connected, never_ready += other.never_ready;
  for (const auto& [kind, count] : other.errors) errors[kind] += count;
  const ClientStatistics& s = other.statistics;
  statistics.bytes_in += s.bytes_in, statistics.bytes_out += s.bytes_out;
  statistics.tiles += s.tiles, statistics.chunks += s.chunks, statistics.texture_levels += s.texture_levels;
  statistics.leaf_sets += s.leaf_sets, statistics.poses += s.poses, statistics.switches += s.switches;
  statistics.redundant_payloads += s.redundant_payloads, statistics.bad_payloads += s.bad_payloads;
  statistics.reconnects += s.reconnects;
  statistics.frames += s.frames, statistics.late_frames += s.late_frames, statistics.fallback_frames += s.fallback_frames;
  statistics.decode_seconds += s.decode_seconds;
  seconds += other.seconds;
}

Walker::Walker(ClientOptions options, const WalkPlan& plan, std::size_t index, double due_s)
    : plan_(plan), index_(index), due_s_(due_s), core_(std::make_unique<ClientCore>(std::move(options))) {}

void Walker::start() { core_->start(); }

void Walker::follow_state(double now_s) {
  const ClientStatus status = core_->status();
  const ClientState before = std::exchange(state_, status.state);
  if (before == state_) return;
  if (state_ == ClientState::kStreaming) {
    if (!path_) {
      figures_.connect.add(now_s - due_s_);
      welcome_s_ = now_s;
      scene_ = core_->scene();
      const Box world{scene_->bounds.min + scene_->origin, scene_->bounds.max + scene_->origin};
      path_.emplace(plan_.path_of(index_, world, scene_->start + scene_->origin));
    }
    if (const auto lost_s = std::exchange(lost_s_, std::nullopt)) figures_.away.add(now_s - *lost_s);
    return;
  }
  if (state_ == ClientState::kStopped) return;
  if (!status.error.message.empty()) ++figures_.errors[error_code_name(status.error.code)];
  if (!lost_s_ && path_) lost_s_ = now_s;
}

void Walker::move(double due_s, double now_s) {
  follow_state(now_s);
  if (!path_) return;
  eye_ = scene_->scene_from_world(path_->at(due_s - welcome_s_));
  core_->set_pose(eye_, due_s);
}

void Walker::look(double due_s, double now_s) {
  if (!path_) return;
  const std::shared_ptr<const LeafView> view = core_->view();
  if (!view) return;
  if (!std::exchange(has_picture_, true)) figures_.first_picture.add(now_s - due_s_);
  const bool is_late = core_->count_frame(view.get(), eye_.position);
  if (!has_cell_) {
    if (is_late) return;
    has_cell_ = true, leaf_ = view->leaf;
    figures_.first_cell.add(now_s - due_s_);
    return;
  }
  if (is_late) {
    if (!late_since_s_) late_since_s_ = due_s;
    return;
  }
  const bool is_other = std::exchange(leaf_, view->leaf) != view->leaf;
  if (late_since_s_) {
    figures_.cell_ready.add(now_s - *late_since_s_);
    late_since_s_.reset();
  } else if (is_other) {
    figures_.cell_ready.add(0);
  }
}

WalkerFigures Walker::finish(double now_s) {
  if (!path_) {
    ++figures_.never_connected;
  } else {
    figures_.seconds = now_s - welcome_s_;
  }
  // What was waited for until the end was not ready by then, and must not be better for it.
  if (path_ && !has_picture_) figures_.first_picture.add(now_s - due_s_);
  if (path_ && !has_cell_) figures_.first_cell.add(now_s - due_s_), ++figures_.never_ready;
  if (late_since_s_) figures_.cell_ready.add(now_s - *late_since_s_), ++figures_.never_ready;
  if (lost_s_) figures_.away.add(now_s - *lost_s_);
  figures_.statistics = core_->statistics();
  return std::move(figures_);
}

}  // namespace farfield::client
