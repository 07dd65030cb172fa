// SPDX-License-Identifier: Apache-2.0
// What each message of a client means to its session.
#include <algorithm>
#include <utility>

#include "common/net/message.h"
#include "proto/farfield.pb.h"
#include "server/session/session.h"
#include "server/session/session_messages.h"

namespace farfield {
namespace {

/// Names come from the network and go into logs and messages: printable, and not long.
std::string printable(const std::string& text) {
  std::string clean = text.substr(0, 60);
  std::replace_if(clean.begin(), clean.end(), [](char c) { return c < 0x20 || c > 0x7e; }, '?');
  return clean;
}

Result<std::shared_ptr<CellService>> find_scene(const std::vector<std::shared_ptr<CellService>>& catalogue,
                                                const std::string& name) {
  std::string names;
  for (const std::shared_ptr<CellService>& service : catalogue) {
    if (name.empty() || service->scene().name == name) return service;
    names += (names.empty() ? "" : ", ") + service->scene().name;
  }
  return fail(ErrorCode::kNotFound, "no scene '{}' here; there are: {}", printable(name), names);
}

Result<std::uint32_t> common_version(std::uint32_t client_min, std::uint32_t client_max) {
  const std::uint32_t version = std::min(client_max, kProtocolVersionMax);
  if (client_min > client_max || version < std::max(client_min, kProtocolVersionMin)) {
    return fail(ErrorCode::kVersionMismatch, "this server speaks versions {} to {} of the protocol, the client {} to {}: update the older",
                kProtocolVersionMin, kProtocolVersionMax, client_min, client_max);
  }
  return version;
}

}  // namespace

void Session::receive(IncomingFrame frame) {
  if (const Status status = dispatch(frame); !status) {
    ++world_.metrics.bad_frames;
    refuse(status.error());
  }
}

Status Session::dispatch(const IncomingFrame& frame) {
  const auto type = static_cast<MessageType>(frame.type);
  if (type == MessageType::kHello) return handle_hello(frame);
  if (type == MessageType::kPing) return handle_ping(frame);
  switch (type) {
    case MessageType::kPose:
    case MessageType::kEvicted:
      if (!service_) return fail(ErrorCode::kBadData, "a message of type {} before Hello", frame.type);
      return type == MessageType::kPose ? handle_pose(frame) : handle_evicted(frame);
    case MessageType::kBye:
      world_.registry.forget(token_);
      token_.clear();
      connection_->close({ErrorCode::kCancelled, "the client said goodbye"});
      return {};
    case MessageType::kFailure: {
      if (std::exchange(has_reported_, true)) return {};  // one line a session: a peer must not fill the log
      const Result<wire::Failure> failure = parse_message<wire::Failure>(frame);
      log("reports: " + (failure ? printable(failure->message()) : "an unreadable failure"));
      return {};
    }
    case MessageType::kPong: return {};
    default: break;
  }
  ++world_.metrics.unknown_frames;
  return {};
}

Status Session::handle_hello(const IncomingFrame& frame) {
  if (service_) return fail(ErrorCode::kBadData, "a second Hello on one connection");
  const Result<wire::Hello> hello = parse_message<wire::Hello>(frame);
  if (!hello) return tl::unexpected(hello.error());
  program_ = printable(hello->program());
  const Result<std::uint32_t> version = common_version(hello->version_min(), hello->version_max());
  if (!version) return tl::unexpected(version.error());
  // Before anything that depends on what is served here.
  if (!admit(hello->access_token())) return {};
  if (static_cast<std::uint32_t>(hello->held_size()) > world_.limits.held) {
    return fail(ErrorCode::kLimitExceeded, "Hello lists {} payloads, at most {} may be listed", hello->held_size(),
                world_.limits.held);
  }
  Result<std::shared_ptr<CellService>> service = find_scene(world_.catalogue, hello->scene());
  if (!service) return tl::unexpected(service.error());

  std::optional<ResumeState> resumed;
  if (!hello->resume_token().empty()) resumed = world_.registry.claim(hello->resume_token(), Clock::now());
  if (resumed && (resumed->scene != (*service)->scene().name || resumed->owner != owner())) resumed.reset();
  ++world_.metrics.sessions;
  if (resumed) ++world_.metrics.resumed_sessions;

  service_ = std::move(*service);
  start_streaming(resumed);
  for (const ContentHash key : hello->held()) pump_->note_held(key);
  const SessionGreeting greeting{token_, resumed.has_value(), *version};
  connection_->send(welcome_message(greeting, world_.limits, world_.catalogue, service_->scene()));
  log(fmt::format("{} scene '{}', holding {} payloads", resumed ? "resumes" : "enters", service_->scene().name,
                  hello->held_size()));
  // Where the viewer was before the cut is the best guess before the first pose.
  if (resumed && resumed->leaf) enter(resumed->leaf);
  return {};
}

bool Session::admit(const std::string& access_token) {
  if (!world_.tokens) return true;
  const Clock::time_point now = Clock::now();
  admission_ = world_.tokens->admit(access_token);
  if (!admission_ || !allows(admission_->entry.role, Action::kView)) {
    admission_.reset();
    ++world_.metrics.refused_tokens;
    if (address_visit_) address_visit_->note_failure(now);
    refuse(access_refused());
    return false;
  }
  auto visit = world_.token_limits->enter(admission_->entry.digest, now);
  if (!visit) {
    send_away(visit.error());
    return false;
  }
  token_visit_ = std::move(*visit);
  return true;
}

Session::Clock::duration Session::wait_for_view(Clock::time_point now) {
  Clock::duration wait{0};
  if (token_visit_) wait = token_visit_->view(now);
  if (address_visit_ && wait == Clock::duration::zero()) wait = address_visit_->view(now);
  return wait;
}

void Session::start_streaming(const std::optional<ResumeState>& resumed) {
  token_ = world_.registry.open([weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->supersede();
  });
  planner_.emplace(CellGrid{service_->scene().settings.finest_side_m});
  PayloadPump::Parts parts{connection_, service_, world_.limits, world_.metrics, *planner_, context_};
  pump_ = std::make_shared<PayloadPump>(std::move(parts), resumed ? resumed->next_serial : first_serial_);
  LeafTracker::Events events;
  events.on_enter = [this](std::shared_ptr<const LeafPlan> plan) { enter(std::move(plan)); };
  events.on_failure = [this](const Error& error) { report_failed_work(error); };
  events.on_wait = [this](Clock::duration wait) { wait_and_move(wait); };
  events.may_view = [this](Clock::time_point now) { return wait_for_view(now); };
  tracker_ = std::make_shared<LeafTracker>(connection_->executor(), service_, pump_, *planner_, world_.limits,
                                           world_.metrics, std::move(events), context_);
  pump_->on_spare_capacity([weak = std::weak_ptr<LeafTracker>(tracker_)] {
    if (const auto tracker = weak.lock()) tracker->ask_ahead();
  });

  world_.registry.update(token_, ResumeState{service_->scene().name, owner(), pump_->next_serial(), resumed ? resumed->leaf : nullptr});
}

// Errors of disks, stores and libraries name what only this machine knows; they stay here.
void Session::report_failed_work(const Error& error) {
  log(fmt::format("was told of failed work: {}", error.message));
  const bool is_clients = error.code == ErrorCode::kInvalidArgument || error.code == ErrorCode::kUnavailable || error.code == ErrorCode::kLimitExceeded;
  const Error told{error.code, is_clients ? error.message : "the cell could not be made; the server's log says why (--verbose)"};
  connection_->send(failure_message(told, false));
}

Status Session::handle_ping(const IncomingFrame& frame) {
  const Result<wire::Ping> ping = parse_message<wire::Ping>(frame);
  if (!ping) return tl::unexpected(ping.error());
  wire::Pong pong;
  pong.set_sequence(ping->sequence());
  pong.set_time_s(ping->time_s());
  connection_->send(make_message(MessageType::kPong, pong));
  return {};
}

Status Session::handle_evicted(const IncomingFrame& frame) {
  const Result<wire::Evicted> evicted = parse_message<wire::Evicted>(frame);
  if (!evicted) return tl::unexpected(evicted.error());
  if (static_cast<std::uint32_t>(evicted->payloads_size()) > world_.limits.held) {
    return fail(ErrorCode::kLimitExceeded, "Evicted lists {} payloads, at most {} may be listed", evicted->payloads_size(),
                world_.limits.held);
  }
  const std::vector<ContentHash> keys(evicted->payloads().begin(), evicted->payloads().end());
  pump_->note_evicted(keys);
  return {};
}

Status Session::handle_pose(const IncomingFrame& frame) {
  const Result<wire::Pose> message = parse_message<wire::Pose>(frame);
  if (!message) return tl::unexpected(message.error());
  const Result<Pose> pose = to_pose(*message, CellGrid{service_->scene().settings.finest_side_m});
  if (!pose) return tl::unexpected(pose.error());
  ++world_.metrics.poses;
  // Not taken yet: only the newest matters.
  if (pose_ && !pose_->is_taken) ++world_.metrics.poses_dropped;
  const bool wants_fallback = message->wants_fallback() || (pose_ && !pose_->is_taken && pose_->wants_fallback);
  pose_ = NewestPose{*pose, message->time_s(), message->sequence(), wants_fallback, message->awaits_leaf_set(), false};
  const auto now = Clock::now();
  if (pose_rate_.take(now)) {
    take_pose();
  } else {
    wait_and_move(pose_rate_.wait(now));
  }
  return {};
}

void Session::take_pose() {
  pose_->is_taken = true;
  pump_->note_awaiting(pose_->awaits_leaf_set);
  tracker_->move(pose_->pose, pose_->time_s, pose_->wants_fallback);
}

void Session::wait_and_move(Clock::duration wait) {
  if (std::exchange(is_pose_timer_armed_, true)) return;
  pose_timer_.expires_after(wait);
  pose_timer_.async_wait([weak = weak_from_this()](const asio::error_code& error) {
    const auto self = weak.lock();
    if (!self || error || !self->connection_->is_open()) return;
    self->is_pose_timer_armed_ = false;
    if (self->pose_ && !self->pose_->is_taken) {
      self->take_pose();
    } else {
      self->tracker_->move_again();
    }
  });
}

void Session::enter(std::shared_ptr<const LeafPlan> plan) {
  // A client that has not read the manifests before this one gets the newest later, instead of all of them.
  constexpr Clock::duration kManifestRetry = std::chrono::milliseconds(50);
  if (connection_->queued_control_bytes() > world_.limits.control_pause_bytes) {
    wait_and_move(kManifestRetry);
    return;
  }
  pump_->enter(std::move(plan));
  world_.registry.update(token_, ResumeState{service_->scene().name, owner(), pump_->next_serial(), pump_->current()});
}

}  // namespace farfield
