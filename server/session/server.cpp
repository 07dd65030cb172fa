// SPDX-License-Identifier: Apache-2.0
#include "server/session/server.h"

#include <algorithm>
#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>
#include <asio/executor_work_guard.hpp>
#include <asio/redirect_error.hpp>
#include <asio/steady_timer.hpp>
#include <asio/strand.hpp>
#include <asio/use_awaitable.hpp>
#include <condition_variable>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <unordered_set>

#include "common/net/connect.h"
#include "common/net/stream.h"
#include "server/session/session.h"
#include "server/session/session_messages.h"

namespace farfield {

using asio::ip::tcp;

struct Server::State {
  State(ServerOptions server_options, std::vector<std::shared_ptr<CellService>> scenes)
      : options(std::move(server_options)),
        registry(options.limits.resumable, options.limits.resume_for),
        address_limits(ClientLimits::create(options.limits.per_address, "address")),
        world{std::move(scenes), options.limits, metrics, registry, options.tokens, ClientLimits::create(options.limits.per_token, "token"), options.log},
        context(std::make_shared<asio::io_context>(options.threads)),
        work(asio::make_work_guard(*context)) {}

  ServerOptions options;
  SessionMetrics metrics;
  ResumeRegistry registry;
  std::shared_ptr<ClientLimits> address_limits;
  SessionWorld world;
  std::shared_ptr<asio::io_context> context;
  asio::executor_work_guard<asio::io_context::executor_type> work;
  struct Door {
    tcp::acceptor acceptor;
    Endpoint endpoint;
    bool is_tls = false;
  };
  std::vector<std::unique_ptr<Door>> doors;
  std::vector<std::thread> threads;

  std::mutex mutex;  // guards everything below
  std::condition_variable session_closed;
  std::unordered_map<std::uint64_t, std::weak_ptr<Session>> sessions;
  std::uint64_t next_session = 1;
  std::unordered_set<std::shared_ptr<Stream>> handshakes;
  std::atomic<bool> is_leaving{false};  // balancers are told; everybody is served
  std::atomic<bool> is_draining{false};

