// SPDX-License-Identifier: Apache-2.0
#include "server/store/redis_connection.h"

#include <fcntl.h>
#include <hiredis/hiredis.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>

namespace farfield {
namespace {

using Clock = std::chrono::steady_clock;

timeval as_timeval(std::chrono::milliseconds time) {
  return {.tv_sec = static_cast<time_t>(time.count() / 1000), .tv_usec = static_cast<suseconds_t>(time.count() % 1000 * 1000)};
}

RedisReply as_reply(const redisReply& from) {
  RedisReply reply;
  const auto take_bytes = [&] { reply.bytes.assign(from.str, from.str + from.len); };
  switch (from.type) {
    case REDIS_REPLY_STRING:
    case REDIS_REPLY_STATUS: reply.kind = RedisReply::Kind::kBytes, take_bytes(); break;
    case REDIS_REPLY_ERROR: reply.kind = RedisReply::Kind::kError, take_bytes(); break;
    case REDIS_REPLY_INTEGER: reply.kind = RedisReply::Kind::kInteger, reply.integer = from.integer; break;
    case REDIS_REPLY_ARRAY:
      reply.kind = RedisReply::Kind::kList;
      for (std::size_t i = 0; i < from.elements; ++i) reply.list.push_back(as_reply(*from.element[i]));
      break;
    default: break;
  }
  return reply;
}

std::string as_protocol(std::span<const RedisCommand> commands) {
  std::string out;
  std::vector<const char*> arguments;
  std::vector<std::size_t> sizes;
  for (const RedisCommand& command : commands) {
    arguments.clear(), sizes.clear();
    for (const std::string_view argument : command) arguments.push_back(argument.data()), sizes.push_back(argument.size());
    char* formatted = nullptr;
    const int size = redisFormatCommandArgv(&formatted, static_cast<int>(command.size()), arguments.data(), sizes.data());
    if (size < 0) continue;
    out.append(formatted, static_cast<std::size_t>(size));
    redisFreeCommand(formatted);
  }
  return out;
}

}  // namespace

Result<RedisAddress> parse_redis_address(std::string_view text) {
  constexpr std::string_view kUnix = "unix:";
  const auto wrong = [&] { return fail(ErrorCode::kInvalidArgument, "'{}' is no address of a Redis server: write HOST:PORT or unix:PATH", text); };
  RedisAddress address;
  if (text.starts_with(kUnix)) {
    address.socket_path = text.substr(kUnix.size());
    return address.socket_path.empty() ? Result<RedisAddress>(wrong()) : address;
  }
  std::string_view host = text, port;
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos || (end + 1 < text.size() && text[end + 1] != ':')) return wrong();
    host = text.substr(1, end - 1);
    if (end + 1 < text.size()) port = text.substr(end + 2);
    if (end + 2 == text.size()) return wrong();
  } else if (const std::size_t colon = text.rfind(':'); colon != std::string_view::npos) {
    if (text.find(':') != colon) return wrong();
    host = text.substr(0, colon), port = text.substr(colon + 1);
    if (port.empty()) return wrong();
  }
  if (!port.empty()) {
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
    if (error != std::errc() || end != port.data() + port.size() || address.port == 0) return wrong();
  }
  if (!host.empty()) address.host = host;
  return text.empty() ? Result<RedisAddress>(wrong()) : address;
}

std::string to_string(const RedisAddress& address) {
  if (!address.socket_path.empty()) return "unix:" + address.socket_path;
  return fmt::format(fmt::runtime(address.host.find(':') == std::string::npos ? "{}:{}" : "[{}]:{}"), address.host, address.port);
}

