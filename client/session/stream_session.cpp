// SPDX-License-Identifier: Apache-2.0
// Start, stop, poses, and what becomes visible outside. What the server sends: stream_receive.cpp.
#include "client/session/stream_session.h"

#include <algorithm>
#include <asio/post.hpp>
#include <exception>
#include <utility>

#include "client/session/wire_convert.h"
#include "client/store/free_memory.h"
#include "common/net/message.h"
#include "proto/farfield.pb.h"

namespace farfield::client {
namespace {

double to_seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

double seconds_now() { return to_seconds(std::chrono::steady_clock::now().time_since_epoch()); }

}  // namespace

StreamSession::StreamSession(ClientOptions options)
    : options_(std::move(options)),
      work_(asio::make_work_guard(context_)),
      pose_timer_(context_),
      refresh_timer_(context_),
      link_(std::make_shared<ServerLink>(context_, options_, link_events())) {}

StreamSession::~StreamSession() { stop(); }

void StreamSession::start() {
  if (thread_.joinable()) return;
  started_ = Clock::now();
  link_->start();
  thread_ = std::thread([this] { run(); });
}

void StreamSession::stop() {
  if (!thread_.joinable()) return;
  asio::post(context_, [this] { link_->stop(); });
  {
    // The server closes when it has read the goodbye; one that does not is not waited for.
    constexpr std::chrono::milliseconds kGoodbye{800};
    std::unique_lock lock(board_.mutex);
    board_.changed.wait_for(lock, kGoodbye, [this] {
      return board_.status.state == ClientState::kStopped || board_.status.state == ClientState::kFailed ||
             board_.status.state == ClientState::kConnecting;
    });
  }
  context_.stop();
  thread_.join();
  pool_ = nullptr;
}

void StreamSession::run() {
  try {
    context_.run();
  } catch (const std::exception& exception) {
    set_state(ClientState::kFailed, {ErrorCode::kInternal, fmt::format("the network thread: {}", exception.what())});
  }
}

ServerLink::Events StreamSession::link_events() {
  ServerLink::Events events;
  events.on_welcome = [this](const wire::Welcome& welcome) { return enter_scene(welcome); };
  events.on_frame = [this](IncomingFrame frame) { return receive(std::move(frame)); };
  events.on_state = [this](ClientState state, const Error& error) { set_state(state, error); };
  events.on_round_trip = [this](double seconds) {
    figures_.round_trip_seconds = seconds;
    note_figures();
  };
  events.held = [this](std::size_t count) {
    if (!sets_) return std::vector<ContentHash>();
    sets_->forget_reports();
    return sets_->store().held_payloads(count);
  };
  return events;
}

void StreamSession::set_state(ClientState state, const Error& error) {
  const std::lock_guard lock(board_.mutex);
  if (state == ClientState::kStreaming && board_.status.state == ClientState::kReconnecting) {
    board_.statistics.reconnects = ++figures_.reconnects;  // together with the state: who sees one sees the other
  }
  board_.status.state = state;
  if (!error.message.empty()) board_.status.error = error;
  board_.changed.notify_all();
}

// ── poses ──

void StreamSession::notice_pose() {
  asio::post(context_, [this] { follow_pose(); });
}

void StreamSession::follow_pose() {
  std::optional<CoreBoard::TimedPose> newest;
  {
    const std::lock_guard lock(board_.mutex);
    board_.is_pose_announced = false;
    newest = board_.pose;
  }
  if (!newest || !sets_) return;
  sets_->set_eye(position_on_wire(scene_->frame.grid, newest->pose.position));
  after_change();
  send_pose_if_due();
}

void StreamSession::send_pose_if_due() {
  std::optional<CoreBoard::TimedPose> newest;
  {
    const std::lock_guard lock(board_.mutex);
    newest = board_.pose;
  }
  if (!newest || !gate_ || !link_->is_streaming()) return;
  const PoseGate::Lacks lacks{options_.use_fallback && !sets_->has_usable_view(),
                              is_late(sets_->view().get(), position_on_wire(scene_->frame.grid, newest->pose.position))};
  const PoseGate::Decision decision = gate_->decide(newest->pose, lacks, seconds_now());
  if (decision.should_send) {
    wire::Pose message;
    fill_pose(scene_->frame.grid, newest->pose, message);
    message.set_time_s(newest->time_s);
    message.set_sequence(++poses_sent_);
    message.set_wants_fallback(lacks.usable_view);
    message.set_awaits_leaf_set(lacks.leaf_set);
    link_->send(make_message(MessageType::kPose, message));
    gate_->note_sent(newest->pose, lacks, seconds_now());
    ++figures_.poses;
    note_figures();
    send_pose_if_due();  // arms the timer for the pose that says the movement has ended
  } else if (decision.ask_again_in_s) {
    pose_timer_.expires_after(std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(*decision.ask_again_in_s)));
    pose_timer_.async_wait([this](const asio::error_code& cancelled) {
      if (!cancelled) send_pose_if_due();
    });
  }
}

