// SPDX-License-Identifier: Apache-2.0
#include "server/store/redis_client.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

namespace farfield {

RedisClient::RedisClient(RedisClientOptions options) : options_(std::move(options)), peer_(options_.address), lost_at_(Clock::now()) {
  if (const Status found = find_server(); !found) say(fmt::format("not there, going on without it: {}", found.error().message));
  prober_ = std::jthread([this](const std::stop_token& stop) { probe(stop); });
  pthread_setname_np(prober_.native_handle(), "redis-probe");
}

RedisClient::~RedisClient() = default;

Result<RedisReply> RedisClient::run(const RedisCommand& command) {
  Result<std::vector<RedisReply>> replies = run({&command, 1}, options_.command_timeout);
  if (!replies) return tl::unexpected(std::move(replies.error()));
  return std::move(replies->front());
}

Result<std::vector<RedisReply>> RedisClient::run(std::span<const RedisCommand> commands, Milliseconds timeout) {
  std::unique_lock lock(mutex_);
  if (!is_there_) return fail(ErrorCode::kUnavailable, "Redis at {} is gone", to_string(options_.address));
  const std::uint64_t epoch = epoch_;
  const RedisAddress peer = peer_;
  Connection connection = take_idle();
  lock.unlock();
  const auto lost = [&](const Error& error) {
    lose(error.message, epoch);
    return fail(error.code, "Redis at {}: {}", to_string(options_.address), error.message);
  };
  if (connection) {
    const Clock::time_point asked = Clock::now();
    Result<std::vector<RedisReply>> replies = connection->run(commands, timeout);
    if (replies) return give_back(std::move(connection), epoch), replies;
    // Redis may have closed what was idle for long, or have been restarted since: that is no reason to be without it.
    if (Clock::now() - asked > timeout / 2) return lost(replies.error());
  }
  Result<Connection> opened = RedisConnection::open(peer, options_.connect_timeout);
  if (!opened) return lost(opened.error());
  connection = std::move(*opened);
  Result<std::vector<RedisReply>> replies = connection->run(commands, timeout);
  if (!replies) return lost(replies.error());
  give_back(std::move(connection), epoch);
  return replies;
}

bool RedisClient::wait_until_there(const std::stop_token& stop, Milliseconds longest) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, stop, longest, [this] { return is_there_.load(); });
  return is_there_;
}

RedisClient::Connection RedisClient::take_idle() {
  if (idle_.empty()) return nullptr;
  Connection connection = std::move(idle_.back());
  idle_.pop_back();
  return connection;
}

void RedisClient::give_back(Connection connection, std::uint64_t epoch) {
  const std::scoped_lock lock(mutex_);
  if (epoch == epoch_ && is_there_ && idle_.size() < kMostIdle) idle_.push_back(std::move(connection));
}

void RedisClient::lose(const std::string& why, std::uint64_t epoch) {
  std::vector<Connection> closed;  // after the lock is given back
  {
    const std::scoped_lock lock(mutex_);
    if (epoch != epoch_ || !is_there_) return;
    is_there_ = false;
    lost_at_ = Clock::now();
    closed.swap(idle_);
    changed_.notify_all();
  }
  say(fmt::format("lost, going on without it: {}", why));
}

// Connects anew, looking the name up again, and asks whether it answers.
Status RedisClient::find_server() {
  Result<Connection> opened = RedisConnection::open(options_.address, options_.connect_timeout);
  if (!opened) return tl::unexpected(std::move(opened.error()));
  const RedisCommand ping{"PING"};
  const Result<std::vector<RedisReply>> replies = (*opened)->run({&ping, 1}, options_.command_timeout);
  if (!replies) return tl::unexpected(replies.error());
  if (replies->front().kind == RedisReply::Kind::kError) return fail(ErrorCode::kUnavailable, "{}", replies->front().text());
  const std::scoped_lock lock(mutex_);
  peer_ = (*opened)->peer();
  idle_.push_back(std::move(*opened));
  ++epoch_;
  is_there_ = true;
  changed_.notify_all();
  return {};
}

void RedisClient::probe(const std::stop_token& stop) {
  Milliseconds pause = kFirstPause;
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (is_there_) {
      pause = kFirstPause;
      changed_.wait(lock, stop, [this] { return !is_there_; });
      continue;
    }
    changed_.wait_for(lock, stop, pause, [] { return false; });
    if (stop.stop_requested()) return;
    pause = std::min(2 * pause, options_.longest_pause);
    const Clock::time_point lost_at = lost_at_;
    lock.unlock();
    if (find_server()) say(fmt::format("there again after {:.1f} s", std::chrono::duration<double>(Clock::now() - lost_at).count()));
    lock.lock();
  }
}

void RedisClient::say(const std::string& what) const {
  if (options_.log) options_.log(fmt::format("Redis at {}: {}", to_string(options_.address), what));
}

}  // namespace farfield
