// SPDX-License-Identifier: Apache-2.0
// The programs as their users run them where not everybody may come in.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/integration/child_program.h"
#include "tests/unit/common/net/test_certificate.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;

class SecureProgramsTest : public ::testing::Test {
 protected:
  std::vector<std::string> serve(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"--scene", "plant=pipes:2000:1", "--tls-listen", "127.0.0.1:0", "--tls-cert", certificates_.files().certificate.string(),
                                       "--tls-key", certificates_.files().key.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static std::string wait_listening(ChildProgram& server) {
    constexpr const char* kSaid = "listening for TLS at ";
    const auto line = server.wait_for_line(kSaid, 60s);
    EXPECT_TRUE(line) << server.error_out();
    return line ? "farfields://" + line->substr(std::string(kSaid).size()) : "";
  }
  /// Three frames without a screen.
  static std::vector<std::string> walk(const std::string& server, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"--connect", server, "--headless", "--lockstep", "--frames", "3", "--size", "64x36", "--json", "--quiet", "--timeout", "20"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static std::string refusal(const std::vector<std::string>& arguments) {
    ChildProgram client("farfield-client", arguments);
    EXPECT_EQ(client.wait(60s), 1) << client.error_out();
    EXPECT_EQ(client.out(), "");
    return client.error_out();
  }

  test::CertificateFolder certificates_;
};

TEST_F(SecureProgramsTest, AWalkThroughTlsAndCertificatesThatAreNotBelieved) {
  ChildProgram server("farfield-server", serve());
  const std::string address = wait_listening(server);
  const std::string authority = certificates_.ca().string();
  ChildProgram client("farfield-client", walk(address, {"--ca", authority}));
  ASSERT_EQ(client.wait(60s), 0) << client.error_out();
  EXPECT_NE(client.out().find("\"frames\""), std::string::npos);

  ChildProgram load("farfield-load", {"--connect", address, "--ca", authority, "--link", "rate=100mbit", "--clients", "3", "--seconds", "2", "--json", "-", "-q"});
  ASSERT_EQ(load.wait(60s), 0) << load.error_out();
  const auto report = nlohmann::json::parse(load.out(), nullptr, false);
  ASSERT_FALSE(report.is_discarded());
  EXPECT_EQ(report["clients"], 3) << load.out();
  EXPECT_TRUE(report["errors"].empty()) << load.out();

  EXPECT_NE(refusal(walk(address)).find("certificate is not accepted"), std::string::npos);
  const test::CertificateFolder other;
  EXPECT_NE(refusal(walk(address, {"--ca", other.ca().string()})).find("certificate is not accepted"), std::string::npos);

  // Renewed for another name while the server runs: from SIGHUP on it is what new connections get.
  certificates_.renew("DNS:elsewhere.example");
  server.send(SIGHUP);
  ASSERT_TRUE(server.wait_for_line("certificate was read again", 10s, true));
  EXPECT_NE(refusal(walk(address, {"--ca", authority})).find("IP address mismatch"), std::string::npos);
  server.send(SIGTERM);
  EXPECT_EQ(server.wait(20s), 0);
}

}  // namespace
}  // namespace farfield
