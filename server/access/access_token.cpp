// SPDX-License-Identifier: Apache-2.0
#include "server/access/access_token.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/sha.h>

namespace farfield {
namespace {

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

Result<std::string> make_access_token() {
  TokenDigest random{};
  if (RAND_priv_bytes(random.data(), static_cast<int>(random.size())) != 1) {
    return fail(ErrorCode::kInternal, "the system gives no random numbers: no token can be made");
  }
  std::string token = "farfield_" + to_hex(random);
  OPENSSL_cleanse(random.data(), random.size());
  return token;
}

TokenDigest digest_of(std::string_view token) {
  TokenDigest digest;
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
  return digest;
}

bool is_same(const TokenDigest& a, const TokenDigest& b) { return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0; }

std::string to_hex(const TokenDigest& digest) {
  std::string hex;
  for (const std::uint8_t byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

Result<TokenDigest> parse_digest(std::string_view hex) {
  TokenDigest digest{};
  const bool has_length = hex.size() == 2 * digest.size();
  for (std::size_t i = 0; i < digest.size(); ++i) {
    const int high = has_length ? hex_value(hex[2 * i]) : -1, low = has_length ? hex_value(hex[2 * i + 1]) : -1;
    if (high < 0 || low < 0) return fail(ErrorCode::kBadData, "a SHA-256 digest is 64 hexadecimal digits");
    digest[i] = static_cast<std::uint8_t>(high * 16 + low);
  }
  return digest;
}

}  // namespace farfield
