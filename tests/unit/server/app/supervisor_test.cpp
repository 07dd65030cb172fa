// SPDX-License-Identifier: Apache-2.0
#include "server/app/supervisor.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstring>

#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;

/// systemd's end.
class SupervisorTest : public testing::Test {
 protected:
  void SetUp() override {
    descriptor_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof(address.sun_path) - 1);
    ASSERT_EQ(bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    const timeval patience{.tv_sec = 5, .tv_usec = 0};
    setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  }
  void TearDown() override { close(descriptor_); }
  std::string message() const {
    char buffer[256];
    const ssize_t size = recv(descriptor_, buffer, sizeof(buffer), 0);
    return size < 0 ? "" : std::string(buffer, static_cast<std::size_t>(size));
  }
  TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "notify").string();
  int descriptor_ = -1;
};

TEST_F(SupervisorTest, IsToldWhenTheServerIsReadyAndWhenItEnds) {
  const Supervisor supervisor(path_, std::nullopt);
  supervisor.ready("2 scenes");
  EXPECT_EQ(message(), "READY=1\nSTATUS=2 scenes");
  supervisor.stopping();
  EXPECT_EQ(message(), "STOPPING=1\nSTATUS=draining");
  EXPECT_FALSE(supervisor.keep_pinging([] { return true; })) << "no watchdog waits";
}

TEST_F(SupervisorTest, IsPingedOnlyWhileTheServerIsAlive) {
  const Supervisor supervisor(path_, 40ms);
  std::atomic<bool> is_alive{true};
  std::atomic<int> asked{0};
  const auto pings = supervisor.keep_pinging([&] { return ++asked, is_alive.load(); });
  ASSERT_TRUE(pings);
  EXPECT_EQ(message(), "WATCHDOG=1");
  EXPECT_EQ(message(), "WATCHDOG=1");
  is_alive = false;
  const int before = asked;
  while (asked < before + 3) std::this_thread::sleep_for(1ms);
  char buffer[16];
  while (recv(descriptor_, buffer, sizeof(buffer), MSG_DONTWAIT) > 0) {
  }
  const int then = asked;
  while (asked < then + 3) std::this_thread::sleep_for(1ms);
  EXPECT_LT(recv(descriptor_, buffer, sizeof(buffer), MSG_DONTWAIT), 0) << "it hangs, and nobody says otherwise";
}

TEST_F(SupervisorTest, WhereNobodyAskedNothingHappens) {
  const Supervisor nobody("", 1s), gone((folder_.path() / "gone").string(), 1s);
  nobody.ready("x"), gone.ready("x");
  EXPECT_FALSE(nobody.keep_pinging([] { return true; }));
}

TEST_F(SupervisorTest, IsFoundInTheEnvironment) {
  setenv("NOTIFY_SOCKET", path_.c_str(), 1), setenv("WATCHDOG_USEC", "2000000", 1), setenv("WATCHDOG_PID", "1", 1);
  EXPECT_TRUE(Supervisor::from_environment().is_there());
  EXPECT_FALSE(Supervisor::from_environment().keep_pinging([] { return true; })) << "the watchdog is another process's";
  setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  EXPECT_TRUE(Supervisor::from_environment().keep_pinging([] { return true; }));
  unsetenv("NOTIFY_SOCKET"), unsetenv("WATCHDOG_USEC"), unsetenv("WATCHDOG_PID");
  EXPECT_FALSE(Supervisor::from_environment().is_there());
}

}  // namespace
}  // namespace farfield
