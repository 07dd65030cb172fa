// SPDX-License-Identifier: Apache-2.0
// The small languages of command lines: links and endpoints. What is understood is printed and understood again.
#include <cmath>
#include <string_view>

#include "common/net/endpoint.h"
#include "common/net/link_model.h"
#include "tests/fuzz/require.h"

using farfield::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto link = farfield::parse_link_model(text)) {
    require(link->rate_bits_per_second >= 0 && std::isfinite(link->rate_bits_per_second), "rates are finite");
    require(link->loss >= 0 && link->loss <= 1, "loss is a share");
    require(link->delay.count() >= 0 && link->jitter.count() >= 0, "times do not run backwards");
    require(farfield::parse_link_model(farfield::to_string(*link)).has_value(), "links are printed as they are read");
  }
  // Brackets inside a name are nobody's host; the resolver says so.
  const bool has_bracket = text.find_first_of("[]") != std::string_view::npos && text.front() != '[';
  if (const auto endpoint = farfield::parse_endpoint(text); endpoint && !has_bracket) {
    const auto again = farfield::parse_endpoint(farfield::to_string(*endpoint));
    require(again && again->port == endpoint->port && again->host == endpoint->host, "endpoints are printed as they are read");
  }
  return 0;
}
