// SPDX-License-Identifier: Apache-2.0
// One connection to a Redis server: commands out, replies in, and never longer than the caller allows.
//
// hiredis opens the connection and knows the protocol; sending and receiving are done here, so that a limit holds for a whole command
// (hiredis's own is for each read) and a server that is gone raises no SIGPIPE.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace farfield {

inline constexpr std::uint16_t kRedisPort = 6379;

struct RedisAddress {
  std::string host = "127.0.0.1";
  std::uint16_t port = kRedisPort;
  std::string socket_path;  // not empty: a Unix domain socket in place of host and port
};
/// "HOST:PORT", "HOST", "[::1]:6379", "unix:PATH". Errors: kInvalidArgument.
Result<RedisAddress> parse_redis_address(std::string_view text);
std::string to_string(const RedisAddress& address);

/// A command and its arguments, any bytes. The views are read before the call that takes them returns.
using RedisCommand = std::vector<std::string_view>;

struct RedisReply {
  enum class Kind { kNil, kBytes, kInteger, kError, kList };
  Kind kind = Kind::kNil;
  Bytes bytes;  // of kBytes; of kError the message
  std::int64_t integer = 0;
  std::vector<RedisReply> list;

  std::string text() const { return {bytes.begin(), bytes.end()}; }
};

/// One thread at a time.
class RedisConnection {
 public:
  using Milliseconds = std::chrono::milliseconds;

  /// Looking up a host's name is not bounded by `timeout`. Errors: kUnavailable.
  static Result<std::unique_ptr<RedisConnection>> open(const RedisAddress& address, Milliseconds timeout);
  ~RedisConnection();
  RedisConnection(const RedisConnection&) = delete;
  RedisConnection& operator=(const RedisConnection&) = delete;

  /// Sends all of them at once and waits for as many replies, which may be errors of Redis's own.
  /// Errors: kUnavailable (no answer in time, closed, garbage): the connection is of no more use.
  Result<std::vector<RedisReply>> run(std::span<const RedisCommand> commands, Milliseconds timeout);
  /// Where it leads, as numbers: connecting there again looks up no name.
  RedisAddress peer() const;

 private:
  struct Context;  // hiredis's
  RedisConnection(std::unique_ptr<Context> context, RedisAddress address);

  std::unique_ptr<Context> context_;
  const RedisAddress address_;
};

}  // namespace farfield
