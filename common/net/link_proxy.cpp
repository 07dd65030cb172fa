// SPDX-License-Identifier: Apache-2.0
#include "common/net/link_proxy.h"

#include <algorithm>
#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>
#include <asio/io_context.hpp>
#include <asio/redirect_error.hpp>
#include <asio/steady_timer.hpp>
#include <asio/use_awaitable.hpp>
#include <asio/write.hpp>
#include <atomic>
#include <deque>
#include <thread>
#include <vector>

#include "common/base/bytes.h"
#include "common/net/connect.h"

namespace farfield {
namespace {

using asio::ip::tcp;
using Clock = std::chrono::steady_clock;

/// A piece of the stream under way.
struct Parcel {
  Bytes bytes;
  Clock::time_point due;
};

/// Pieces of about two milliseconds, so that a slow link is shaped finely and a fast one costs few system calls.
std::size_t parcel_bytes(const LinkModel& model) {
  if (!(model.rate_bits_per_second > 0)) return std::size_t{64} << 10;
  return static_cast<std::size_t>(std::clamp(model.rate_bits_per_second / 8 * 0.002, 1448.0, 65536.0));
}

std::size_t under_way_limit(const LinkModel& model) {
  if (!(model.rate_bits_per_second > 0)) return std::size_t{4} << 20;
  return model.bandwidth_delay_bytes() + 4 * parcel_bytes(model);
}

/// One direction of one connection.
struct Direction {
  Direction(const LinkModel& model, std::uint64_t seed, asio::any_io_executor executor)
      : shaper(model, seed), room(executor), arrived(executor) {}
  LinkShaper shaper;
  std::deque<Parcel> under_way;
  std::size_t under_way_bytes = 0;
  bool has_ended = false;
  asio::steady_timer room, arrived;  // wake the reading and the writing coroutine
};

struct Pair {
  Pair(tcp::socket client_socket, const LinkModel& link, std::uint64_t seed)
      : model(link),
        client(std::move(client_socket)),
        target(client.get_executor()),
        up(link, 2 * seed, client.get_executor()),
        down(link, 2 * seed + 1, client.get_executor()),
        break_at(client.get_executor()),
        random(seed) {}
  void close() {
    asio::error_code ignored;
    is_closed = true;
    // Lingering for zero seconds resets the connection: what is under way is lost, as when a network breaks.
    for (tcp::socket* socket : {&client, &target}) {
      socket->set_option(asio::socket_base::linger(true, 0), ignored);
      socket->close(ignored);
    }
    break_at.cancel();
    for (Direction* direction : {&up, &down}) {
      direction->room.cancel();
      direction->arrived.cancel();
    }
  }

  LinkModel model;
  tcp::socket client, target;
  Direction up, down;
  asio::steady_timer break_at;  // until it is cut, if the model says so
  std::mt19937_64 random;
  bool is_closed = false;
};

// Breaks happen at any moment alike, so that the time to the next one is exponential.
void cut_in_time(const std::shared_ptr<Pair>& pair) {
  if (!(pair->model.cut.count() > 0)) return;
  const double seconds = std::exponential_distribution<double>(1 / pair->model.cut.count())(pair->random);
  pair->break_at.expires_after(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)));
  pair->break_at.async_wait([weak = std::weak_ptr<Pair>(pair)](const asio::error_code& error) {
    const auto open_pair = error ? nullptr : weak.lock();
    if (open_pair) open_pair->close();
  });
}

asio::awaitable<void> read_into(std::shared_ptr<Pair> pair, tcp::socket* from, Direction* direction) {
  asio::error_code error;
  const std::size_t piece = parcel_bytes(pair->model), limit = under_way_limit(pair->model);
  const Clock::time_point start = Clock::now();
  while (!pair->is_closed) {
    if (direction->under_way_bytes >= limit) {
      direction->room.expires_at(Clock::time_point::max());
      co_await direction->room.async_wait(asio::redirect_error(asio::use_awaitable, error));
      continue;
    }
    Parcel parcel;
    parcel.bytes.resize(piece);
    const asio::mutable_buffer buffer(parcel.bytes.data(), parcel.bytes.size());
    const std::size_t size = co_await from->async_read_some(buffer, asio::redirect_error(asio::use_awaitable, error));
    if (error) break;
    parcel.bytes.resize(size);
    const LinkShaper::Seconds due = direction->shaper.deliver(Clock::now() - start, size);
    parcel.due = start + std::chrono::duration_cast<Clock::duration>(due);
    direction->under_way_bytes += size;
    direction->under_way.push_back(std::move(parcel));
    direction->arrived.cancel();
  }
  if (error && error != asio::error::eof) pair->close();
  direction->has_ended = true;
  direction->arrived.cancel();
}

