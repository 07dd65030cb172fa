// SPDX-License-Identifier: Apache-2.0
// The client core against a scripted server over a real loopback socket.
#include "client/session/client_core.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "tests/unit/client/session/fake_server.h"
#include "tests/unit/client/store/made_leaf_sets.h"

namespace farfield::client {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;
using namespace std::chrono_literals;

/// A tiny tile for any bytes but 0xff.
Result<Tile> decode_tiny(ByteView bytes) {
  if (bytes[0] == 0xff) return fail(ErrorCode::kBadData, "not a tile");
  return made::tiny_tile(made::leaf_at(0));
}

class ClientCoreTest : public ::testing::Test {
 protected:
  ClientOptions options() {
    ClientOptions options;
    options.server = server.endpoint();
    options.scene = "made up";
    options.form = DecodeForm::kSplats;
    options.decode_threads = 1;
    options.tile_decoder = decode_tiny;
    return options;
  }
  void start(const ClientOptions& with) {
    core = std::make_unique<ClientCore>(with);
    core->start();
    const auto scene = core->wait_welcome(5s);
    ASSERT_TRUE(scene) << scene.error().message;
  }
  void stand_in(int leaf) { core->set_pose({made::eye_in(leaf), {1, 0, 0, 0}}, now += 0.02); }
  /// A whole leaf set over the wire.
  void send_whole(std::uint64_t serial, int leaf, const std::vector<ContentHash>& tiles, bool is_current = true) {
    server.send_leaf_set(made::leaf_set(serial, leaf, tiles, is_current));
    for (const ContentHash key : tiles) server.send_tile(key);
    server.send_complete(serial);
  }
  bool wait_until(const std::function<bool()>& holds) {
    for (const auto until = std::chrono::steady_clock::now() + FakeServer::kPatience;
         std::chrono::steady_clock::now() < until; std::this_thread::sleep_for(1ms)) {
      if (holds()) return true;
    }
    return holds();
  }
  bool wait_state(ClientState state) {
    return wait_until([&] { return core->status().state == state; });
  }

