// SPDX-License-Identifier: Apache-2.0
// Metrics in Prometheus's text format: https://prometheus.io/docs/instrumenting/exposition_formats/ (version 0.0.4).
#pragma once

#include <string>
#include <string_view>

#include "server/schedule/duration_histogram.h"

namespace farfield {

/// One label, or none. Values may hold anything: they are escaped.
struct MetricLabel {
  std::string_view name;
  std::string_view value;
};

class PrometheusText {
 public:
  /// Names end in _total for counters and carry base units (bytes, seconds). Help is written once per name: put the
  /// same name with several labels one after another.
  void counter(std::string_view name, std::string_view help, double value, MetricLabel label = {});
  void gauge(std::string_view name, std::string_view help, double value, MetricLabel label = {});
  void histogram(std::string_view name, std::string_view help, const DurationHistogram& histogram, MetricLabel label = {});

  const std::string& text() const { return text_; }

 private:
  void describe(std::string_view name, std::string_view help, std::string_view type);
  void sample(std::string_view name, MetricLabel label, double value, MetricLabel second = {});

  std::string text_;
  std::string described_;  // the last name described
};

}  // namespace farfield
