// SPDX-License-Identifier: Apache-2.0
// Access tokens and their digests. A token is 256 random bits: nothing a person chose, so that a plain hash of it tells
// nobody anything, and the server's list can do without the tokens.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace farfield {

using TokenDigest = std::array<std::uint8_t, 32>;  // SHA-256

inline constexpr std::size_t kLongestAccessToken = 256;

/// "farfield_" and 64 hexadecimal digits. Errors: kInternal (the system has no randomness to give).
Result<std::string> make_access_token();
TokenDigest digest_of(std::string_view token);
/// In a time that does not depend on where they differ.
bool is_same(const TokenDigest& a, const TokenDigest& b);

std::string to_hex(const TokenDigest& digest);
/// Lower or upper case. Errors: kBadData, without repeating what was given.
Result<TokenDigest> parse_digest(std::string_view hex);

}  // namespace farfield
