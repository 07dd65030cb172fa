// SPDX-License-Identifier: Apache-2.0
// What a stress of the suite of numerical stability is, and what it gives: rows of (input, reference, worst error, bound).
//
// A bound is derived, in a comment beside it, from the roundings on the way to what is compared; where it depends on the
// case, errors are given in parts of their own bound and the row's bound is 1.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace farfield::stability {

struct StressRow {
  std::string input, reference;
  std::string unit;  // of `worst` and `bound`
  double worst = 0, bound = 0;
  std::uint64_t cases = 0;  // that were compared

  /// A stress that compared nothing, or met a NaN, does not hold.
  bool holds() const { return cases > 0 && worst <= bound; }
};

/// How much work a stress may do: `rays` for the stresses that count leaks, everything else by `is_full`.
struct Effort {
  bool is_full = false;
  std::uint64_t leak_rays = 1'000'000;

  static Effort full() { return {true, 100'000'000}; }
};

/// Collects errors; NaN counts as infinitely wrong.
class WorstError {
 public:
  void add(double error) {
    ++cases_;
    const double value = std::isnan(error) ? std::numeric_limits<double>::infinity() : std::abs(error);
    if (value > worst_) worst_ = value;
  }
  /// `error` in parts of its own bound.
  void add(double error, double bound) { add(error / bound); }
  /// Something that must not be: counted, with the cases that were asked about.
  void count(bool is_wrong) {
    ++cases_;
    worst_ += is_wrong;
  }
  void count(std::uint64_t wrong, std::uint64_t cases) { worst_ += static_cast<double>(wrong), cases_ += cases; }
  StressRow row(std::string input, std::string reference, std::string unit, double bound) const {
    return {std::move(input), std::move(reference), std::move(unit), worst_, bound, cases_};
  }
  StressRow in_parts_of_bound(std::string input, std::string reference) const {
    return row(std::move(input), std::move(reference), "of its bound", 1.0);
  }

 private:
  double worst_ = 0;
  std::uint64_t cases_ = 0;
};

using Rows = std::vector<StressRow>;

struct Stress {
  const char* name;
  const char* what;
  Rows (*run)(const Effort& effort);
};

/// All of them, in the order of the table.
const std::vector<Stress>& all_stresses();

Rows stress_shift(const Effort& effort);
Rows stress_scale(const Effort& effort);
Rows stress_distances(const Effort& effort);
Rows stress_broken_models(const Effort& effort);
Rows stress_leaks(const Effort& effort);
Rows stress_borders(const Effort& effort);
Rows stress_projections(const Effort& effort);
Rows stress_codec(const Effort& effort);
Rows stress_float_modes(const Effort& effort);
Rows stress_opengl(const Effort& effort);
Rows stress_threads(const Effort& effort);
Rows stress_kernels(const Effort& effort);

}  // namespace farfield::stability