  Status add_door(const Endpoint& listen, bool is_tls);
  static asio::awaitable<void> accept(State* state, Door* door);
  void open(tcp::socket socket, bool is_tls);
  using Visit = std::shared_ptr<ClientLimits::Visit>;  // null: of an address without limits
  static asio::awaitable<void> secure(State* state, std::shared_ptr<Stream> stream, Visit visit);
  void open(std::shared_ptr<Stream> stream, Visit visit);
  tl::expected<Visit, Refusal> enter(const tcp::socket& socket);
  void refuse(std::shared_ptr<Connection> connection, const Refusal& refusal);
  std::vector<std::shared_ptr<Session>> open_sessions();
  void stop_listening();
  void log(const std::string& line) const {
    if (options.log) options.log(line);
  }
};

Status Server::State::add_door(const Endpoint& listen, bool is_tls) {
  // On a strand of its own: closing it must not meet an accept on another thread.
  Result<tcp::acceptor> acceptor = listen_at(asio::make_strand(*context), listen);
  if (!acceptor) return tl::unexpected(acceptor.error());
  asio::error_code ignored;
  const tcp::endpoint local = acceptor->local_endpoint(ignored);
  doors.push_back(std::make_unique<Door>(Door{std::move(*acceptor), {local.address().to_string(), local.port()}, is_tls}));
  return {};
}

asio::awaitable<void> Server::State::accept(State* state, Door* door) {
  asio::error_code error;
  asio::steady_timer pause(*state->context);
  while (door->acceptor.is_open()) {
    tcp::socket socket(asio::any_io_executor(asio::make_strand(*state->context)));
    co_await door->acceptor.async_accept(socket, asio::redirect_error(asio::use_awaitable, error));
    if (!error) {
      state->open(std::move(socket), door->is_tls);
    } else if (error != asio::error::operation_aborted) {
      // Out of descriptors, most likely: those who are here go on, new ones wait until some have left.
      pause.expires_after(std::chrono::milliseconds(100));
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
    }
  }
}

void Server::State::open(tcp::socket socket, bool is_tls) {
  tl::expected<Visit, Refusal> visit = enter(socket);
  if (!visit && is_tls) {
    ++metrics.refused_sessions;
    return;  // as below
  }
  if (!visit) {
    const auto connection = Connection::create(std::move(socket), {});
    asio::post(connection->executor(), [this, connection, refusal = visit.error()] { refuse(connection, refusal); });
    return;
  }
  if (!is_tls) return open(std::make_shared<Stream>(std::move(socket)), std::move(*visit));
  auto stream = std::make_shared<Stream>(options.tls->wrap(std::move(socket)));
  {
    const std::lock_guard lock(mutex);
    if (is_draining || handshakes.size() >= options.limits.handshakes) {
      ++metrics.refused_sessions;
      return;  // a word of explanation would cost the handshake that there is no room for
    }
    handshakes.insert(stream);
  }
  const asio::any_io_executor executor = stream->socket().get_executor();
  asio::co_spawn(executor, secure(this, std::move(stream), std::move(*visit)), asio::detached);
}

tl::expected<Server::State::Visit, Refusal> Server::State::enter(const tcp::socket& socket) {
  asio::error_code error;
  const asio::ip::address address = socket.remote_endpoint(error).address();
  if (error || (address.is_loopback() && !options.limits.limits_loopback)) return Visit();
  return address_limits->enter(key_of(address), ClientLimits::Clock::now());
}

asio::awaitable<void> Server::State::secure(State* state, std::shared_ptr<Stream> stream, Visit visit) {
  const Status shaken = co_await shake_hands(stream, true, state->options.limits.handshake_timeout);
  {
    const std::lock_guard lock(state->mutex);
    state->handshakes.erase(stream);
  }
  if (shaken) {
    state->open(std::move(stream), std::move(visit));
  } else {
    ++state->metrics.failed_handshakes;
    state->log("refused: " + shaken.error().message);
  }
}

void Server::State::open(std::shared_ptr<Stream> stream, Visit visit) {
  ConnectionOptions connection_options;
  connection_options.receive_limits = kFromClientLimits;
  connection_options.outbox_bytes = options.limits.outbox_bytes;
  connection_options.control_outbox_bytes = options.limits.control_bytes;
  connection_options.totals = metrics.traffic;
  std::shared_ptr<Connection> connection = Connection::create(std::move(stream), connection_options);

  std::shared_ptr<Session> session;
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(mutex);
    if (sessions.size() < options.limits.sessions && !is_draining) {
      number = next_session++;
      // Serials of different sessions never meet, so a client that could not resume does not confuse them.
      session = std::make_shared<Session>(context, connection, world, (number << 32) + 1, std::move(visit));
      sessions[number] = session;
    }
  }
  const asio::any_io_executor executor = connection->executor();
  if (!session) {
    const std::string reason = is_draining ? "this server is shutting down" : "this server is full";
    asio::post(executor, [this, connection, reason] { refuse(connection, {reason, std::chrono::seconds(5)}); });
    return;
  }
  ++metrics.open_sessions;
  asio::post(executor, [this, session, number] {
    session->start([this, number] {
      --metrics.open_sessions;
      const std::lock_guard lock(mutex);
      sessions.erase(number);
      session_closed.notify_all();
    });
  });
}

void Server::State::refuse(std::shared_ptr<Connection> connection, const Refusal& refusal) {
  ++metrics.refused_sessions;
  connection->start({});
  connection->send(go_away_message(refusal.reason, "", refusal.retry_after));
  connection->close_after_flush({ErrorCode::kUnavailable, refusal.reason}, std::chrono::seconds(1));
}

std::vector<std::shared_ptr<Session>> Server::State::open_sessions() {
  std::vector<std::shared_ptr<Session>> open;
  const std::lock_guard lock(mutex);
  for (const auto& [number, session] : sessions) {
    if (auto alive = session.lock()) open.push_back(std::move(alive));
  }
  return open;
}

