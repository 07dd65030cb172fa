// SPDX-License-Identifier: Apache-2.0
// The load tester against the real server: what it reports, what the disk store spares a server that comes back, and what viewers
// notice of one that is killed among them.
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/integration/child_program.h"
#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

class LoadTest : public testing::Test {
 protected:
  // A small plant in few, coarse tiles: these tests are about who gets what when.
  std::unique_ptr<ChildProgram> serve(const std::string& listen = "127.0.0.1:0") {
    auto server = std::make_unique<ChildProgram>(
        "farfield-server", std::vector<std::string>{"--scene", "plant=pipes:20000:1", "--listen", listen, "--admin", "127.0.0.1:0", "--store", store(),
                                                    "--face-tiles", "2", "--delta-views", "1", "--finest-side", "4", "--drain-accept", "1s"});
    const auto at = server->wait_for_line("listening at ", 60s), admin = server->wait_for_line("admin at ", 60s);
    EXPECT_TRUE(at && admin) << server->error_out();
    endpoint_ = at ? at->substr(std::string("listening at ").size()) : "";
    admin_ = admin ? admin->substr(std::string("admin at ").size()) : "";
    return server;
  }
  std::string store() const { return (folder_.path() / "store").string(); }

  struct Load {
    int exit = -1;
    Json report;
    std::string talk;
  };
  static Load finish(ChildProgram& program, std::chrono::seconds patience) {
    Load load;
    load.exit = program.wait(patience).value_or(-1);
    load.report = Json::parse(program.out(), nullptr, false);
    load.talk = program.error_out();
    EXPECT_FALSE(load.report.is_discarded()) << program.out() << load.talk;
    return load;
  }
  std::vector<std::string> arguments(std::vector<std::string> more) const {
    std::vector<std::string> all{"--connect", endpoint_, "--clients", "4", "--walk", "random", "--json", "-", "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Load load(std::vector<std::string> more, std::chrono::seconds patience = 60s) const {
    ChildProgram program("farfield-load", arguments(std::move(more)));
    return finish(program, patience);
  }

  TemporaryFolder folder_;
  std::string endpoint_, admin_;
};

TEST_F(LoadTest, ReportsWhatViewersMetAndJudgesIt) {
  const auto server = serve();
  const Load met = load({"--seconds", "4", "--arrival", "4/s", "--admin", admin_, "--threshold", "errors<1", "--threshold", "first_picture_max<30s"});
  EXPECT_EQ(met.exit, 0) << met.talk;
  const Json& report = met.report;
  EXPECT_EQ(report["format"], "farfield-load/1");
  EXPECT_EQ(report["clients"], 4);
  EXPECT_EQ(report["connect_ms"]["count"], 4);
  EXPECT_EQ(report["first_picture_ms"]["count"], 4);
  EXPECT_GT(report["bytes"], 10000);
  EXPECT_GE(report["cells"]["served"], 4);
  EXPECT_GE(report["cells"]["made"], 1);
  EXPECT_TRUE(report["errors"].empty()) << report["errors"];
  EXPECT_LT(report["own_lag_ms"]["p50"], 100);
  EXPECT_GT(report["own_cpu_s"], 0);
  const Load missed = load({"--seconds", "1", "--threshold", "connect_max<0.001us"});
  EXPECT_EQ(missed.exit, 1);
  EXPECT_NE(missed.talk.find("threshold missed: connect_max<0.001us"), std::string::npos) << missed.talk;
}

TEST_F(LoadTest, ViewersThatDecodeGetTheSame) {
  const auto server = serve();
  const Load decoded = load({"--seconds", "3", "--decode"});
  EXPECT_EQ(decoded.exit, 0) << decoded.talk;
  EXPECT_GT(decoded.report["decode_cpu_s"], 0);
  EXPECT_TRUE(decoded.report["errors"].empty()) << decoded.report["errors"];
}

TEST_F(LoadTest, NobodyThereIsAnErrorOfEveryViewer) {
  endpoint_ = "127.0.0.1:1";
  const Load alone = load({"--seconds", "1", "--threshold", "errors<1"});
  EXPECT_EQ(alone.exit, 1);
  EXPECT_EQ(alone.report["errors"]["never_connected"], 4);
}

TEST_F(LoadTest, WrongUsageIsOneLine) {
  endpoint_ = "127.0.0.1:1";
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"--walk", "fly"}, {"--arrival", "0"}, {"--threshold", "speed<1"}, {"--link", "rate=fast"}, {"--clients", "0"}}) {
    ChildProgram program("farfield-load", arguments(wrong));
    EXPECT_EQ(program.wait(10s), 2) << wrong[1];
    const std::string talk = program.error_out();
    EXPECT_EQ(std::count(talk.begin(), talk.end(), '\n'), 1) << talk;
  }
}

TEST_F(LoadTest, AServerThatWasKilledMakesNothingTwice) {
  auto server = serve();
  const std::vector<std::string> walk{"--seconds", "4", "--seed", "7", "--admin", admin_};
  const Load cold = load(walk);
  ASSERT_GE(cold.report["cells"]["made"], 1);
  std::this_thread::sleep_for(1s);  // what waited to be written is
  server->send(SIGKILL);
  ASSERT_TRUE(server->wait(10s));
  server = serve();
  const Load warm = load({"--seconds", "4", "--seed", "7", "--admin", admin_});
  EXPECT_EQ(warm.exit, 0) << warm.talk;
  // Faster clients may come a cell farther than they came the first time.
  EXPECT_LE(warm.report["cells"]["made"], cold.report["cells"]["made"].get<int>() / 2);
  EXPECT_EQ(server->error_out().find("damaged"), std::string::npos) << server->error_out();
}

TEST_F(LoadTest, ViewersOutliveTheirServer) {
  auto server = serve();
  ChildProgram walkers("farfield-load", arguments({"--seconds", "14"}));
  std::this_thread::sleep_for(4s);
  server->send(SIGKILL);
  ASSERT_TRUE(server->wait(10s));
  server = serve(endpoint_);
  const Load outcome = finish(walkers, 60s);
  EXPECT_EQ(outcome.exit, 0) << outcome.talk;
  EXPECT_EQ(outcome.report["reconnects"], 4);
  EXPECT_EQ(outcome.report["away_ms"]["count"], 4);
  EXPECT_LT(outcome.report["away_ms"]["max"], 10000) << "nobody is away until the end";
}

}  // namespace
}  // namespace farfield
