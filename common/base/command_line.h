// SPDX-License-Identifier: Apache-2.0
// What all programs' command lines have in common: wrong usage is one line on stderr and exit code 2, help that cannot
// be printed is a failure, and numbers stay in ranges that say what they are.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <functional>
#include <optional>
#include <ostream>
#include <string>

#include "common/base/one_line.h"

namespace farfield {

/// Returns: nothing if the program is to go on, else its exit code.
inline std::optional<int> parse_command_line(CLI::App& app, int argument_count, const char* const* arguments,
                                             std::ostream& out, std::ostream& talk) {
  constexpr int kFailureExit = 1, kUsageExit = 2;
  try {
    app.parse(argument_count, arguments);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      app.exit(error, out, talk);
      if (out.flush()) return 0;
      complain(talk, app.get_name(), "the help cannot be written to the output");
      return kFailureExit;
    }
    complain(talk, app.get_name(), std::string(error.what()) + " (see --help)");
    return kUsageExit;
  }
}

/// A check for real numbers: low to high, both included, nothing else.
inline std::function<std::string(const std::string&)> number_between(double low, double high) {
  return [low, high](const std::string& text) -> std::string {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_number = error == std::errc{} && end == text.data() + text.size();
    if (is_number && value >= low && value <= high) return {};
    return fmt::format("'{}' is no number from {:g} to {:g}", text, low, high);
  };
}

/// The same for whole numbers; CLI11 itself takes -1 as the largest of an unsigned type.
inline std::function<std::string(const std::string&)> whole_number_between(std::uint64_t low, std::uint64_t high) {
  return [low, high](const std::string& text) -> std::string {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size() && value >= low && value <= high) return {};
    return fmt::format("'{}' is no whole number from {} to {}", text, low, high);
  };
}

}  // namespace farfield
