// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/method.h"

#include <algorithm>
#include <cmath>

namespace farfield::bench {
namespace {

std::string range_of(const Knob& knob) {
  if (!knob.choices.empty()) {
    std::string text;
    for (const double choice : knob.choices) text += fmt::format("{}{:g}", text.empty() ? "" : "|", choice);
    return text;
  }
  if (std::isinf(knob.highest)) return fmt::format("{:g} or more", knob.lowest);
  return fmt::format("{:g} to {:g}", knob.lowest, knob.highest);
}

bool is_allowed(const Knob& knob, double value) {
  if (!knob.choices.empty()) return std::find(knob.choices.begin(), knob.choices.end(), value) != knob.choices.end();
  return value >= knob.lowest && value <= knob.highest && (!knob.is_whole || std::nearbyint(value) == value);
}

}  // namespace

const Method* find_method(std::span<const Method> methods, std::string_view name) {
  const auto found = std::find_if(methods.begin(), methods.end(), [&](const Method& method) { return method.name == name; });
  return found == methods.end() ? nullptr : &*found;
}

std::string objection_to(const Method& method, const KnobSetting& setting) {
  const auto knob = std::find_if(method.knobs.begin(), method.knobs.end(), [&](const Knob& k) { return k.name == setting.first; });
  if (knob == method.knobs.end()) {
    std::string names;
    for (const Knob& k : method.knobs) names += (names.empty() ? "" : ", ") + k.name;
    return fmt::format("{} has no knob '{}' (it has {})", method.name, setting.first, names.empty() ? "none" : names);
  }
  if (is_allowed(*knob, setting.second)) return {};
  return fmt::format("{}:{} is {}{}, not {:g}", method.name, knob->name, knob->is_whole ? "a whole number, " : "", range_of(*knob), setting.second);
}

KnobValues values_of(const Method& method, std::span<const KnobSetting> settings) {
  KnobValues values(method.knobs);
  for (const auto& [name, value] : settings) values.set(name, value);
  return values;
}

std::string describe(std::span<const Method> methods) {
  std::string text = "Methods, and the knobs of each (default; range):\n";
  for (const Method& method : methods) {
    text += fmt::format("  {:<17} {}\n", method.name, method.summary);
    for (const Knob& knob : method.knobs)
      text += fmt::format("    {:<15} {} ({:g}; {})\n", knob.name, knob.description, knob.default_value, range_of(knob));
  }
  return text;
}

}  // namespace farfield::bench