  double now = 0;
  FakeServer server;
  std::unique_ptr<ClientCore> core;
};

TEST_F(ClientCoreTest, SaysHelloAndLearnsTheScene) {
  start(options());
  const auto hello = server.received<wire::Hello>(MessageType::kHello);
  ASSERT_EQ(hello.size(), 1u);
  EXPECT_EQ(hello[0].scene(), "made up");
  EXPECT_EQ(hello[0].version_max(), kProtocolVersionMax);
  EXPECT_EQ(hello[0].display().height(), 720u);
  EXPECT_EQ(hello[0].resume_token(), "");
  const SceneDescription scene = *core->scene();
  EXPECT_EQ(scene.origin.x, 1e6);
  const Pose world{{1e6 + 0.5, 2, 3}, {1, 0, 0, 0}};
  EXPECT_EQ(scene.scene_from_world(world).position.x, 0.5);
  EXPECT_EQ(scene.world_from_scene(scene.scene_from_world(world)).position, world.position);
  EXPECT_EQ(core->view(), nullptr);
  EXPECT_TRUE(wait_until([&] { return core->statistics().round_trip_seconds > 0; }));
}

TEST_F(ClientCoreTest, SwitchesWholeSetsAndCountsLateFrames) {
  start(options());
  stand_in(0);
  ASSERT_TRUE(server.wait_for(MessageType::kPose, 1));
  EXPECT_TRUE(server.received<wire::Pose>(MessageType::kPose)[0].wants_fallback());
  EXPECT_TRUE(core->count_frame(core->view().get(), made::eye_in(0)));
  send_whole(1, 0, {1, 2});
  const auto first = core->wait_complete(made::eye_in(0), 5s);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ((*first)->tiles.size(), 2u);
  EXPECT_EQ((*first)->background, glm::u8vec3(0));
  EXPECT_FALSE(core->count_frame(first->get(), made::eye_in(0)));

  stand_in(1);
  server.send_leaf_set(made::leaf_set(2, 1, {2, 3}));
  ASSERT_TRUE(wait_until([&] { return core->statistics().leaf_sets == 2; }));
  EXPECT_EQ(core->view()->leaf, made::leaf_at(0));
  EXPECT_TRUE(core->count_frame(core->view().get(), made::eye_in(1)));
  server.send_tile(3);
  server.send_complete(2);
  ASSERT_TRUE(core->wait_complete(made::eye_in(1), 5s));
  EXPECT_EQ(core->view()->leaf, made::leaf_at(1));

  const ClientStatistics figures = core->statistics();
  EXPECT_EQ(figures.frames, 3u);
  EXPECT_EQ(figures.late_frames, 2u);
  EXPECT_EQ(figures.tiles, 3u);
  EXPECT_EQ(figures.tile_bytes(), 3u);
  EXPECT_GE(figures.switches, 2u);
  EXPECT_GT(figures.entry_bytes, 100u);
  EXPECT_LT(figures.entry_bytes, figures.bytes_in + figures.bytes_out);
  EXPECT_EQ(figures.control_bytes + figures.tile_bytes(), figures.bytes_in);
}

TEST_F(ClientCoreTest, APrefetchedSetIsShownWithoutAskingTheServer) {
  start(options());
  stand_in(0);
  send_whole(1, 0, {1});
  send_whole(2, 1, {2}, /*is_current=*/false);
  ASSERT_TRUE(core->wait_complete(made::eye_in(0), 5s));
  ASSERT_TRUE(wait_until([&] { return core->statistics().store_items == 2; }));
  server.cut();
  ASSERT_TRUE(wait_state(ClientState::kReconnecting));
  stand_in(1);
  EXPECT_TRUE(core->wait_complete(made::eye_in(1), 5s));
}

TEST_F(ClientCoreTest, StandingStillIsSilent) {
  start(options());
  stand_in(0);
  // The pose, and one more that says the movement has ended.
  ASSERT_TRUE(server.wait_for(MessageType::kPose, 2));
  for (int i = 0; i < 40; ++i) {
    stand_in(0);
    std::this_thread::sleep_for(5ms);
  }
  EXPECT_EQ(server.received<wire::Pose>(MessageType::kPose).size(), 2u);
}

TEST_F(ClientCoreTest, PosesArriveInTheWordsOfTheWire) {
  start(options());
  core->set_pose({{5.25, 0.5, -3.125}, glm::angleAxis(0.5, glm::dvec3(0, 1, 0))}, 12.5);
  ASSERT_TRUE(server.wait_for(MessageType::kPose, 1));
  const wire::Pose pose = server.received<wire::Pose>(MessageType::kPose)[0];
  const CellId cell{static_cast<std::uint8_t>(pose.cell().level()), pose.cell().x(), pose.cell().y(), pose.cell().z()};
  const glm::dvec3 position = made::frame().grid.box(cell).center() + glm::dvec3(pose.dx(), pose.dy(), pose.dz());
  EXPECT_LT(glm::distance(position, glm::dvec3(5.25, 0.5, -3.125)), 1e-6);
  EXPECT_NEAR(pose.qy(), std::sin(0.25), 1e-6);
  EXPECT_EQ(pose.time_s(), 12.5);
  core->set_pose({{std::nan(""), 0, 0}, {1, 0, 0, 0}}, 13);  // no crash, nothing sent for it
  core->set_pose({{6.25, 0.5, -3.125}, {1, 0, 0, 0}}, 14);
  ASSERT_TRUE(server.wait_for(MessageType::kPose, 2));
  EXPECT_EQ(server.received<wire::Pose>(MessageType::kPose)[1].time_s(), 14);
}

TEST_F(ClientCoreTest, ACutIsSurvivedWithTokenAndHeldPayloads) {
  start(options());
  stand_in(0);
  send_whole(1, 0, {1, 2});
  ASSERT_TRUE(core->wait_complete(made::eye_in(0), 5s));
  ASSERT_TRUE(server.wait_for(MessageType::kPose, 2));  // with the one that ends the movement
  server.cut();
  ASSERT_TRUE(server.wait_for(MessageType::kHello, 2));
  EXPECT_NE(core->view(), nullptr) << "the picture stays";
  const wire::Hello again = server.received<wire::Hello>(MessageType::kHello)[1];
  EXPECT_EQ(again.resume_token(), "token-1");
  EXPECT_THAT(again.held(), UnorderedElementsAre(1, 2));
  ASSERT_TRUE(wait_state(ClientState::kStreaming));
  EXPECT_EQ(core->statistics().reconnects, 1u);
  EXPECT_TRUE(server.wait_for(MessageType::kPose, 3)) << "the server is told where the eye is";
  server.send_leaf_set(made::leaf_set(2, 0, {1, 2}));
  server.send_complete(2);
  EXPECT_TRUE(core->wait_complete(made::eye_in(0), 5s));
  EXPECT_EQ(core->statistics().tiles, 2u) << "nothing was sent twice";
}

TEST_F(ClientCoreTest, GoAwayIsHonoured) {
  start(options());
  wire::GoAway away;
  away.set_reason("draining");
  away.set_resume_token("token-2");
  away.set_retry_after_ms(150);
  server.send(make_message(MessageType::kGoAway, away));
  ASSERT_TRUE(wait_state(ClientState::kReconnecting));
  EXPECT_THAT(core->status().error.message, HasSubstr("draining"));
  server.cut();
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(server.wait_for(MessageType::kHello, 2));
  EXPECT_GE(std::chrono::steady_clock::now() - start, 150ms);
  EXPECT_EQ(server.received<wire::Hello>(MessageType::kHello)[1].resume_token(), "token-2");
}

TEST_F(ClientCoreTest, GarbageInsteadOfAWelcomeIsOneClearFinalError) {
  server.answer_hello_with(Bytes{'H', 'T', 'T', 'P', '/', '1', '.', '1', ' ', '4', '0', '0', ' ', 'B', 'a', 'd', '\n'});
  core = std::make_unique<ClientCore>(options());
  core->start();
  const auto scene = core->wait_welcome(5s);
  ASSERT_FALSE(scene);
  EXPECT_EQ(core->status().state, ClientState::kFailed);
  EXPECT_EQ(scene.error().code, ErrorCode::kBadData);
  EXPECT_EQ(scene.error().message.find('\n'), std::string::npos);
}

TEST_F(ClientCoreTest, GarbageLaterKeepsThePictureAndConnectsAnew) {
  start(options());
  stand_in(0);
  send_whole(1, 0, {1});
  ASSERT_TRUE(core->wait_complete(made::eye_in(0), 5s));
  server.send_raw(Bytes(64, 0xee));
  ASSERT_TRUE(server.wait_for(MessageType::kHello, 2));
  EXPECT_NE(core->view(), nullptr);
  EXPECT_EQ(core->status().error.code, ErrorCode::kBadData);
}

TEST_F(ClientCoreTest, MessagesThatMakeNoSenseEndTheConnection) {
  start(options());
  LeafSet set = made::leaf_set(1, 0, {1});
  set.leaf.level = 200;
  server.send_leaf_set(set);
  ASSERT_TRUE(wait_until([&] { return core->status().error.message.find("level 200") != std::string::npos; }));
  ASSERT_TRUE(server.wait_for(MessageType::kHello, 2));
}

TEST_F(ClientCoreTest, UnknownScenesAndVersionsAreFinal) {
  for (const auto code : {ErrorCode::kNotFound, ErrorCode::kVersionMismatch, ErrorCode::kUnauthenticated}) {
    wire::Failure failure;
    failure.set_code(static_cast<std::uint32_t>(code));
    failure.set_message("no scene 'made up'; there are: clinic, delft");
    failure.set_fatal(true);
    server.answer_hello_with(make_message(MessageType::kFailure, failure));
    core = std::make_unique<ClientCore>(options());
    core->start();
    const auto scene = core->wait_welcome(5s);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().code, code);
    EXPECT_THAT(scene.error().message, HasSubstr("there are: clinic, delft"));
    EXPECT_EQ(core->status().state, ClientState::kFailed);
  }
}