// Returns when nobody can connect any more. Not from a network thread: it waits for one.
void Server::State::stop_listening() {
  for (const std::unique_ptr<Door>& door : doors) {
    const auto closed = std::make_shared<std::promise<void>>();
    asio::post(door->acceptor.get_executor(), [&door, closed] {
      asio::error_code ignored;
      door->acceptor.close(ignored);
      closed->set_value();
    });
    closed->get_future().wait();
  }
  const std::lock_guard lock(mutex);
  for (const std::shared_ptr<Stream>& stream : handshakes) {
    asio::post(stream->socket().get_executor(), [stream] {
      asio::error_code ignored;
      stream->socket().close(ignored);
    });
  }
}

Server::Server(std::unique_ptr<State> state) : state_(std::move(state)) {}

Result<std::unique_ptr<Server>> Server::start(ServerOptions options, std::vector<std::shared_ptr<CellService>> scenes) {
  if (scenes.empty()) return fail(ErrorCode::kInvalidArgument, "a server needs at least one scene");
  std::unordered_set<std::string> names;
  for (const std::shared_ptr<CellService>& scene : scenes) {
    if (!names.insert(scene->scene().name).second) {
      return fail(ErrorCode::kInvalidArgument, "two scenes are called '{}': give one another name with NAME=SCENE",
                  scene->scene().name);
    }
  }
  options.threads = std::max(options.threads, 1);
  auto state = std::make_unique<State>(std::move(options), std::move(scenes));
  const ServerOptions& given = state->options;
  if (!given.listen && !given.tls_listen) return fail(ErrorCode::kInvalidArgument, "a server needs an address to listen at");
  if (given.tls_listen && !given.tls) return fail(ErrorCode::kInvalidArgument, "listening for TLS needs a certificate and its key");
  if (given.listen) {
    if (Status opened = state->add_door(*given.listen, false); !opened) return tl::unexpected(opened.error());
  }
  if (given.tls_listen) {
    if (Status opened = state->add_door(*given.tls_listen, true); !opened) return tl::unexpected(opened.error());
  }
  for (const auto& door : state->doors) {
    asio::co_spawn(door->acceptor.get_executor(), State::accept(state.get(), door.get()), asio::detached);
  }
  for (int i = 0; i < state->options.threads; ++i) {
    state->threads.emplace_back([context = state->context] { context->run(); });
  }
  return std::unique_ptr<Server>(new Server(std::move(state)));
}

Server::~Server() {
  state_->is_draining = true;
  state_->stop_listening();
  for (const auto& session : state_->open_sessions()) session->drain("the server stops", std::chrono::milliseconds(0));
  // Closed connections end their coroutines, and without any the network threads have nothing left to do.
  state_->work.reset();
  for (std::thread& thread : state_->threads) thread.join();
}

Endpoint Server::endpoint() const { return state_->doors.front()->endpoint; }
std::optional<Endpoint> Server::tls_endpoint() const {
  const State::Door& last = *state_->doors.back();
  return last.is_tls ? std::optional(last.endpoint) : std::nullopt;
}
const SessionMetrics& Server::metrics() const { return state_->metrics; }
std::string Server::why_not_ready() const {
  if (state_->is_leaving || state_->is_draining) return "draining";
  const std::lock_guard lock(state_->mutex);
  return state_->sessions.size() >= state_->options.limits.sessions ? "full" : "";
}
bool Server::answers_within(std::chrono::milliseconds patience) const {
  const auto answered = std::make_shared<std::promise<void>>();
  std::future<void> answer = answered->get_future();
  asio::post(*state_->context, [answered] { answered->set_value(); });
  return answer.wait_for(patience) == std::future_status::ready;
}
void Server::announce_drain() { state_->is_leaving = true; }

void Server::drain(const std::string& reason, std::chrono::milliseconds grace) {
  state_->is_draining = true;
  state_->stop_listening();
  for (const auto& session : state_->open_sessions()) session->drain(reason, grace);
  std::unique_lock lock(state_->mutex);
  // A little longer than each session's own grace, so that the last of them is counted.
  state_->session_closed.wait_for(lock, grace + std::chrono::milliseconds(200), [&] { return state_->sessions.empty(); });
}

}  // namespace farfield
