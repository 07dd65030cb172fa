// SPDX-License-Identifier: Apache-2.0
// Who may come in: TLS, tokens and rates, against a server on real sockets.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <mutex>

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

// ── tokens ──

class TokenTest : public SecurityTest {
 protected:
  ~TokenTest() override { server.reset(); }  // it logs here
  ServerOptions asking(ServerLimits limits = {}) {
    write_tokens({{digest_of("alice's"), "alice", Role::kViewer, now() + 1h}});
    ServerOptions options;
    options.listen = Endpoint{"127.0.0.1", 0};
    options.limits = limits;
    options.limits.ping_after = 200ms;  // sessions are looked at four times as often
    tokens = *TokenRegister::load(file, [this] { return now(); });
    options.tokens = tokens;
    options.log = [this](const std::string& line) {
      const std::lock_guard lock(log_mutex);
      log += line + "\n";
    };
    return options;
  }
  void write_tokens(const std::vector<TokenEntry>& entries) const {
    std::ofstream out(file);
    for (const TokenEntry& entry : entries) out << format_token(entry);
  }
  WallTime now() const { return WallTime(std::chrono::seconds(seconds.load())); }
  static wire::Hello hello(const std::string& token, const std::string& scene = "") {
    wire::Hello hello = TestClient::hello(scene);
    hello.set_access_token(token);
    return hello;
  }
  /// Whatever a client was sent holds nothing of the scene. Returns: the refusal.
  std::string expect_refused(const wire::Hello& hello) {
    TestClient client(server->endpoint());
    EXPECT_FALSE(client.enter(hello));
    EXPECT_TRUE(client.wait([&] { return client.closed.has_value(); }));
    EXPECT_EQ(client.payloads(), 0u);
    EXPECT_TRUE(client.failure) << "no word of refusal";
    if (!client.failure) return "";
    EXPECT_EQ(static_cast<ErrorCode>(client.failure->code()), ErrorCode::kUnauthenticated);
    EXPECT_EQ(client.failure->message().find("plant"), std::string::npos);
    return client.failure->message();
  }

  const std::filesystem::path file = certificates.folder() / "tokens";
  std::atomic<std::int64_t> seconds{1'800'000'000};
  std::shared_ptr<TokenRegister> tokens;
  std::mutex log_mutex;
  std::string log;
};

TEST_F(TokenTest, AValidTokenWalksAndEverybodyElseHearsTheSameWord) {
  serve(asking());
  {
    TestClient client(server->endpoint());
    ASSERT_TRUE(client.enter(hello("alice's")));
    client.move_to({1, 1, 1});
    EXPECT_TRUE(client.wait_complete(1));
  }
  const std::string missing = expect_refused(TestClient::hello());
  EXPECT_EQ(expect_refused(hello("mallory's")), missing);
  // Not even whether a scene exists is told.
  EXPECT_EQ(expect_refused(hello("mallory's", "no-such-scene")), missing);
  seconds += 3600;
  EXPECT_EQ(expect_refused(hello("alice's")), missing);
  EXPECT_EQ(server->metrics().refused_tokens.load(), 4u);
  const std::lock_guard lock(log_mutex);
  EXPECT_EQ(log.find("alice's"), std::string::npos) << log;
  EXPECT_EQ(log.find("mallory's"), std::string::npos) << log;
}

TEST_F(TokenTest, ASessionEndsWithItsToken) {
  serve(asking());
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter(hello("alice's")));
  client.idle(150ms);
  EXPECT_FALSE(client.closed);
  seconds += 3600;
  ASSERT_TRUE(client.wait([&] { return client.closed.has_value(); }));
  ASSERT_TRUE(client.failure);
  EXPECT_EQ(client.failure->message(), access_refused().message);
}

TEST_F(TokenTest, ASessionEndsWhenItsTokenIsRevoked) {
  serve(asking());
  TestClient client(server->endpoint());
  ASSERT_TRUE(client.enter(hello("alice's")));
  write_tokens({});
  ASSERT_TRUE(tokens->reload());
  ASSERT_TRUE(client.wait([&] { return client.closed.has_value(); }));
  EXPECT_TRUE(client.failure);
}

TEST_F(TokenTest, NothingElseIsAnsweredBeforeTheToken) {
  serve(asking());
  TestClient client(server->endpoint());
  client.move_to({1, 1, 1});
  ASSERT_TRUE(client.wait([&] { return client.closed.has_value(); }));
  EXPECT_FALSE(client.welcome);
  EXPECT_EQ(client.payloads(), 0u);
}

TEST_F(TokenTest, AnothersSessionIsNotResumed) {
  serve(asking());
  write_tokens({{digest_of("alice's"), "alice", Role::kViewer, now() + 1h}, {digest_of("bob's"), "bob", Role::kViewer, now() + 1h}});
  ASSERT_TRUE(tokens->reload());
  wire::Hello again = hello("bob's");
  {
    TestClient alice(server->endpoint());
    ASSERT_TRUE(alice.enter(hello("alice's")));
    again.set_resume_token(alice.welcome->resume_token());
  }
  TestClient bob(server->endpoint());
  ASSERT_TRUE(bob.enter(again));
  EXPECT_FALSE(bob.welcome->resumed());
}

// ── rates ──

TEST_F(TokenTest, GuessingClosesTheDoorForTheAddress) {
  ServerLimits limits;
  limits.limits_loopback = true;
  limits.per_address.failure_burst = 3;
  limits.per_address.failures_per_second = 0.01;
  serve(asking(limits));
  for (int i = 0; i < 3; ++i) expect_refused(hello("guess"));
  TestClient client(server->endpoint());
  EXPECT_FALSE(client.enter(hello("alice's")));
  ASSERT_TRUE(client.wait([&] { return client.closed.has_value(); }));
  ASSERT_TRUE(client.go_away);
  EXPECT_GT(client.go_away->retry_after_ms(), 1000u);
}

TEST_F(TokenTest, OneTokenHasItsShareOfSessions) {
  ServerLimits limits;
  limits.per_token.connections = 1;
  serve(asking(limits));
  TestClient first(server->endpoint());
  ASSERT_TRUE(first.enter(hello("alice's")));
  {
    TestClient second(server->endpoint());
    EXPECT_FALSE(second.enter(hello("alice's")));
    ASSERT_TRUE(second.wait([&] { return second.closed.has_value(); }));
    ASSERT_TRUE(second.go_away);
    EXPECT_GT(second.go_away->retry_after_ms(), 0u);
  }
  first.cut();
  first.idle(20ms);
  TestClient third(server->endpoint());
  EXPECT_TRUE(third.enter(hello("alice's")));
}

TEST_F(SecurityTest, AnAddressHasItsShareOfConnections) {
  ServerOptions options;
  options.listen = Endpoint{"127.0.0.1", 0};
  options.limits.limits_loopback = true;
  options.limits.per_address.connections = 2;
  serve(std::move(options));
  TestClient first(server->endpoint()), second(server->endpoint());
  ASSERT_TRUE(first.enter() && second.enter());
  TestClient third(server->endpoint());
  EXPECT_FALSE(third.enter());
  ASSERT_TRUE(third.wait([&] { return third.closed.has_value(); }));
  ASSERT_TRUE(third.go_away);
  EXPECT_GT(third.go_away->retry_after_ms(), 0u);
}

}  // namespace
}  // namespace farfield