TEST_F(ClientCoreTest, AServerThatIsNotThereIsTriedAgain) {
  ClientOptions elsewhere = options();
  {
    const FakeServer gone;
    elsewhere.server = gone.endpoint();
  }
  core = std::make_unique<ClientCore>(elsewhere);
  core->start();
  const auto scene = core->wait_welcome(300ms);
  ASSERT_FALSE(scene);
  EXPECT_EQ(core->status().state, ClientState::kConnecting);
  EXPECT_THAT(scene.error().message, HasSubstr("cannot connect to 127.0.0.1"));
}

TEST_F(ClientCoreTest, BadPayloadsAreCountedAndNamedAndHoldNothingUp) {
  start(options());
  stand_in(0);
  server.send_leaf_set(made::leaf_set(1, 0, {1, 2, 3}));
  server.send_tile(1);
  server.send_tile(2, {0xff});
  server.send_tile(3, {});  // empty
  server.send_complete(1);
  const auto view = core->wait_complete(made::eye_in(0), 5s);
  ASSERT_TRUE(view) << view.error().message;
  EXPECT_EQ((*view)->tiles.size(), 1u);
  EXPECT_EQ(core->statistics().bad_payloads, 1u);
  EXPECT_THAT(core->status().error.message, HasSubstr("0000000000000002"));
  EXPECT_EQ(core->status().state, ClientState::kStreaming);
}

