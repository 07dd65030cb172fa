// SPDX-License-Identifier: Apache-2.0
// The network thread's side of a ClientCore: frames in, leaf sets kept, views out, poses and evictions back.
//
// Threads: start() and stop() belong to the owner; notice_pose() may be called from anywhere; everything else runs on
// the session's own thread.
#pragma once

#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/steady_timer.hpp>
#include <memory>
#include <optional>
#include <thread>
#include <unordered_map>

#include "client/decode/decode_pool.h"
#include "client/session/client_options.h"
#include "client/session/core_board.h"
#include "client/session/decode_inbox.h"
#include "client/session/pose_gate.h"
#include "client/session/server_link.h"
#include "client/store/leaf_sets.h"

namespace farfield::client {

class StreamSession {
 public:
  explicit StreamSession(ClientOptions options);
  ~StreamSession();

  void start();
  /// Says goodbye and joins. Idempotent.
  void stop();
  /// board().pose has changed.
  void notice_pose();
  CoreBoard& board() { return board_; }
  const CoreBoard& board() const { return board_; }

 private:
  using Clock = std::chrono::steady_clock;

  void run();
  ServerLink::Events link_events();

  // ── from the link ──
  Status enter_scene(const wire::Welcome& welcome);
  Status receive(IncomingFrame frame);
  Status receive_leaf_set(const IncomingFrame& frame);
  Status receive_complete(const IncomingFrame& frame);
  Status receive_payload(const IncomingFrame& frame);
  void set_state(ClientState state, const Error& error);

  // ── decoding ──
  void submit(EncodedPayload payload);
  void put_decoded(const PayloadName& name, Result<DecodedPayload> result);  // on any thread
  void take_decoded(std::vector<DecodeInbox::Item> items);
  void count_payload(const PayloadName& name, ByteView bytes);

  // ── poses ──
  void follow_pose();
  void send_pose_if_due();

  // ── outcome ──
  void after_change();
  void publish();
  void report_evictions();
  void trim_memory();
  void note_figures();
  bool is_settled() const;
  void refresh_later();

  const ClientOptions options_;
  CoreBoard board_;
  asio::io_context context_{1};
  asio::executor_work_guard<asio::io_context::executor_type> work_;
  asio::steady_timer pose_timer_, refresh_timer_;
  std::shared_ptr<ServerLink> link_;
  std::optional<SceneDescription> scene_;
  std::unique_ptr<LeafSets> sets_;
  std::optional<PoseGate> gate_;
  DecodeInbox inbox_;
  std::unordered_map<ContentHash, int> decoding_;  // by item: payloads submitted and not back yet
  std::uint64_t grouped_version_ = 0;              // of the roles, when what waits was last sorted
  std::uint64_t poses_sent_ = 0;
  Clock::time_point started_;
  Clock::time_point last_publish_{};
  Clock::time_point last_trim_{};
  bool is_refresh_armed_ = false;
  ClientStatistics figures_;                       // copied to the board by note_figures()
  std::unique_ptr<DecodePool> pool_;               // null: nothing is decoded (DecodeForm::kNone)
  std::thread thread_;
};

}  // namespace farfield::client
