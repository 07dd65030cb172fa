// SPDX-License-Identifier: Apache-2.0
// Sessions that may be continued: by token, for a while after their connection broke. Bounded; thread-safe.
//
// What a client holds is not remembered here: after a cut only the client knows what arrived, and says so in Hello.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "server/access/access_token.h"
#include "server/cells/leaf_plan.h"

namespace farfield {

struct ResumeState {
  std::string scene;
  TokenDigest owner{};                   // whose access token began it; zeros where there are none
  std::uint64_t next_serial = 1;
  std::shared_ptr<const LeafPlan> leaf;  // the last the viewer was in; may be null
};

class ResumeRegistry {
 public:
  using Clock = std::chrono::steady_clock;

  ResumeRegistry(std::size_t capacity, std::chrono::milliseconds keep_for) : capacity_(capacity), keep_for_(keep_for) {}

  /// A token for a session that begins: 16 bytes nobody can guess. `supersede` closes the session when its client
  /// comes back before the server has noticed the cut; it is called from claim(), on any thread.
  std::string open(std::function<void()> supersede);
  /// What the session would be continued with.
  void update(const std::string& token, ResumeState state);
  /// The connection broke: the state is kept from now on for a while.
  void close(const std::string& token, Clock::time_point now);
  /// An orderly end.
  void forget(const std::string& token);
  /// The state behind a token, which is then spent. Nothing for unknown and expired tokens.
  std::optional<ResumeState> claim(const std::string& token, Clock::time_point now);

  std::size_t size() const;

 private:
  struct Entry {
    ResumeState state;
    std::function<void()> supersede;
    std::optional<Clock::time_point> expires;  // empty while the session lives
  };
  void drop_expired(Clock::time_point now);

  std::size_t capacity_;
  std::chrono::milliseconds keep_for_;
  mutable std::mutex mutex_;  // guards entries_
  std::unordered_map<std::string, Entry> entries_;
};

}  // namespace farfield
