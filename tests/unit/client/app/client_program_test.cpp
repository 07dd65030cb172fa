// SPDX-License-Identifier: Apache-2.0
// The whole program in this process, against a scripted server: headless, with the renderer it really uses.
#include "client/app/client_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/codec/tile_codec.h"
#include "common/trace/trace_file.h"
#include "tests/unit/client/session/fake_server.h"
#include "tests/unit/client/store/made_leaf_sets.h"

namespace farfield::client {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

/// Blocks SIGINT in every thread of the test, so that only the program's own watch takes it.
struct BlockedInterrupts {
  BlockedInterrupts() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    pthread_sigmask(SIG_BLOCK, &signals, &former);
  }
  ~BlockedInterrupts() { pthread_sigmask(SIG_SETMASK, &former, nullptr); }
  sigset_t former;
};

class ClientProgramTest : public ::testing::Test {
 protected:
  ClientProgramTest() {
    fs::create_directories(folder);
    // Each leaf is one tile and its own key; a pose anywhere gets the leaf it is in.
    server.on_pose([this](const wire::Pose& pose) {
      const CellId leaf{static_cast<std::uint8_t>(pose.cell().level()), pose.cell().x(), pose.cell().y(), pose.cell().z()};
      if (last_leaf == leaf) return;
      last_leaf = leaf;
      LeafSet set;
      set.serial = ++serial;
      set.leaf = leaf;
      set.root = leaf.ancestor(3);
      set.is_current = true;
      set.tiles = {std::hash<CellId>()(leaf)};
      server.send_leaf_set(set);
      server.send_tile(set.tiles[0], *encode_tile(made::tiny_tile(leaf), TileEncoding{}));
      server.send_complete(serial);
    });
  }
  ~ClientProgramTest() override { fs::remove_all(folder); }

  /// A walk of `metres` along x at 10 m/s, in the server's world.
  std::string walk(double metres) {
    Trace trace;
    for (int i = 0; i <= 10; ++i) {
      trace.frames.push_back({0.01 * metres * i, {{1e6 + 0.1 * metres * i, 0.5, 0.5}, {1, 0, 0, 0}}});
    }
    const fs::path path = folder / "walk.trace";
    EXPECT_TRUE(write_trace(path, trace));
    return path.string();
  }
  int run(std::vector<std::string> arguments) {
    const std::string connect = to_string(server.endpoint());
    arguments.insert(arguments.begin(), {"farfield-client", "--connect", connect, "--headless", "--size", "64x48", "--json"});
    std::vector<const char*> pointers;
    for (const std::string& argument : arguments) pointers.push_back(argument.c_str());
    std::ostringstream out_stream, talk_stream;
    const int code = run_client(static_cast<int>(pointers.size()), pointers.data(), out_stream, talk_stream);
    out = out_stream.str();
    talk = talk_stream.str();
    return code;
  }

  const BlockedInterrupts blocked;
  fs::path folder = fs::temp_directory_path() / ("farfield_client_test_" + std::to_string(::getpid()));
  FakeServer server;
  std::optional<CellId> last_leaf;
  std::uint64_t serial = 0;
  std::string out, talk;
};

TEST_F(ClientProgramTest, LockstepDrawsEveryFrameWithItsLeafSet) {
  const fs::path frames = folder / "frames", record = folder / "drawn.trace";
  ASSERT_EQ(run({"--trace", walk(5), "--lockstep", "--frames", "6", "--renderer", "cpu", "--frames-dir", frames.string(),
                 "--record", record.string()}),
            0)
      << talk;
  const auto report = nlohmann::json::parse(out);
  EXPECT_EQ(report["frames"], 6);
  EXPECT_EQ(report["late_frames"], 0);
  EXPECT_EQ(report["renderer"], "cpu");
  EXPECT_EQ(report["payloads"]["tiles"], 6);
  EXPECT_NEAR(report["walked_m"].get<double>(), 5, 1e-6);
  EXPECT_GT(report["entry"]["bytes"].get<int>(), 0);
  EXPECT_GT(report["frame_ms"]["median"].get<double>(), 0);
  for (int i = 0; i < 6; ++i) {
    std::ifstream png(frames / ("frame_00000" + std::to_string(i) + ".png"), std::ios::binary);
    std::string head(4, ' ');
    png.read(head.data(), 4);
    EXPECT_EQ(head, "\x89PNG") << i;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(frames), {}), 6) << "no half-written files stay";
  const auto drawn = read_trace(record);
  ASSERT_TRUE(drawn) << drawn.error().message;
  EXPECT_EQ(drawn->frames.size(), 6u);
  EXPECT_NEAR(drawn->frames.back().pose.position.x, 1e6 + 5, 1e-6);
}