TEST_F(ClientCoreTest, ATinyStoreEvictsReportsAndNeverGoesBlank) {
  ClientOptions tiny = options();
  tiny.store_bytes = 1500;  // two tiles of this test
  start(tiny);
  for (int leaf = 0; leaf < 6; ++leaf) {
    stand_in(leaf);
    const ContentHash first = 10u * static_cast<ContentHash>(leaf) + 1;
    send_whole(static_cast<std::uint64_t>(leaf) + 1, leaf, {first, first + 1, first + 2});
    const auto view = core->wait_complete(made::eye_in(leaf), 5s);
    ASSERT_TRUE(view) << view.error().message;
    EXPECT_FALSE((*view)->tiles.empty());
    EXPECT_LE(core->statistics().store_bytes, tiny.store_bytes);
  }
  EXPECT_GT(core->statistics().given_up, 0u);
  ASSERT_TRUE(server.wait_for(MessageType::kEvicted, 1));
  EXPECT_GT(core->statistics().evicted_payloads, 6u);
}

TEST_F(ClientCoreTest, AQueueOfOneByteStillDecodesEverything) {
  ClientOptions slow = options();
  slow.decode_queue_bytes = 1;
  start(slow);
  stand_in(0);
  std::vector<ContentHash> tiles;
  for (ContentHash key = 1; key <= 200; ++key) tiles.push_back(key);
  server.send_leaf_set(made::leaf_set(1, 0, tiles));
  for (const ContentHash key : tiles) server.send_tile(key, Bytes(100, 1));
  server.send_complete(1);
  const auto view = core->wait_complete(made::eye_in(0), 5s);
  ASSERT_TRUE(view) << view.error().message;
  EXPECT_EQ((*view)->tiles.size(), 200u);
}

TEST_F(ClientCoreTest, AnotherSceneVoidsWhatIsHeldButKeepsThePicture) {
  start(options());
  stand_in(0);
  send_whole(1, 0, {1});
  ASSERT_TRUE(core->wait_complete(made::eye_in(0), 5s));
  server.sync();
  server.welcome().mutable_scene()->set_scene_hash(43);
  server.cut();
  ASSERT_TRUE(server.wait_for(MessageType::kHello, 2));
  ASSERT_TRUE(wait_until([&] { return core->statistics().store_items == 0; }));
  EXPECT_NE(core->view(), nullptr);
  EXPECT_EQ(core->view()->tiles.size(), 1u);
}

TEST_F(ClientCoreTest, LeavesWithAGoodbye) {
  start(options());
  core->stop();
  EXPECT_EQ(core->status().state, ClientState::kStopped);
  EXPECT_TRUE(server.wait_for(MessageType::kBye, 1));
}

}  // namespace
}  // namespace farfield::client
