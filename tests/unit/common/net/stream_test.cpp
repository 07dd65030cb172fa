// SPDX-License-Identifier: Apache-2.0
// Connections inside TLS over real sockets, and certificates that must not be accepted.
#include "common/net/stream.h"

#include <gtest/gtest.h>

#include <asio/co_spawn.hpp>
#include <asio/detached.hpp>
#include <asio/write.hpp>
#include <fstream>
#include <numeric>

#include "common/net/connection.h"
#include "tests/unit/common/net/loopback.h"
#include "tests/unit/common/net/test_certificate.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;
using test::CertificateFolder;
using test::run_until;

class TlsTest : public ::testing::Test {
 protected:
  /// Both ends' handshakes; the streams stay for what comes after.
  void shake(TlsTrust trust) {
    auto server = TlsServer::load(folder.files());
    ASSERT_TRUE(server) << server.error().message;
    const auto client = TlsClient::make(std::move(trust));
    ASSERT_TRUE(client) << client.error().message;
    shake(**server, **client);
  }
  void shake(const TlsServer& server, const TlsClient& client) {
    auto sockets = test::connected_sockets(context);
    near = std::make_shared<Stream>(*client.wrap(std::move(sockets.first)));
    far = std::make_shared<Stream>(server.wrap(std::move(sockets.second)));
    near_status.reset(), far_status.reset();
    asio::co_spawn(context, shake_hands(near, false, 5s), [this](std::exception_ptr, Status status) { near_status = status; });
    asio::co_spawn(context, shake_hands(far, true, 5s), [this](std::exception_ptr, Status status) { far_status = status; });
    ASSERT_TRUE(run_until(context, [&] { return near_status && far_status; }));
  }
  void expect_refused(TlsTrust trust, const std::string& reason) {
    shake(std::move(trust));
    ASSERT_TRUE(near_status && !*near_status);
    EXPECT_EQ(near_status->error().code, ErrorCode::kUnauthenticated);
    EXPECT_NE(near_status->error().message.find(reason), std::string::npos) << near_status->error().message;
    EXPECT_FALSE(near->socket().is_open());
  }

  CertificateFolder folder;
  asio::io_context context;
  std::shared_ptr<Stream> near, far;
  std::optional<Status> near_status, far_status;
};

TEST_F(TlsTest, FramesTravelBothWays) {
  shake({"localhost", folder.ca(), true});
  ASSERT_TRUE(*near_status && *far_status);
  test::Observer near_seen, far_seen;
  ConnectionOptions options;
  options.outbox_bytes = std::size_t{16} << 20;
  options.receive_limits = kFromServerLimits;
  const auto client = Connection::create(near, options), server = Connection::create(far, options);
  client->start(near_seen.events());
  server->start(far_seen.events());
  auto payload = std::make_shared<Bytes>(3'000'000);
  std::iota(payload->begin(), payload->end(), std::uint8_t{0});
  for (int i = 0; i < 3; ++i) {
    OutgoingFrame frame = make_frame(MessageType::kTilePayload, Bytes{1, 2, 3}, payload);
    ASSERT_TRUE(server->send(std::move(frame), Lane::kPayload));
    client->send(make_frame(MessageType::kPose, Bytes(20, 7)));
  }
  ASSERT_TRUE(run_until(context, [&] { return near_seen.frames.size() == 3 && far_seen.frames.size() == 3; }));
  for (const IncomingFrame& frame : near_seen.frames) EXPECT_EQ(*frame.payload, *payload);
  // An orderly end is told from a cut.
  server->close_after_flush({ErrorCode::kCancelled, "over"});
  ASSERT_TRUE(run_until(context, [&] { return near_seen.closings.size() == 1 && far_seen.closings.size() == 1; }));
  EXPECT_EQ(near_seen.closings[0].code, ErrorCode::kUnavailable) << near_seen.closings[0].message;
}

TEST_F(TlsTest, ACutIsNoOrderlyEnd) {
  shake({"localhost", folder.ca(), true});
  ASSERT_TRUE(*near_status && *far_status);
  test::Observer near_seen;
  const auto client = Connection::create(near, {});
  client->start(near_seen.events());
  asio::error_code ignored;
  far->socket().close(ignored);
  ASSERT_TRUE(run_until(context, [&] { return near_seen.closings.size() == 1; }));
  EXPECT_EQ(near_seen.closings[0].code, ErrorCode::kIo) << near_seen.closings[0].message;
}