// ── outcome ──

void StreamSession::after_change() {
  const bool may_refine = Clock::now() - last_publish_ >= options_.refresh_interval || decoding_.empty();
  if (sets_->update(may_refine)) {
    publish();
    send_pose_if_due();  // the server may send ahead once it knows that the eye's leaf set is here
  } else if (sets_->needs_refinement()) {
    refresh_later();
  }
  if (pool_ && grouped_version_ != sets_->roles_version()) {
    grouped_version_ = sets_->roles_version();
    pool_->regroup([this](const PayloadName& name) { return sets_->group_of(name); });
  }
  report_evictions();
  note_figures();
  const bool settled = is_settled();
  const std::lock_guard lock(board_.mutex);
  if (settled != board_.is_settled) {
    board_.is_settled = settled;
    board_.changed.notify_all();
  }
}

void StreamSession::publish() {
  last_publish_ = Clock::now();
  const std::shared_ptr<const LeafView>& view = sets_->view();
  if (figures_.entry_bytes == 0 && view->is_complete && !view->is_fallback) {
    figures_.entry_bytes = link_->bytes_in() + link_->bytes_out();
    figures_.entry_seconds = to_seconds(Clock::now() - started_);
  }
  // Only this thread writes the board's view, so reading it needs no lock.
  const bool is_same = board_.view && board_.view->is_same_set(*view);
  if (!is_same) ++figures_.switches;
  note_figures();  // before the view: whoever waits for it finds the figures that belong to it
  const bool settled = is_settled();
  {
    const std::lock_guard lock(board_.mutex);
    board_.view = view;
    board_.is_settled = settled;
    board_.changed.notify_all();
  }
  if (!is_same) trim_memory();
}

void StreamSession::trim_memory() {
  // Whoever runs along leaves does not pay for it with every one.
  constexpr std::chrono::seconds kInterval{2};
  const Clock::time_point now = Clock::now();
  if (now - last_trim_ < kInterval) return;
  last_trim_ = now;
  return_free_memory();
}

bool StreamSession::is_settled() const {
  const TrackedLeafSet* shown = sets_->shown();
  if (!shown || !shown->is_all_sent() || !shown->is_complete() || sets_->needs_refinement()) return false;
  for (const auto& [item, count] : decoding_) {
    if (shown->is_needed(item)) return false;
  }
  return true;
}

void StreamSession::refresh_later() {
  if (is_refresh_armed_) return;
  is_refresh_armed_ = true;
  refresh_timer_.expires_at(last_publish_ + options_.refresh_interval);
  refresh_timer_.async_wait([this](const asio::error_code&) {
    is_refresh_armed_ = false;
    if (sets_) after_change();
  });
}

void StreamSession::report_evictions() {
  const std::vector<ContentHash> gone = sets_->take_evicted();
  figures_.evicted_payloads += gone.size();
  // A server that announces no limit is still not sent more than fits its largest message.
  constexpr std::size_t kMostPerMessage = 50'000;
  const std::size_t limit = link_->held_limit() > 0 ? std::min(link_->held_limit(), kMostPerMessage) : kMostPerMessage;
  for (std::size_t first = 0; first < gone.size(); first += limit) {
    wire::Evicted message;
    for (std::size_t i = first; i < std::min(gone.size(), first + limit); ++i) message.add_payloads(gone[i]);
    link_->send(make_message(MessageType::kEvicted, message));
  }
}

void StreamSession::note_figures() {
  figures_.bytes_in = link_->bytes_in();
  figures_.bytes_out = link_->bytes_out();
  const std::uint64_t payloads = figures_.tile_bytes() + figures_.chunk_bytes + figures_.texture_bytes;
  figures_.control_bytes = figures_.bytes_in > payloads ? figures_.bytes_in - payloads : 0;
  if (sets_) {
    figures_.given_up = sets_->given_up();
    figures_.store_bytes = sets_->store().size_bytes();
    figures_.store_items = sets_->store().count();
  }
  figures_.decode_queue_bytes = pool_ ? pool_->queued_bytes() : 0;
  const std::lock_guard lock(board_.mutex);
  // Frames are counted on the board itself, by whoever draws.
  ClientStatistics& shown = board_.statistics;
  figures_.frames = shown.frames;
  figures_.late_frames = shown.late_frames;
  figures_.fallback_frames = shown.fallback_frames;
  shown = figures_;
}

}  // namespace farfield::client
