// SPDX-License-Identifier: Apache-2.0
// A Redis server of a test's own, on a socket in a folder of its own, which keeps nothing when it ends.
#pragma once

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <thread>

#include "server/store/redis_connection.h"
#include "tests/support/temporary_folder.h"

namespace farfield {

/// Owns the process: it never outlives this object. One thread.
class TestRedis {
 public:
  TestRedis() { start(); }
  ~TestRedis() { kill_now(); }
  TestRedis(const TestRedis&) = delete;
  TestRedis& operator=(const TestRedis&) = delete;

  /// Returns when it answers. Empty, whatever it held before.
  void start() {
    const std::string folder = folder_.path().string(), socket = address().socket_path;
    const char* arguments[] = {"redis-server", "--port", "0", "--unixsocket", socket.c_str(), "--save", "", "--appendonly", "no",
                               "--dir", folder.c_str(), "--logfile", "redis.log", "--maxmemory", "64mb", "--maxmemory-policy", "allkeys-lru", nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    if (posix_spawnp(&process_, arguments[0], &actions, nullptr, const_cast<char**>(arguments), environ) != 0) process_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    for (int tries = 0; tries < 1000 && process_ > 0 && !is_there(); ++tries) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  bool is_there() const { return ask({"PING"}).text() == "PONG"; }

  void kill_now() {
    if (process_ <= 0) return;
    ::kill(process_, SIGCONT), ::kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = -1;
    unlink(address().socket_path.c_str());
  }
  void stall() const { ::kill(process_, SIGSTOP); }
  void go_on() const { ::kill(process_, SIGCONT); }

  RedisAddress address() const { return {.socket_path = (folder_.path() / "redis.sock").string()}; }
  /// One command of the test's own. Returns: an error reply if it does not answer.
  RedisReply ask(const RedisCommand& command) const {
    constexpr std::chrono::milliseconds kPatience{5000};
    RedisReply none{.kind = RedisReply::Kind::kError};
    auto connection = RedisConnection::open(address(), kPatience);
    if (!connection) return none;
    auto replies = (*connection)->run({&command, 1}, kPatience);
    return replies ? std::move(replies->front()) : none;
  }

 private:
  TemporaryFolder folder_;
  pid_t process_ = -1;
};

}  // namespace farfield