asio::awaitable<void> write_from(std::shared_ptr<Pair> pair, tcp::socket* to, Direction* direction,
                                 std::atomic<std::uint64_t>* counter) {
  asio::error_code error;
  while (!pair->is_closed) {
    if (direction->under_way.empty()) {
      if (direction->has_ended) break;
      direction->arrived.expires_at(Clock::time_point::max());
      co_await direction->arrived.async_wait(asio::redirect_error(asio::use_awaitable, error));
      continue;
    }
    const Clock::time_point due = direction->under_way.front().due;
    if (due > Clock::now()) {
      // New arrivals cancel this wait; the loop then waits for the same parcel again.
      direction->arrived.expires_at(due);
      co_await direction->arrived.async_wait(asio::redirect_error(asio::use_awaitable, error));
      continue;
    }
    const Parcel parcel = std::move(direction->under_way.front());
    direction->under_way.pop_front();
    const asio::const_buffer buffer(parcel.bytes.data(), parcel.bytes.size());
    // Counted first: whoever has read the bytes finds them counted.
    counter->fetch_add(parcel.bytes.size(), std::memory_order_relaxed);
    co_await asio::async_write(*to, buffer, asio::redirect_error(asio::use_awaitable, error));
    if (error) {
      pair->close();
      break;
    }
    direction->under_way_bytes -= parcel.bytes.size();
    direction->room.cancel();
  }
  asio::error_code ignored;
  to->shutdown(tcp::socket::shutdown_send, ignored);
}

}  // namespace

struct LinkProxy::State {
  State(const Endpoint& to, const LinkModel& link, std::uint64_t first_seed)
      : target(to), model(link), seed(first_seed), acceptor(context) {}

  asio::io_context context{1};
  Endpoint target;
  LinkModel model;
  std::uint64_t seed;
  tcp::acceptor acceptor;
  Endpoint endpoint;
  int receive_buffer_bytes = 0;  // 0: the system's choice
  std::atomic<bool> is_refusing{false};
  std::atomic<std::uint64_t> to_target{0}, to_clients{0};
  std::vector<std::weak_ptr<Pair>> pairs;
  std::thread thread;

  static asio::awaitable<void> open(State* state, std::shared_ptr<Pair> pair) {
    const asio::any_io_executor executor = pair->client.get_executor();
    const Endpoint target = state->target;
    Result<tcp::socket> socket = co_await connect_to(executor, target, std::chrono::seconds(5));
    if (!socket || pair->is_closed) {
      pair->close();
      co_return;
    }
    pair->target = std::move(*socket);
    asio::error_code ignored;
    for (tcp::socket* end : {&pair->client, &pair->target}) end->set_option(tcp::no_delay(true), ignored);
    if (state->receive_buffer_bytes > 0) {
      pair->target.set_option(asio::socket_base::receive_buffer_size(state->receive_buffer_bytes), ignored);
    }
    cut_in_time(pair);
    asio::co_spawn(executor, read_into(pair, &pair->client, &pair->up), asio::detached);
    asio::co_spawn(executor, write_from(pair, &pair->target, &pair->up, &state->to_target), asio::detached);
    asio::co_spawn(executor, read_into(pair, &pair->target, &pair->down), asio::detached);
    asio::co_spawn(executor, write_from(pair, &pair->client, &pair->down, &state->to_clients), asio::detached);
  }

  static asio::awaitable<void> accept(State* state) {
    asio::error_code error;
    while (error != asio::error::operation_aborted) {
      tcp::socket socket =
          co_await state->acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
      if (error || state->is_refusing) continue;
      std::erase_if(state->pairs, [](const std::weak_ptr<Pair>& pair) { return pair.expired(); });
      const auto pair = std::make_shared<Pair>(std::move(socket), state->model, state->seed++);
      state->pairs.push_back(pair);
      asio::co_spawn(state->context, open(state, pair), asio::detached);
    }
  }

  void cut() {
    for (const std::weak_ptr<Pair>& pair : pairs) {
      if (const auto open_pair = pair.lock()) open_pair->close();
    }
    pairs.clear();
  }
};

LinkProxy::LinkProxy(std::unique_ptr<State> state) : state_(std::move(state)) {}

Result<std::unique_ptr<LinkProxy>> LinkProxy::start(const Endpoint& target, const LinkModel& model,
                                                    std::uint64_t seed) {
  auto state = std::make_unique<State>(target, model, seed);
  Result<tcp::acceptor> acceptor = listen_at(state->context.get_executor(), Endpoint{"127.0.0.1", 0});
  if (!acceptor) return tl::unexpected(acceptor.error());
  state->acceptor = std::move(*acceptor);
  if (model.rate_bits_per_second > 0) {
    // A large kernel buffer in front of a slow link would hide its back-pressure. Accepted sockets inherit this.
    asio::error_code ignored;
    state->receive_buffer_bytes =
        static_cast<int>(std::min<std::size_t>(under_way_limit(model) + (64u << 10), 4u << 20));
    state->acceptor.set_option(asio::socket_base::receive_buffer_size(state->receive_buffer_bytes), ignored);
  }
  state->endpoint = Endpoint{"127.0.0.1", state->acceptor.local_endpoint().port()};
  asio::co_spawn(state->context, State::accept(state.get()), asio::detached);
  State* raw = state.get();
  state->thread = std::thread([raw] { raw->context.run(); });
  return std::unique_ptr<LinkProxy>(new LinkProxy(std::move(state)));
}

LinkProxy::~LinkProxy() {
  asio::post(state_->context, [state = state_.get()] {
    asio::error_code ignored;
    state->acceptor.close(ignored);
    state->cut();
    state->context.stop();
  });
  state_->thread.join();
}

Endpoint LinkProxy::endpoint() const { return state_->endpoint; }
void LinkProxy::cut() {
  asio::post(state_->context, [state = state_.get()] { state->cut(); });
}
void LinkProxy::set_refusing(bool refusing) { state_->is_refusing = refusing; }
std::uint64_t LinkProxy::bytes_to_target() const { return state_->to_target; }
std::uint64_t LinkProxy::bytes_to_clients() const { return state_->to_clients; }

}  // namespace farfield