struct RedisConnection::Context {
  explicit Context(redisContext* made) : redis(made) {}
  ~Context() { redisFree(redis); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  redisContext* const redis;
};

RedisConnection::RedisConnection(std::unique_ptr<Context> context, RedisAddress address) : context_(std::move(context)), address_(std::move(address)) {}
RedisConnection::~RedisConnection() = default;

Result<std::unique_ptr<RedisConnection>> RedisConnection::open(const RedisAddress& address, Milliseconds timeout) {
  const timeval limit = as_timeval(timeout);
  redisContext* const made = address.socket_path.empty() ? redisConnectWithTimeout(address.host.c_str(), address.port, limit)
                                                         : redisConnectUnixWithTimeout(address.socket_path.c_str(), limit);
  if (!made) return fail(ErrorCode::kUnavailable, "out of memory while connecting");
  auto context = std::make_unique<Context>(made);
  if (made->err) return fail(ErrorCode::kUnavailable, "{}", made->errstr);
  if (fcntl(made->fd, F_SETFL, fcntl(made->fd, F_GETFL) | O_NONBLOCK) < 0) return fail(ErrorCode::kUnavailable, "{}", std::strerror(errno));
  return std::unique_ptr<RedisConnection>(new RedisConnection(std::move(context), address));
}

Result<std::vector<RedisReply>> RedisConnection::run(std::span<const RedisCommand> commands, Milliseconds timeout) {
  const Clock::time_point until = Clock::now() + timeout;
  const std::string out = as_protocol(commands);
  std::size_t sent = 0;
  std::vector<RedisReply> replies;
  std::array<char, 65536> in;
  const int fd = context_->redis->fd;
  redisReader* const reader = context_->redis->reader;
  while (replies.size() < commands.size()) {
    // What Redis answers to the first is read while the last is still being sent: neither side waits for the other's buffer.
    const auto left = std::chrono::ceil<Milliseconds>(until - Clock::now());
    pollfd waiting{.fd = fd, .events = static_cast<short>(POLLIN | (sent < out.size() ? POLLOUT : 0)), .revents = 0};
    const int ready = left.count() > 0 ? poll(&waiting, 1, static_cast<int>(left.count())) : 0;
    if (ready == 0) return fail(ErrorCode::kUnavailable, "no answer within {} ms", timeout.count());
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) return fail(ErrorCode::kUnavailable, "{}", std::strerror(errno));
    if (waiting.revents & POLLOUT) {
      const ssize_t count = send(fd, out.data() + sent, out.size() - sent, MSG_NOSIGNAL);
      if (count < 0 && errno != EAGAIN && errno != EINTR) return fail(ErrorCode::kUnavailable, "{}", std::strerror(errno));
      sent += count > 0 ? static_cast<std::size_t>(count) : 0;
    }
    if (!(waiting.revents & (POLLIN | POLLHUP | POLLERR))) continue;
    const ssize_t count = recv(fd, in.data(), in.size(), 0);
    if (count == 0) return fail(ErrorCode::kUnavailable, "it closed the connection");
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (count < 0) return fail(ErrorCode::kUnavailable, "{}", std::strerror(errno));
    if (redisReaderFeed(reader, in.data(), static_cast<std::size_t>(count)) != REDIS_OK) return fail(ErrorCode::kUnavailable, "{}", reader->errstr);
    for (void* next = nullptr; replies.size() < commands.size();) {
      if (redisReaderGetReply(reader, &next) != REDIS_OK) return fail(ErrorCode::kUnavailable, "it does not speak Redis's protocol: {}", reader->errstr);
      if (!next) break;
      replies.push_back(as_reply(*static_cast<redisReply*>(next)));
      freeReplyObject(next);
    }
  }
  return replies;
}

RedisAddress RedisConnection::peer() const {
  RedisAddress peer = address_;
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  std::array<char, NI_MAXHOST> host{};
  if (!address_.socket_path.empty() || getpeername(context_->redis->fd, reinterpret_cast<sockaddr*>(&name), &size) != 0) return peer;
  if (getnameinfo(reinterpret_cast<sockaddr*>(&name), size, host.data(), host.size(), nullptr, 0, NI_NUMERICHOST) == 0) peer.host = host.data();
  return peer;
}

}  // namespace farfield
