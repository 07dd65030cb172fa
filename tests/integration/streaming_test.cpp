// SPDX-License-Identifier: Apache-2.0
// The real server with a real scene and the real client core, over loopback and over links that misbehave.
#include <gtest/gtest.h>

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/write.hpp>
#include <thread>

#include "client/session/client_core.h"
#include "common/net/link_proxy.h"
#include "common/net/message.h"
#include "proto/farfield.pb.h"
#include "server/app/build_service.h"
#include "server/session/server.h"
#include "server/store/memory_tile_store.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;
using client::ClientCore;
using client::ClientOptions;
using client::ClientState;

/// One small plant for all tests of this file: building it costs more than serving it.
class StreamingTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    ServiceOptions options;
    options.settings.face_tiles = 2;
    options.settings.delta_views = 1;
    options.settings.near_triangles = 3000;
    options.settings.finest_side_m = 4;
    options.store = std::make_shared<MemoryTileStore>(std::size_t{256} << 20);
    options.pool = std::make_shared<JobPool>(2);
    auto built = build_service({"plant", "pipes:10000:1"}, options);
    ASSERT_TRUE(built) << built.error().message;
    service_ = new std::shared_ptr<MeasuredCellService>(std::move(*built));
  }
  static void TearDownTestSuite() {
    delete service_;
    service_ = nullptr;
  }
  void SetUp() override {
    ServerOptions options;
    options.listen = {"127.0.0.1", 0};
    options.threads = 2;
    auto started = Server::start(options, {*service_});
    ASSERT_TRUE(started) << started.error().message;
    server = std::move(*started);
  }
  static ClientOptions client_of(const Endpoint& endpoint) {
    ClientOptions options;
    options.server = endpoint;
    options.form = client::DecodeForm::kSplats;
    options.decode_threads = 1;
    return options;
  }
  const glm::dvec3& start_point() const { return (*service_)->scene().start; }

  static std::shared_ptr<MeasuredCellService>* service_;
  std::unique_ptr<Server> server;
};

std::shared_ptr<MeasuredCellService>* StreamingTest::service_ = nullptr;

TEST_F(StreamingTest, AViewerGetsTheCompleteLeafSetOfTheirLeaf) {
  ClientCore core(client_of(server->endpoint()));
  core.start();
  const auto scene = core.wait_welcome(10s);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->name, "plant");
  core.set_pose({scene->start, {1, 0, 0, 0}}, 0);
  const auto view = core.wait_complete(scene->start, 60s);
  ASSERT_TRUE(view) << view.error().message;
  EXPECT_TRUE((*view)->is_complete);
  EXPECT_TRUE((*view)->leaf_box.contains(scene->start));
  EXPECT_FALSE((*view)->tiles.empty() && (*view)->chunks.empty());
  const client::ClientStatistics statistics = core.statistics();
  EXPECT_EQ(statistics.bad_payloads, 0u);
  EXPECT_EQ(statistics.redundant_payloads, 0u);
}

TEST_F(StreamingTest, AWalkThereAndBackNeverReceivesAnythingTwice) {
  ClientCore core(client_of(server->endpoint()));
  core.start();
  ASSERT_TRUE(core.wait_welcome(10s));
  double time_s = 0;
  std::uint64_t bytes_there = 0;
  for (const double step : {0.0, 3.0, 6.0, 3.0, 0.0}) {
    const glm::dvec3 eye = start_point() + glm::dvec3(step, 0, 0);
    core.set_pose({eye, {1, 0, 0, 0}}, time_s += 5);
    const auto view = core.wait_complete(eye, 60s);
    ASSERT_TRUE(view) << step << ": " << view.error().message;
    if (step > 5) bytes_there = core.statistics().bytes_in;
  }
  EXPECT_EQ(core.statistics().redundant_payloads, 0u);
  EXPECT_LT(core.statistics().bytes_in, bytes_there + 2000) << "the way back was known";
}