TEST_F(TlsTest, AnAddressIsVerifiedAsOne) {
  shake({"127.0.0.1", folder.ca(), true});
  EXPECT_TRUE(*near_status && *far_status);
}

TEST_F(TlsTest, AnotherHostsCertificateIsRefused) { expect_refused({"elsewhere.example", folder.ca(), true}, "hostname mismatch"); }
TEST_F(TlsTest, AnotherAddressesCertificateIsRefused) { expect_refused({"127.0.0.2", folder.ca(), true}, "IP address mismatch"); }
TEST_F(TlsTest, AnUnknownAuthorityIsRefused) { expect_refused({"localhost", CertificateFolder().ca(), true}, "certificate"); }
TEST_F(TlsTest, TheSystemsAuthoritiesDoNotVouchForATest) { expect_refused({"localhost", "", true}, "certificate"); }
TEST_F(TlsTest, AnExpiredCertificateIsRefused) {
  folder.renew("DNS:localhost", -3600);
  expect_refused({"localhost", folder.ca(), true}, "expired");
}
TEST_F(TlsTest, NothingIsVerifiedOnlyWhenSaid) {
  shake({"elsewhere.example", "", false});
  EXPECT_TRUE(*near_status && *far_status);
}

TEST_F(TlsTest, ReloadedFilesServeNewConnections) {
  auto server = TlsServer::load(folder.files());
  ASSERT_TRUE(server);
  const auto client = TlsClient::make({"new.example", folder.ca(), true});
  shake(**server, **client);
  EXPECT_FALSE(*near_status);
  folder.renew("DNS:new.example");
  ASSERT_TRUE((*server)->reload());
  shake(**server, **client);
  EXPECT_TRUE(*near_status);
  // What cannot be read leaves the server with what it has.
  std::ofstream(folder.files().key) << "no key";
  EXPECT_FALSE((*server)->reload());
  shake(**server, **client);
  EXPECT_TRUE(*near_status);
}

TEST_F(TlsTest, OldVersionsAreRefused) {
  auto server = TlsServer::load(folder.files());
  ASSERT_TRUE(server);
  auto sockets = test::connected_sockets(context);
  const auto far_end = std::make_shared<Stream>((*server)->wrap(std::move(sockets.second)));
  asio::co_spawn(context, shake_hands(far_end, true, 5s), [this](std::exception_ptr, Status status) { far_status = status; });
  // A whole hello of TLS 1.0: record, handshake, version, random, no session, one cipher of that time, no compression.
  std::string hello("\x16\x03\x01\x00\x2d\x01\x00\x00\x29\x03\x01", 11);
  hello += std::string(32, 'r') + std::string("\x00\x00\x02\x00\x2f\x01\x00", 7);
  asio::write(sockets.first, asio::buffer(hello));
  ASSERT_TRUE(run_until(context, [&] { return far_status.has_value(); }));
  ASSERT_FALSE(*far_status);
  EXPECT_NE(far_status->error().message.find("unsupported protocol"), std::string::npos) << far_status->error().message;
}

TEST_F(TlsTest, WhoSaysNothingIsNotWaitedFor) {
  auto server = TlsServer::load(folder.files());
  ASSERT_TRUE(server);
  auto sockets = test::connected_sockets(context);
  const auto far_end = std::make_shared<Stream>((*server)->wrap(std::move(sockets.second)));
  asio::co_spawn(context, shake_hands(far_end, true, 20ms), [this](std::exception_ptr, Status status) { far_status = status; });
  ASSERT_TRUE(run_until(context, [&] { return far_status.has_value(); }));
  ASSERT_FALSE(*far_status);
  EXPECT_EQ(far_status->error().code, ErrorCode::kUnavailable);
  EXPECT_FALSE(far_end->socket().is_open());
}

TEST_F(TlsTest, FilesThatDoNotFitAreRefused) {
  EXPECT_EQ(TlsServer::load({folder.folder() / "none.pem", folder.files().key}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(TlsServer::load({folder.files().key, folder.files().key}).error().code, ErrorCode::kBadData);
  const CertificateFolder other;
  EXPECT_EQ(TlsServer::load({folder.files().certificate, other.files().key}).error().code, ErrorCode::kBadData);
  EXPECT_EQ(TlsClient::make({"localhost", folder.files().key, true}).error().code, ErrorCode::kBadData);
}

}  // namespace
}  // namespace farfield
