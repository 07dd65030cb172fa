// SPDX-License-Identifier: Apache-2.0
// The list of who may come in, as text:
//
//   # anything behind a hash sign is for people
//   sha256:<64 hexadecimal digits> USER ROLE EXPIRY
//
// It never holds a token, only digests. USER: letters, digits and . _ @ + -, at most 64. EXPIRY: YYYY-MM-DDThh:mm:ssZ, UTC; every
// token has one. Error messages name the line and never repeat it: someone may have put a token there.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "server/access/access_token.h"
#include "server/access/role.h"

namespace farfield {

using WallTime = std::chrono::sys_seconds;

struct TokenEntry {
  TokenDigest digest{};
  std::string user;
  Role role = Role::kViewer;
  WallTime expires;

  bool operator==(const TokenEntry&) const = default;
};

inline constexpr std::size_t kMostTokens = 100'000;

/// `name`: of the file, for errors. Errors: kBadData (a line that is none, a digest twice), kLimitExceeded.
Result<std::vector<TokenEntry>> parse_tokens(std::string_view text, const std::string& name);
/// One line, with its end.
std::string format_token(const TokenEntry& entry);

bool is_user_name(std::string_view name);
/// "2027-01-31T12:00:00Z", "2027-01-31" (its beginning), "30d" or "12h" from `now`; years 1970 to 9999. Errors: kInvalidArgument.
Result<WallTime> parse_expiry(std::string_view text, WallTime now);
std::string format_expiry(WallTime time);

}  // namespace farfield