TEST_F(ClientProgramTest, RealTimeKeepsTheTracesClock) {
  // 0.3 s; a leaf set takes 60 ms to come.
  ASSERT_EQ(run({"--trace", walk(3), "--fps", "50", "--renderer", "cpu", "--link", "delay=30ms"}), 0) << talk;
  const auto report = nlohmann::json::parse(out);
  EXPECT_GT(report["frames"].get<int>(), 1);
  EXPECT_LE(report["frames"].get<int>(), 17);
  EXPECT_GE(report["seconds"].get<double>(), 0.29);
  EXPECT_GT(report["late_frames"].get<int>(), 0) << "the first frames come before anything has arrived";
}

TEST_F(ClientProgramTest, WithoutATraceItStandsAtTheScenesStart) {
  ASSERT_EQ(run({"--frames", "2", "--renderer", "gl"}), 0) << talk;
  const auto report = nlohmann::json::parse(out);
  EXPECT_EQ(report["frames"], 2);
  EXPECT_EQ(report["renderer"], "gl");
  EXPECT_EQ(server.received<wire::Pose>(MessageType::kPose)[0].cell().y(), kGridOffset + 1) << "start: 1.5 m up";
}

TEST_F(ClientProgramTest, FailuresAreOneLineAndOne) {
  wire::Failure failure;
  failure.set_code(static_cast<std::uint32_t>(ErrorCode::kNotFound));
  failure.set_message("no scene 'x' here; there are: made up");
  failure.set_fatal(true);
  server.answer_hello_with(make_message(MessageType::kFailure, failure));
  EXPECT_EQ(run({"--scene", "x", "-q"}), kExitFailure);
  EXPECT_THAT(talk, HasSubstr("there are: made up"));
  EXPECT_EQ(std::count(talk.begin(), talk.end(), '\n'), 1);
  EXPECT_EQ(out, "");
}

TEST_F(ClientProgramTest, ALeafSetThatNeverComesEndsTheWait) {
  server.on_pose({});
  EXPECT_EQ(run({"--trace", walk(1), "--lockstep", "--timeout", "0.3", "-q"}), kExitFailure);
  EXPECT_THAT(talk, HasSubstr("no complete leaf set"));
}

TEST_F(ClientProgramTest, AnInterruptEndsInOrderWithWhatWasDone) {
  std::thread interrupter([this] {
    server.wait_for(MessageType::kPose, 3);
    ::kill(::getpid(), SIGINT);
  });
  EXPECT_EQ(run({"--trace", walk(200), "--renderer", "cpu"}), kExitInterrupted) << talk;
  interrupter.join();
  const auto report = nlohmann::json::parse(out);
  EXPECT_TRUE(report["interrupted"].get<bool>());
  EXPECT_GT(report["frames"].get<int>(), 0);
  EXPECT_LT(report["seconds"].get<double>(), 15);
}

TEST_F(ClientProgramTest, ASlowLinkStandsBetween) {
  ASSERT_EQ(run({"--trace", walk(1), "--lockstep", "--frames", "2", "--link", "delay=30ms", "--renderer", "cpu"}), 0) << talk;
  EXPECT_GE(nlohmann::json::parse(out)["round_trip_ms"].get<double>(), 55);
}

}  // namespace
}  // namespace farfield::client
