// SPDX-License-Identifier: Apache-2.0
#include "server/admin/admin_server.h"

#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>
#include <asio/io_context.hpp>
#include <asio/post.hpp>
#include <asio/read_until.hpp>
#include <asio/redirect_error.hpp>
#include <asio/steady_timer.hpp>
#include <asio/use_awaitable.hpp>
#include <asio/write.hpp>
#include <thread>

#include "common/net/connect.h"

namespace farfield {
namespace {

using asio::ip::tcp;

constexpr std::size_t kRequestBytes = 8192;
constexpr std::chrono::seconds kRequestTime{5};

std::string response(std::string_view status, std::string_view type, std::string_view body) {
  return fmt::format("HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}", status, type,
                     body.size(), body);
}

struct Visit {
  explicit Visit(tcp::socket accepted) : socket(std::move(accepted)), deadline(socket.get_executor()) {}
  tcp::socket socket;
  asio::steady_timer deadline;
  std::string request;
};

asio::awaitable<void> answer(std::shared_ptr<Visit> visit, const AdminPages* pages) {
  asio::error_code error;
  visit->deadline.expires_after(kRequestTime);
  visit->deadline.async_wait([weak = std::weak_ptr(visit)](const asio::error_code& cancelled) {
    asio::error_code ignored;
    if (const auto late = weak.lock(); late && !cancelled) late->socket.close(ignored);
  });
  auto buffer = asio::dynamic_buffer(visit->request, kRequestBytes);
  co_await asio::async_read_until(visit->socket, buffer, "\r\n\r\n", asio::redirect_error(asio::use_awaitable, error));
  if (!error) {
    const std::string line = visit->request.substr(0, visit->request.find("\r\n"));
    const std::string reply = admin_response(line, *pages);
    const asio::const_buffer bytes(reply.data(), reply.size());
    co_await asio::async_write(visit->socket, bytes, asio::redirect_error(asio::use_awaitable, error));
    visit->socket.shutdown(tcp::socket::shutdown_both, error);
  }
  visit->deadline.cancel();
}

}  // namespace

std::string admin_response(std::string_view request, const AdminPages& pages) {
  constexpr std::string_view kPlain = "text/plain; charset=utf-8";
  const std::size_t method_end = request.find(' ');
  const std::size_t target_end = request.rfind(' ');
  if (method_end == std::string_view::npos || target_end == method_end) return response("400 Bad Request", kPlain, "bad request\n");
  const std::string_view method = request.substr(0, method_end);
  std::string_view target = request.substr(method_end + 1, target_end - method_end - 1);
  target = target.substr(0, target.find('?'));
  if (method != "GET") return response("405 Method Not Allowed", kPlain, "only GET\n");
  if (target == "/metrics") return response("200 OK", "text/plain; version=0.0.4; charset=utf-8", pages.metrics());
  if (target == "/healthz") return response("200 OK", kPlain, "ok\n");
  if (target == "/readyz") {
    // Not 503: a balancer would take the server for dead and part it from the viewers it has. 404 is what HAProxy's disable-on-404 takes
    // for "no more, please".
    const std::string reason = pages.why_not_ready();
    return reason.empty() ? response("200 OK", kPlain, "ready\n") : response("404 Not Found", kPlain, reason + "\n");
  }
  return response("404 Not Found", kPlain, "there are /metrics, /healthz and /readyz\n");
}

struct AdminServer::State {
  explicit State(AdminPages admin_pages) : pages(std::move(admin_pages)), acceptor(context) {}
  AdminPages pages;
  asio::io_context context{1};
  tcp::acceptor acceptor;
  Endpoint endpoint;
  std::thread thread;

  static asio::awaitable<void> accept(State* state) {
    asio::error_code error;
    asio::steady_timer pause(state->context);
    while (state->acceptor.is_open()) {
      tcp::socket socket = co_await state->acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
      if (!error) {
        auto visit = std::make_shared<Visit>(std::move(socket));
        asio::co_spawn(state->context, answer(std::move(visit), &state->pages), asio::detached);
      } else if (error != asio::error::operation_aborted) {
        pause.expires_after(std::chrono::milliseconds(100));
        co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
      }
    }
  }
};

AdminServer::AdminServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

Result<std::unique_ptr<AdminServer>> AdminServer::start(const Endpoint& listen, AdminPages pages) {
  auto state = std::make_unique<State>(std::move(pages));
  Result<tcp::acceptor> acceptor = listen_at(state->context.get_executor(), listen);
  if (!acceptor) return fail_within("--admin", acceptor.error());
  state->acceptor = std::move(*acceptor);
  const tcp::endpoint local = state->acceptor.local_endpoint();
  state->endpoint = Endpoint{local.address().to_string(), local.port()};
  asio::co_spawn(state->context, State::accept(state.get()), asio::detached);
  state->thread = std::thread([raw = state.get()] { raw->context.run(); });
  return std::unique_ptr<AdminServer>(new AdminServer(std::move(state)));
}

AdminServer::~AdminServer() {
  state_->context.stop();
  state_->thread.join();
}

Endpoint AdminServer::endpoint() const { return state_->endpoint; }

}  // namespace farfield
