// SPDX-License-Identifier: Apache-2.0
#include "server/admin/prometheus_text.h"

#include <fmt/format.h>

#include <iterator>

namespace farfield {
namespace {

std::string escaped(std::string_view value) {
  std::string text;
  for (const char c : value) {
    if (c == '\n') {
      text += "\\n";
    } else {
      if (c == '\\' || c == '"') text += '\\';
      text += c;
    }
  }
  return text;
}

}  // namespace

void PrometheusText::describe(std::string_view name, std::string_view help, std::string_view type) {
  if (described_ == name) return;
  described_ = name;
  fmt::format_to(std::back_inserter(text_), "# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
}

void PrometheusText::sample(std::string_view name, MetricLabel label, double value, MetricLabel second) {
  text_ += name;
  std::string labels;
  for (const MetricLabel& part : {label, second}) {
    if (part.name.empty()) continue;
    labels += fmt::format("{}{}=\"{}\"", labels.empty() ? "" : ",", part.name, escaped(part.value));
  }
  if (!labels.empty()) text_ += "{" + labels + "}";
  fmt::format_to(std::back_inserter(text_), " {}\n", value);
}

void PrometheusText::counter(std::string_view name, std::string_view help, double value, MetricLabel label) {
  describe(name, help, "counter");
  sample(name, label, value);
}

void PrometheusText::gauge(std::string_view name, std::string_view help, double value, MetricLabel label) {
  describe(name, help, "gauge");
  sample(name, label, value);
}

void PrometheusText::histogram(std::string_view name, std::string_view help, const DurationHistogram& histogram,
                               MetricLabel label) {
  describe(name, help, "histogram");
  const std::string bucket = std::string(name) + "_bucket";
  std::uint64_t up_to_here = 0;
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    up_to_here += histogram.counts[i];
    const bool is_last = i == histogram.kUpperEnds_s.size();
    const std::string end = is_last ? "+Inf" : fmt::format("{}", histogram.kUpperEnds_s[i]);
    sample(bucket, label, static_cast<double>(up_to_here), {"le", end});
  }
  sample(std::string(name) + "_sum", label, histogram.sum_s);
  sample(std::string(name) + "_count", label, static_cast<double>(histogram.count));
}

}  // namespace farfield
