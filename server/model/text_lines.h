// SPDX-License-Identifier: Apache-2.0
// Lines, words and numbers of line-based text formats, read in place.
#pragma once

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/bytes.h"

namespace farfield {

inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Takes the next line off `rest` (without its end); false at the end of the text.
inline bool next_line(std::string_view& rest, std::string_view& line) {
  if (rest.empty()) return false;
  const std::size_t end = rest.find('\n');
  line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return true;
}

/// Takes the next word off `rest`; empty at the end of the line.
inline std::string_view next_word(std::string_view& rest) {
  while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
  std::size_t size = 0;
  while (size < rest.size() && !is_blank(rest[size])) ++size;
  const std::string_view word = rest.substr(0, size);
  rest.remove_prefix(size);
  return word;
}

/// The number a word starts with, a leading '+' allowed; nothing if it starts with none.
template <class T>
std::optional<T> parse_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end == word.data()) return std::nullopt;
  return value;
}

/// File bytes as 8-bit text: a UTF-8 byte order mark is skipped, UTF-16 (by its mark) is narrowed, characters outside
/// ASCII becoming '?'; names suffer, numbers do not.
inline std::string to_text(ByteView bytes) {
  const auto starts_with = [&](std::initializer_list<std::uint8_t> mark) {
    return bytes.size() >= mark.size() && std::equal(mark.begin(), mark.end(), bytes.begin());
  };
  if (starts_with({0xef, 0xbb, 0xbf})) bytes = bytes.subspan(3);
  const bool is_big_endian = starts_with({0xfe, 0xff});
  if (!is_big_endian && !starts_with({0xff, 0xfe})) return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  std::string text;
  for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
    const std::uint8_t high = bytes[i + (is_big_endian ? 0 : 1)], low = bytes[i + (is_big_endian ? 1 : 0)];
    text.push_back(high == 0 && low < 0x80 ? static_cast<char>(low) : '?');
  }
  return text;
}

}  // namespace farfield
