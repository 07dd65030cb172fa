// SPDX-License-Identifier: Apache-2.0
// The list of access tokens: what is accepted survives being written and read again, and errors never repeat a line.
#include <string>
#include <string_view>

#include "server/access/token_file.h"
#include "tests/fuzz/require.h"

using farfield::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto entries = farfield::parse_tokens(text, "list");
  const farfield::WallTime now{};
  if (const auto expiry = farfield::parse_expiry(text, now)) {
    require(farfield::parse_expiry(farfield::format_expiry(*expiry), now) == *expiry, "an end that is written can be read");
  }
  if (!entries) {
    require(entries.error().message.starts_with("list:"), "every error says where");
    require(entries.error().message.size() < 120, "no error repeats what it found");
    return 0;
  }
  std::string written;
  for (const farfield::TokenEntry& entry : *entries) written += farfield::format_token(entry);
  const auto again = farfield::parse_tokens(written, "again");
  require(again.has_value(), "what was written can be read");
  require(*again == *entries, "nothing is lost");
  return 0;
}
