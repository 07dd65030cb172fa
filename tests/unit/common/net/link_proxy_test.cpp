// SPDX-License-Identifier: Apache-2.0
// The proxy in generous real time: not faster than the model, not much slower, order kept, memory bounded.
#include "common/net/link_proxy.h"

#include <gtest/gtest.h>

#include <asio/connect.hpp>
#include <asio/io_context.hpp>
#include <asio/read.hpp>
#include <asio/write.hpp>
#include <thread>

#include "common/base/bytes.h"
#include "common/net/connect.h"

namespace farfield {
namespace {

using asio::ip::tcp;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class LinkProxyTest : public ::testing::Test {
 protected:
  void connect(const std::string& link) {
    acceptor = std::make_unique<tcp::acceptor>(context, tcp::endpoint(asio::ip::address_v4::loopback(), 0));
    auto started = LinkProxy::start({"127.0.0.1", acceptor->local_endpoint().port()}, *parse_link_model(link));
    ASSERT_TRUE(started) << started.error().message;
    proxy = std::move(*started);
    reconnect();
  }
  void reconnect() {
    client = std::make_unique<tcp::socket>(context);
    client->connect({asio::ip::address_v4::loopback(), proxy->endpoint().port});
    server = std::make_unique<tcp::socket>(context);
    acceptor->accept(*server);
  }

  asio::io_context context;
  std::unique_ptr<tcp::acceptor> acceptor;
  std::unique_ptr<LinkProxy> proxy;
  std::unique_ptr<tcp::socket> client, server;
};

TEST_F(LinkProxyTest, KeepsEveryByteInOrderBothWays) {
  connect("rate=400mbit,delay=2ms,jitter=3ms,loss=1%");
  Bytes sent(1 << 20);
  for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = static_cast<std::uint8_t>(i * 31 + (i >> 9));
  std::thread writer([&] { asio::write(*server, asio::buffer(sent)); });
  asio::write(*client, asio::buffer(sent.data(), 1000));
  Bytes down(sent.size()), up(1000);
  asio::read(*client, asio::buffer(down));
  asio::read(*server, asio::buffer(up));
  writer.join();
  EXPECT_EQ(down, sent);
  EXPECT_TRUE(std::equal(up.begin(), up.end(), sent.begin()));
}

TEST_F(LinkProxyTest, DelaysByTheStatedTime) {
  connect("delay=40ms");
  char byte = 1;
  const auto start = Clock::now();
  asio::write(*client, asio::buffer(&byte, 1));
  asio::read(*server, asio::buffer(&byte, 1));
  asio::write(*server, asio::buffer(&byte, 1));
  asio::read(*client, asio::buffer(&byte, 1));
  EXPECT_GE(seconds_since(start), 0.08);
  EXPECT_LT(seconds_since(start), 0.5);
}

TEST_F(LinkProxyTest, PassesNoMoreThanItsRate) {
  connect("rate=16mbit");
  const Bytes bytes(500000);
  Bytes received(bytes.size());
  std::thread writer([&] { asio::write(*server, asio::buffer(bytes)); });
  const auto start = Clock::now();
  asio::read(*client, asio::buffer(received));
  writer.join();
  EXPECT_GE(seconds_since(start), 0.24);  // 0.25 s at 16 Mbit/s, less what entered before the clock started
  EXPECT_LT(seconds_since(start), 1.0);
  EXPECT_EQ(proxy->bytes_to_clients(), 500000u);
}

TEST_F(LinkProxyTest, ASenderFeelsTheSlowLink) {
  connect("rate=1mbit,delay=10ms");
  server->non_blocking(true);
  const Bytes piece(16384);
  std::size_t accepted = 0;
  const auto start = Clock::now();
  while (seconds_since(start) < 0.3) {
    asio::error_code error;
    accepted += server->write_some(asio::buffer(piece), error);
    if (error) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  // 0.3 s at 1 Mbit/s is 38 kB; the rest is what kernels buffer on loopback, not what the proxy hoards.
  EXPECT_LT(accepted, std::size_t{6} << 20);
}

TEST_F(LinkProxyTest, CutBreaksConnectionsAndLaterOnesWork) {
  connect("delay=1ms");
  proxy->cut();
  char byte = 0;
  asio::error_code error;
  asio::read(*client, asio::buffer(&byte, 1), error);
  EXPECT_TRUE(error);
  reconnect();
  asio::write(*client, asio::buffer("z", 1));
  asio::read(*server, asio::buffer(&byte, 1));
  EXPECT_EQ(byte, 'z');
}

TEST_F(LinkProxyTest, ConnectionsBreakAtRandomMomentsOfTheStatedMean) {
  connect("cut=50ms");
  constexpr int kBreaks = 60;
  const auto start = Clock::now();
  for (int k = 0; k < kBreaks; ++k) {
    char byte = 0;
    asio::error_code error;
    asio::read(*client, asio::buffer(&byte, 1), error);
    EXPECT_TRUE(error) << "nobody sent anything";
    reconnect();
  }
  // The mean of 60 exponential times has an eighth as its standard deviation: four of them either way, and the machine's delays.
  EXPECT_GE(seconds_since(start), 0.5 * kBreaks * 0.05);
  EXPECT_LE(seconds_since(start), 1.5 * kBreaks * 0.05 + 2);
}

TEST_F(LinkProxyTest, AnOrderlyEndPassesThrough) {
  connect("delay=5ms");
  asio::write(*server, asio::buffer("end", 3));
  server->close();
  Bytes read(10);
  asio::error_code error;
  const std::size_t size = asio::read(*client, asio::buffer(read), error);
  EXPECT_EQ(size, 3u);
  EXPECT_EQ(error, asio::error::eof);
}

}  // namespace
}  // namespace farfield