TEST_F(StreamingTest, StandingStillIsSilent) {
  ClientCore core(client_of(server->endpoint()));
  core.start();
  ASSERT_TRUE(core.wait_welcome(10s));
  core.set_pose({start_point(), {1, 0, 0, 0}}, 0);
  ASSERT_TRUE(core.wait_complete(start_point(), 60s));
  std::this_thread::sleep_for(100ms);
  const std::uint64_t bytes = server->metrics().traffic->bytes_out;
  for (int i = 0; i < 30; ++i) {
    core.set_pose({start_point(), {1, 0, 0, 0}}, 1 + i / 60.0);
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(server->metrics().traffic->bytes_out, bytes);
}

TEST_F(StreamingTest, ACutIsSurvivedWithoutSendingTheSameAgain) {
  auto proxy = LinkProxy::start(server->endpoint(), {});
  ASSERT_TRUE(proxy) << proxy.error().message;
  ClientCore core(client_of((*proxy)->endpoint()));
  core.start();
  ASSERT_TRUE(core.wait_welcome(10s));
  core.set_pose({start_point(), {1, 0, 0, 0}}, 0);
  ASSERT_TRUE(core.wait_complete(start_point(), 60s));
  (*proxy)->cut();
  for (int i = 0; i < 500 && core.statistics().reconnects == 0; ++i) std::this_thread::sleep_for(20ms);
  EXPECT_EQ(core.statistics().reconnects, 1u);
  EXPECT_TRUE(core.view()) << "the picture stays";
  const glm::dvec3 eye = start_point() + glm::dvec3(3, 0, 0);
  core.set_pose({eye, {1, 0, 0, 0}}, 10);
  ASSERT_TRUE(core.wait_complete(eye, 60s));
  EXPECT_EQ(core.statistics().redundant_payloads, 0u);
  EXPECT_EQ(server->metrics().resumed_sessions, 1u);
}

TEST_F(StreamingTest, ACutInMidWalkCostsNoFrame) {
  auto proxy = LinkProxy::start(server->endpoint(), {});
  ASSERT_TRUE(proxy) << proxy.error().message;
  ClientCore core(client_of((*proxy)->endpoint()));
  core.start();
  ASSERT_TRUE(core.wait_welcome(10s));
  core.set_pose({start_point(), {1, 0, 0, 0}}, 0);
  ASSERT_TRUE(core.wait_complete(start_point(), 60s));
  // A walk at 2 m/s, the network down for half a second in the middle of it; a frame is what the client core asks of
  // the loop that draws.
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  double slowest_ms = 0;
  bool was_cut = false, is_back = false;
  glm::dvec3 eye{0};
  for (double t = 0; t < 2; t = std::chrono::duration<double>(Clock::now() - start).count()) {
    if (t > 0.5 && !was_cut) {
      (*proxy)->set_refusing(true);
      (*proxy)->cut();
      was_cut = true;
    }
    if (t > 1.0 && !is_back) {
      (*proxy)->set_refusing(false);
      is_back = true;
    }
    const auto frame = Clock::now();
    eye = start_point() + glm::dvec3(2 * t, 0, 0);
    core.set_pose({eye, {1, 0, 0, 0}}, t);
    const auto view = core.view();
    ASSERT_TRUE(view) << "never a blank";
    core.count_frame(view.get(), eye);
    slowest_ms = std::max(slowest_ms, std::chrono::duration<double, std::milli>(Clock::now() - frame).count());
    std::this_thread::sleep_for(8ms);
  }
  // Two frames of a 60 Hz display: far above a copied pointer, far below anything that waits for the network.
  EXPECT_LT(slowest_ms, 33);
  const auto view = core.wait_complete(eye, 60s);
  ASSERT_TRUE(view) << view.error().message;
  EXPECT_EQ(core.statistics().reconnects, 1u);
  EXPECT_EQ(core.statistics().redundant_payloads, 0u);
}

TEST_F(StreamingTest, ALossySlowLinkDelaysButBreaksNothing) {
  auto proxy = LinkProxy::start(server->endpoint(), *parse_link_model("rate=40mbit,delay=10ms,jitter=5ms,loss=0.5%"));
  ASSERT_TRUE(proxy);
  ClientCore core(client_of((*proxy)->endpoint()));
  core.start();
  ASSERT_TRUE(core.wait_welcome(10s));
  core.set_pose({start_point(), {1, 0, 0, 0}}, 0);
  const auto view = core.wait_complete(start_point(), 60s);
  ASSERT_TRUE(view) << view.error().message;
  EXPECT_EQ(core.statistics().bad_payloads, 0u);
}

TEST_F(StreamingTest, HostileNeighboursDoNotDisturbAViewer) {
  ClientCore core(client_of(server->endpoint()));
  core.start();
  ASSERT_TRUE(core.wait_welcome(10s));
  // One sends garbage, one half a frame and stays, one asks for everything and never reads.
  asio::io_context context;
  std::vector<asio::ip::tcp::socket> hostile;
  for (int i = 0; i < 3; ++i) {
    hostile.emplace_back(context);
    hostile.back().connect({asio::ip::make_address("127.0.0.1"), server->endpoint().port});
  }
  asio::error_code ignored;
  asio::write(hostile[0], asio::buffer(Bytes(50000, 0xaa)), ignored);
  wire::Hello hello;
  hello.set_version_min(1);
  hello.set_version_max(1);
  const OutgoingFrame frame = make_message(MessageType::kHello, hello);
  asio::write(hostile[1], asio::buffer(frame.head.data(), frame.head.size() - 1), ignored);
  asio::write(hostile[2], asio::buffer(frame.head), ignored);
  core.set_pose({start_point(), {1, 0, 0, 0}}, 0);
  const auto view = core.wait_complete(start_point(), 60s);
  EXPECT_TRUE(view) << view.error().message;
  EXPECT_EQ(core.status().state, ClientState::kStreaming);
}

TEST_F(StreamingTest, AnUnknownSceneIsAFinalFailureInOneLine) {
  ClientOptions options = client_of(server->endpoint());
  options.scene = "elsewhere";
  ClientCore core(options);
  core.start();
  const auto scene = core.wait_welcome(10s);
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("plant"), std::string::npos) << scene.error().message;
}

}  // namespace
}  // namespace farfield
