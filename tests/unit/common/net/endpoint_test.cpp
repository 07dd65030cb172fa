// SPDX-License-Identifier: Apache-2.0
#include "common/net/endpoint.h"

#include <gtest/gtest.h>

#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>

#include "common/net/connect.h"
#include "tests/unit/common/net/loopback.h"

namespace farfield {
namespace {

TEST(Endpoint, ReadsHostAndPort) {
  for (const auto& [text, host, port] : std::vector<std::tuple<std::string, std::string, int>>{
           {"example.org:1234", "example.org", 1234},
           {"10.0.0.1", "10.0.0.1", 7400},
           {":0", "127.0.0.1", 0},
           {"[::1]:80", "::1", 80},
           {"[::1]", "::1", 7400},
           {"::1", "::1", 7400}}) {
    const auto endpoint = parse_endpoint(text);
    ASSERT_TRUE(endpoint) << text << ": " << endpoint.error().message;
    EXPECT_EQ(endpoint->host, host) << text;
    EXPECT_EQ(endpoint->port, port) << text;
  }
}

TEST(Endpoint, RefusesWhatIsNone) {
  for (const char* text : {"", "host:", "host:abc", "host:65536", "host:-1", "host:80x", "[::1", "[::1]80"}) {
    const auto endpoint = parse_endpoint(text);
    ASSERT_FALSE(endpoint) << text;
    EXPECT_EQ(endpoint.error().code, ErrorCode::kInvalidArgument);
  }
}

TEST(Endpoint, PrintsWhatItReads) {
  for (const char* text : {"example.org:1234", "[::1]:80"}) EXPECT_EQ(to_string(*parse_endpoint(text)), text);
}

TEST(Listen, APortInUseIsOneClearLine) {
  asio::io_context context;
  const auto first = listen_at(context.get_executor(), {"127.0.0.1", 0});
  ASSERT_TRUE(first) << first.error().message;
  const auto port = first->local_endpoint().port();
  const auto second = listen_at(context.get_executor(), {"127.0.0.1", port});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kUnavailable);
  EXPECT_NE(second.error().message.find(std::to_string(port)), std::string::npos);
}

asio::awaitable<void> try_connecting(asio::any_io_executor executor, Endpoint endpoint, ErrorCode* code, bool* done) {
  const std::chrono::milliseconds timeout(500);
  const auto socket = co_await connect_to(executor, endpoint, timeout);
  if (!socket) *code = socket.error().code;
  *done = true;
}

TEST(Connect, NobodyThereIsUnavailable) {
  asio::io_context context;
  std::uint16_t free_port = 0;
  {
    const auto acceptor = listen_at(context.get_executor(), {"127.0.0.1", 0});
    ASSERT_TRUE(acceptor);
    free_port = acceptor->local_endpoint().port();
  }
  ErrorCode code = ErrorCode::kInternal;
  bool done = false;
  asio::co_spawn(context, try_connecting(context.get_executor(), {"127.0.0.1", free_port}, &code, &done), asio::detached);
  ASSERT_TRUE(test::run_until(context, [&] { return done; }));
  EXPECT_EQ(code, ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace farfield
