// SPDX-License-Identifier: Apache-2.0
#include "server/app/supervisor.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <condition_variable>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <utility>

namespace farfield {
namespace {

std::optional<std::uint64_t> number_in(const char* text) {
  if (!text) return std::nullopt;
  std::uint64_t value = 0;
  const char* const end = text + std::strlen(text);
  const auto [at, error] = std::from_chars(text, end, value);
  return error == std::errc() && at == end ? std::optional(value) : std::nullopt;
}

}  // namespace

Supervisor Supervisor::from_environment() {
  const char* const socket = std::getenv("NOTIFY_SOCKET");
  const auto process = number_in(std::getenv("WATCHDOG_PID")), period = number_in(std::getenv("WATCHDOG_USEC"));
  const bool is_for_this = period && *period > 0 && (!process || *process == static_cast<std::uint64_t>(getpid()));
  return {socket ? socket : "", is_for_this ? std::optional(std::chrono::microseconds(*period)) : std::nullopt};
}

void Supervisor::ready(std::string_view status) const { send("READY=1\nSTATUS=" + std::string(status)); }
void Supervisor::stopping() const { send("STOPPING=1\nSTATUS=draining"); }

std::optional<std::jthread> Supervisor::keep_pinging(std::function<bool()> is_alive) const {
  if (!is_there() || !watchdog_) return std::nullopt;
  return std::jthread([self = *this, is_alive = std::move(is_alive)](const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any changed;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
      if (is_alive()) self.send("WATCHDOG=1");
      changed.wait_for(lock, stop, *self.watchdog_ / 2, [] { return false; });
    }
  });
}

void Supervisor::send(const std::string& message) const {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_.empty() || socket_.size() >= sizeof(address.sun_path)) return;
  std::memcpy(address.sun_path, socket_.data(), socket_.size());
  if (address.sun_path[0] == '@') address.sun_path[0] = '\0';  // an abstract name
  const int descriptor = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return;
  // Nobody who could be told if it fails: the supervisor notices by itself.
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
  static_cast<void>(sendto(descriptor, message.data(), message.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&address), length));
  close(descriptor);
}

}  // namespace farfield
