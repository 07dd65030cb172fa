// SPDX-License-Identifier: Apache-2.0
#include "server/access/token_file.h"

#include <gtest/gtest.h>

namespace farfield {
namespace {

using namespace std::chrono;

const std::string kHex(64, 'a');
const WallTime kNow = sys_days(2026y / 3 / 1) + 12h;

TEST(AccessToken, AreNeverTheSameAndHashAsEverybodyHashes) {
  const auto first = make_access_token(), second = make_access_token();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->size(), 9 + 64u);
  EXPECT_NE(*first, *second);
  EXPECT_EQ(to_hex(digest_of("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_TRUE(is_same(digest_of(*first), digest_of(*first)));
  EXPECT_FALSE(is_same(digest_of(*first), digest_of(*second)));
}

TEST(TokenFile, WhatIsWrittenIsRead) {
  const TokenEntry entry{digest_of("x"), "alice@example.org", Role::kReviewer, sys_days(2027y / 1 / 31) + 1h + 2min + 3s};
  const auto read = parse_tokens("# people\n\n" + format_token(entry) + "  # the end", "tokens");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 1u);
  EXPECT_EQ(read->front(), entry);
}

TEST(TokenFile, WhatIsNoLineIsNamedByNumberAndNotRepeated) {
  for (const std::string& line : {std::string("farfield_secret"), "sha256:" + kHex + " alice viewer", "sha256:" + kHex + " alice king 2027-01-01",
                                  "sha256:" + kHex.substr(1) + " alice viewer 2027-01-01", "md5:" + kHex + " alice viewer 2027-01-01",
                                  "sha256:" + kHex + " alice viewer 2027-02-30", "sha256:" + kHex + " alice viewer 2027-01-01 more",
                                  "sha256:" + kHex + " ali/ce viewer 2027-01-01", "sha256:" + kHex + " alice viewer 30d"}) {
    const auto read = parse_tokens("# first\n" + line + "\n", "tokens");
    ASSERT_FALSE(read) << line;
    EXPECT_TRUE(read.error().message.starts_with("tokens:2: ")) << read.error().message;
    EXPECT_EQ(read.error().message.find("secret"), std::string::npos);
    EXPECT_EQ(read.error().message.find("alice"), std::string::npos);
  }
}

TEST(TokenFile, ATokenStandsThereOnce) {
  const std::string line = "sha256:" + kHex + " alice viewer 2027-01-01\n";
  EXPECT_FALSE(parse_tokens(line + line, "tokens"));
}

TEST(TokenFile, EndsAreReadInSeveralForms) {
  EXPECT_EQ(*parse_expiry("30d", kNow), kNow + days(30));
  EXPECT_EQ(*parse_expiry("12h", kNow), kNow + 12h);
  EXPECT_EQ(*parse_expiry("2027-01-31", kNow), sys_days(2027y / 1 / 31));
  EXPECT_EQ(*parse_expiry("2024-02-29T23:59:59Z", kNow), sys_days(2024y / 2 / 29) + 23h + 59min + 59s);
  EXPECT_EQ(format_expiry(*parse_expiry("2024-02-29T23:59:59Z", kNow)), "2024-02-29T23:59:59Z");
  for (const char* text : {"", "d", "never", "-1d", "1e3d", "2026-13-01", "2025-02-29", "2027-01-31T24:00:00Z", "2027-01-31 12:00:00Z", "+027-01-31"}) {
    EXPECT_FALSE(parse_expiry(text, kNow)) << text;
  }
}

TEST(Role, EachMayWhatThoseBeforeItMay) {
  EXPECT_TRUE(allows(Role::kViewer, Action::kView));
  EXPECT_FALSE(allows(Role::kViewer, Action::kReview));
  EXPECT_TRUE(allows(Role::kReviewer, Action::kReview));
  EXPECT_FALSE(allows(Role::kReviewer, Action::kOperate));
  EXPECT_TRUE(allows(Role::kAdmin, Action::kOperate) && allows(Role::kAdmin, Action::kView));
  EXPECT_FALSE(parse_role("Admin"));
}

}  // namespace
}  // namespace farfield
