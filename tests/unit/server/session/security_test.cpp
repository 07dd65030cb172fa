// SPDX-License-Identifier: Apache-2.0
// Who may come in: TLS, tokens and rates, against a server on real sockets.
#include <gtest/gtest.h>

#include <asio/read.hpp>
#include <asio/write.hpp>

#include "server/session/server.h"
#include "tests/unit/common/net/test_certificate.h"
#include "tests/unit/server/session/fake_cell_service.h"
#include "tests/unit/server/session/test_client.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;
using test::CertificateFolder;
using test::FakeCellService;
using test::FakeWorld;
using test::TestClient;

class SecurityTest : public ::testing::Test {
 protected:
  void serve(ServerOptions options) {
    FakeWorld world;
    world.name = "secret-plant";
    options.threads = 2;
    auto started = Server::start(std::move(options), {std::make_shared<FakeCellService>(world)});
    ASSERT_TRUE(started) << started.error().message;
    server = std::move(*started);
  }
  ServerOptions tls_only() {
    ServerOptions options;
    options.listen.reset();
    options.tls_listen = Endpoint{"127.0.0.1", 0};
    options.tls = *TlsServer::load(certificates.files());
    return options;
  }

  CertificateFolder certificates;
  std::unique_ptr<Server> server;
};

TEST_F(SecurityTest, AViewerWalksThroughTls) {
  serve(tls_only());
  const auto trust = TlsClient::make({"localhost", certificates.ca(), true});
  ASSERT_TRUE(trust);
  TestClient client(*server->tls_endpoint(), trust->get());
  ASSERT_TRUE(client.enter());
  client.move_to({1, 1, 1});
  EXPECT_TRUE(client.wait_complete(1));
  EXPECT_GT(client.payloads(), 0u);
}

TEST_F(SecurityTest, PlainBytesAtTheTlsDoorGetNoAnswerInClear) {
  serve(tls_only());
  TestClient client(*server->tls_endpoint());
  EXPECT_FALSE(client.enter());
  EXPECT_FALSE(client.failure);
  EXPECT_EQ(server->metrics().failed_handshakes.load(), 1u);
}

TEST_F(SecurityTest, HandshakesThatStallTakeNoPlaceForLong) {
  ServerOptions options = tls_only();
  options.limits.handshake_timeout = 100ms;
  options.limits.handshakes = 2;
  serve(std::move(options));
  TestClient first(*server->tls_endpoint()), second(*server->tls_endpoint());
  // There is no room for a third; it is closed at once.
  TestClient third(*server->tls_endpoint());
  EXPECT_TRUE(third.wait([&] { return third.closed.has_value(); }));
  EXPECT_TRUE(first.wait([&] { return first.closed.has_value(); }));
  EXPECT_TRUE(second.wait([&] { return second.closed.has_value(); }));
  const auto trust = TlsClient::make({"localhost", certificates.ca(), true});
  TestClient late(*server->tls_endpoint(), trust->get());
  EXPECT_TRUE(late.enter());
}

TEST_F(SecurityTest, StopsWhileHandshakesAreUnderWay) {
  ServerOptions options = tls_only();
  options.limits.handshake_timeout = 60s;
  serve(std::move(options));
  TestClient waiting(*server->tls_endpoint());
  waiting.idle(20ms);
  server.reset();
  EXPECT_TRUE(waiting.wait([&] { return waiting.closed.has_value(); }));
}

}  // namespace
}  // namespace farfield
