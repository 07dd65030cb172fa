// SPDX-License-Identifier: Apache-2.0
#include "server/access/token_register.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

using namespace std::chrono;

class TokenRegisterTest : public ::testing::Test {
 protected:
  void write(const std::vector<TokenEntry>& entries) const {
    std::ofstream out(file);
    for (const TokenEntry& entry : entries) out << format_token(entry);
  }
  std::shared_ptr<TokenRegister> load() {
    auto loaded = TokenRegister::load(file, [this] { return now; });
    EXPECT_TRUE(loaded) << loaded.error().message;
    return *loaded;
  }

  TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "tokens";
  WallTime now = sys_days(2026y / 3 / 1);
  const TokenEntry alice{digest_of("alice's"), "alice", Role::kViewer, now + 1h}, bob{digest_of("bob's"), "bob", Role::kAdmin, now + 2h};
};

TEST_F(TokenRegisterTest, AdmitsWhoIsListedUntilTheirTimeIsOver) {
  write({alice, bob});
  const auto tokens = load();
  EXPECT_EQ(tokens->admit("alice's")->entry.user, "alice");
  EXPECT_EQ(tokens->admit("bob's")->entry.role, Role::kAdmin);
  for (const char* wrong : {"", "alice", "alice's ", "Alice's"}) EXPECT_FALSE(tokens->admit(wrong)) << wrong;
  EXPECT_FALSE(tokens->admit(std::string(100'000, 'a')));
  Admission admission = *tokens->admit("alice's");
  now = alice.expires - 1s;
  EXPECT_TRUE(tokens->is_valid(admission));
  now = alice.expires;
  EXPECT_FALSE(tokens->is_valid(admission));
  EXPECT_FALSE(tokens->admit("alice's"));
  EXPECT_TRUE(tokens->admit("bob's"));
}

TEST_F(TokenRegisterTest, AListReadAgainRevokesAndProlongs) {
  write({alice, bob});
  const auto tokens = load();
  Admission of_alice = *tokens->admit("alice's"), of_bob = *tokens->admit("bob's");
  TokenEntry longer = bob;
  longer.expires += 24h;
  longer.role = Role::kViewer;
  write({longer});
  ASSERT_TRUE(tokens->reload());
  EXPECT_FALSE(tokens->is_valid(of_alice));
  now = bob.expires + 1h;
  EXPECT_TRUE(tokens->is_valid(of_bob));
  EXPECT_EQ(of_bob.entry.role, Role::kViewer);
}

TEST_F(TokenRegisterTest, AListThatIsBrokenChangesNothing) {
  write({alice});
  const auto tokens = load();
  Admission admission = *tokens->admit("alice's");
  std::ofstream(file) << "rubbish\n";
  EXPECT_FALSE(tokens->reload());
  EXPECT_TRUE(tokens->is_valid(admission));
  std::filesystem::remove(file);
  EXPECT_FALSE(tokens->reload());
  EXPECT_TRUE(tokens->admit("alice's"));
  EXPECT_EQ(TokenRegister::load(file).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace farfield
