// SPDX-License-Identifier: Apache-2.0
#include "server/access/token_file.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

namespace farfield {
namespace {

constexpr std::size_t kLongestUser = 64;
constexpr std::string_view kDigestKind = "sha256:";
constexpr std::string_view kBlank = " \t\r";

/// Digits and nothing else.
std::optional<int> number(std::string_view digits) {
  int value = 0;
  if (digits.empty() || !std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; })) return std::nullopt;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<WallTime> parse_date_time(std::string_view text) {
  using namespace std::chrono;
  const bool has_time = text.size() == 20;
  if (!has_time && text.size() != 10) return std::nullopt;
  if (text[4] != '-' || text[7] != '-') return std::nullopt;
  const auto y = number(text.substr(0, 4)), m = number(text.substr(5, 2)), d = number(text.substr(8, 2));
  if (!y || !m || !d || *y < 1970) return std::nullopt;
  const year_month_day date{year(*y), month(static_cast<unsigned>(*m)), day(static_cast<unsigned>(*d))};
  if (!date.ok()) return std::nullopt;
  if (!has_time) return sys_days(date);
  if (text[10] != 'T' || text[13] != ':' || text[16] != ':' || text[19] != 'Z') return std::nullopt;
  const auto h = number(text.substr(11, 2)), min = number(text.substr(14, 2)), s = number(text.substr(17, 2));
  if (!h || !min || !s || *h > 23 || *min > 59 || *s > 59) return std::nullopt;
  return sys_days(date) + hours(*h) + minutes(*min) + seconds(*s);
}

std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = std::min(rest.find_first_not_of(kBlank), rest.size());
  rest.remove_prefix(begin);
  const std::string_view word = rest.substr(0, rest.find_first_of(kBlank));
  rest.remove_prefix(word.size());
  return word;
}

std::optional<TokenEntry> parse_line(std::string_view line) {
  const std::string_view digest = next_word(line), user = next_word(line), role = next_word(line), expiry = next_word(line);
  if (!next_word(line).empty() || !digest.starts_with(kDigestKind) || !is_user_name(user)) return std::nullopt;
  const Result<TokenDigest> read = parse_digest(digest.substr(kDigestKind.size()));
  const std::optional<Role> known = parse_role(role);
  const std::optional<WallTime> expires = parse_date_time(expiry);
  if (!read || !known || !expires) return std::nullopt;
  return TokenEntry{*read, std::string(user), *known, *expires};
}

}  // namespace

Result<std::vector<TokenEntry>> parse_tokens(std::string_view text, const std::string& name) {
  std::vector<TokenEntry> entries;
  std::set<TokenDigest> digests;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(kBlank) == std::string_view::npos) continue;
    std::optional<TokenEntry> entry = parse_line(line);
    if (!entry) {
      return fail(ErrorCode::kBadData, "{}:{}: a line is 'sha256:DIGEST USER ROLE EXPIRY', as farfield-token writes it", name, number);
    }
    if (!digests.insert(entry->digest).second) return fail(ErrorCode::kBadData, "{}:{}: this token stands further up already", name, number);
    if (entries.size() == kMostTokens) return fail(ErrorCode::kLimitExceeded, "{}: more than {} tokens", name, kMostTokens);
    entries.push_back(std::move(*entry));
  }
  return entries;
}

std::string format_token(const TokenEntry& entry) {
  return fmt::format("{}{} {} {} {}\n", kDigestKind, to_hex(entry.digest), entry.user, role_name(entry.role), format_expiry(entry.expires));
}

bool is_user_name(std::string_view name) {
  const auto is_fine = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || std::string_view("._@+-").find(c) != std::string_view::npos;
  };
  return !name.empty() && name.size() <= kLongestUser && std::all_of(name.begin(), name.end(), is_fine);
}

Result<WallTime> parse_expiry(std::string_view text, WallTime now) {
  if (const std::optional<WallTime> time = parse_date_time(text)) return *time;
  constexpr int kMost = 99'999;
  if (text.size() > 1 && (text.back() == 'd' || text.back() == 'h')) {
    const std::optional<int> count = number(text.substr(0, text.size() - 1));
    if (count && *count <= kMost) return now + std::chrono::hours(text.back() == 'd' ? 24 * *count : *count);
  }
  return fail(ErrorCode::kInvalidArgument, "'{}' is no end: write 30d, 12h, 2027-01-31 or 2027-01-31T12:00:00Z", text);
}

std::string format_expiry(WallTime time) {
  using namespace std::chrono;
  const sys_days date = floor<days>(time);
  const year_month_day ymd{date};
  const hh_mm_ss clock{time - date};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", static_cast<int>(ymd.year()), static_cast<unsigned>(ymd.month()),
                     static_cast<unsigned>(ymd.day()), clock.hours().count(), clock.minutes().count(), clock.seconds().count());
}

}  // namespace farfield
