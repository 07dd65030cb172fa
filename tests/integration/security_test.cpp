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

TEST_F(SecureProgramsTest, TokensLetInAndStayOutOfEveryLog) {
  const std::string list = (certificates_.folder() / "tokens").string(), file = (certificates_.folder() / "alice.token").string();
  const auto token_program = [](const std::vector<std::string>& arguments) {
    ChildProgram program("farfield-token", arguments);
    EXPECT_EQ(program.wait(20s), 0) << program.error_out();
    return program.out();
  };
  EXPECT_EQ(token_program({"add", "--tokens", list, "--user", "alice", "--expires", "1h", "--output", file}), "");
  std::string token;
  std::getline(std::ifstream(file), token);
  ASSERT_TRUE(token.starts_with("farfield_"));
  EXPECT_EQ(std::filesystem::status(file).permissions(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);

  ChildProgram server("farfield-server", serve({"--tokens", list, "--verbose", "--json", "--listen", "127.0.0.1:0"}));
  const auto line = server.wait_for_line("listening_tls", 60s);
  ASSERT_TRUE(line) << server.error_out();
  const auto where = nlohmann::json::parse(*line);
  const std::string address = "farfields://" + where["listening_tls"].get<std::string>(), plain = where["listening"];
  const std::string authority = certificates_.ca().string();
  ChildProgram client("farfield-client", walk(address, {"--ca", authority, "--token-file", file}));
  ASSERT_EQ(client.wait(60s), 0) << client.error_out();

  const std::string refused = refusal(walk(address, {"--ca", authority}));
  EXPECT_NE(refused.find("access refused"), std::string::npos) << refused;
  const std::string wrong = (certificates_.folder() / "wrong.token").string();
  std::ofstream(wrong) << token << "x\n";
  const std::string guessed = refusal(walk(plain, {"--token-file", wrong}));
  EXPECT_NE(guessed.find("access refused"), std::string::npos) << guessed;

  EXPECT_EQ(token_program({"revoke", "--tokens", list, "--user", "alice"}), "1 revoked\n");
  server.send(SIGHUP);
  ASSERT_TRUE(server.wait_for_line("list of tokens was read again: 0", 10s, true)) << server.error_out();
  EXPECT_NE(refusal(walk(address, {"--ca", authority, "--token-file", file})).find("access refused"), std::string::npos);
  server.send(SIGTERM);
  EXPECT_EQ(server.wait(20s), 0);
  // What tells a session apart from its client's secret: half a token is too much.
  const std::string secret = token.substr(9, 16);
  std::ifstream in(list);
  const std::string listed((std::istreambuf_iterator<char>(in)), {});
  for (const std::string& text : {server.out(), server.error_out(), client.out(), client.error_out(), refused, guessed, listed}) {
    EXPECT_EQ(text.find(secret), std::string::npos) << text;
  }
  for (const std::string& text : {refused, guessed}) {
    EXPECT_EQ(text.find("plant"), std::string::npos) << text;
    EXPECT_EQ(text.find(certificates_.folder().string()), std::string::npos) << text;
  }
}

TEST_F(SecureProgramsTest, WhatIsSeldomMeantIsWarnedOf) {
  std::filesystem::permissions(certificates_.files().key, std::filesystem::perms::others_read, std::filesystem::perm_options::add);
  ChildProgram server("farfield-server", serve({"--admin", "0.0.0.0:0"}));
  wait_listening(server);
  EXPECT_TRUE(server.wait_for_line("warning: --admin 0.0.0.0:0", 10s, true)) << server.error_out();
  EXPECT_TRUE(server.wait_for_line("warning: --tls-key", 10s, true)) << server.error_out();
}

TEST_F(SecureProgramsTest, ATokenDoesNotTravelInClearUnlessSaid) {
  const std::string file = (certificates_.folder() / "token").string();
  std::ofstream(file) << "farfield_secret\n";
  ChildProgram client("farfield-client", {"--connect", "192.0.2.1:7400", "--headless", "--token-file", file});
  EXPECT_EQ(client.wait(20s), 2);
  EXPECT_NE(client.error_out().find("--allow-clear-token"), std::string::npos) << client.error_out();
  EXPECT_EQ(client.error_out().find("secret"), std::string::npos);
}

}  // namespace
}  // namespace farfield
