// SPDX-License-Identifier: Apache-2.0
// What the benchmark knows of a method: its name, its knobs, and how to run it. A new method is one more entry of
// all_methods() (methods.cpp); the command line, --help and the report follow from the list.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "tests/bench/method_result.h"
#include "tests/bench/world.h"

namespace farfield::bench {

/// A number that trades quality for time or bytes.
struct Knob {
  std::string name;
  double default_value = 0;
  std::string description;  // one line, with the unit
  double lowest = 0, highest = std::numeric_limits<double>::infinity();  // both allowed
  bool is_whole = false;
  std::vector<double> choices = {};  // if any: nothing else is allowed
};

/// One value for every knob of a method.
class KnobValues {
 public:
  explicit KnobValues(std::span<const Knob> knobs) {
    for (const Knob& knob : knobs) values_[knob.name] = knob.default_value;
  }
  void set(const std::string& name, double value) { values_[name] = value; }
  /// Requires: the method has such a knob.
  double operator[](std::string_view name) const { return values_.find(name)->second; }
  int whole(std::string_view name) const { return static_cast<int>((*this)[name]); }

 private:
  std::map<std::string, double, std::less<>> values_;
};

struct Method {
  std::string name;
  std::string summary;  // one line
  std::vector<Knob> knobs;
  std::function<Result<MethodResult>(const World&, const KnobValues&)> run;
  /// Runs before all others: the memory it reports must not include what they need.
  bool runs_first = false;
  bool has_cells = false;  // what it shows changes where the viewer crosses into another cell
};

using KnobSetting = std::pair<std::string, double>;  // name, value

/// Null if there is none.
const Method* find_method(std::span<const Method> methods, std::string_view name);
/// Empty, or in one line why the method cannot be run with this value.
std::string objection_to(const Method& method, const KnobSetting& setting);
/// Requires: no objection to any of the settings.
KnobValues values_of(const Method& method, std::span<const KnobSetting> settings);
/// For --help: a line per method and one per knob.
std::string describe(std::span<const Method> methods);

}  // namespace farfield::bench
