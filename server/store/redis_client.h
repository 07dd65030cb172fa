// SPDX-License-Identifier: Apache-2.0
// A Redis server that may go away and come back, seen from many threads: a few connections, and a breaker.
//
//             any failure                          a probe is answered
//   there ─────────────────▶ gone: fails at once ─────────────────────▶ there
//                            a thread probes, after 50 ms, 100 ms, … 5 s
//
// So a server that stalls costs each thread one command's time limit, once; one that is gone costs nothing.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "server/store/redis_connection.h"

namespace farfield {

struct RedisClientOptions {
  RedisAddress address;
  std::chrono::milliseconds connect_timeout{250};
  std::chrono::milliseconds command_timeout{250};  // of run() where nothing else is said
  std::chrono::milliseconds longest_pause{5000};   // between probes
  std::function<void(const std::string&)> log;     // one line when it is lost, one when it is back; may be empty
};

/// Thread-safe.
class RedisClient {
 public:
  using Milliseconds = std::chrono::milliseconds;

  /// Tries to connect once; a server that is not there is said in the log and taken for gone.
  explicit RedisClient(RedisClientOptions options);
  ~RedisClient();
  RedisClient(const RedisClient&) = delete;
  RedisClient& operator=(const RedisClient&) = delete;

  /// Errors: kUnavailable: gone, or lost by this. A reply may be an error of Redis's own, which breaks nothing.
  Result<std::vector<RedisReply>> run(std::span<const RedisCommand> commands, Milliseconds timeout);
  Result<RedisReply> run(const RedisCommand& command);

  bool is_there() const { return is_there_; }
  /// Returns: is_there(), once it is, `stop` is requested or `longest` is over.
  bool wait_until_there(const std::stop_token& stop, Milliseconds longest);
  const RedisAddress& address() const { return options_.address; }

 private:
  using Clock = std::chrono::steady_clock;
  using Connection = std::unique_ptr<RedisConnection>;
  static constexpr Milliseconds kFirstPause{50};
  static constexpr std::size_t kMostIdle = 8;

  void probe(const std::stop_token& stop);
  Status find_server();
  // Requires: mutex_ held.
  Connection take_idle();
  void give_back(Connection connection, std::uint64_t epoch);
  void lose(const std::string& why, std::uint64_t epoch);
  void say(const std::string& what) const;

  const RedisClientOptions options_;
  mutable std::mutex mutex_;  // guards everything below
  std::condition_variable_any changed_;
  RedisAddress peer_;         // where the last probe found it, as numbers
  std::vector<Connection> idle_;
  std::uint64_t epoch_ = 0;   // how often it was found: what failed in an earlier one says nothing of now
  Clock::time_point lost_at_;
  std::atomic<bool> is_there_{false};  // written under the mutex
  std::jthread prober_;
};

}  // namespace farfield
