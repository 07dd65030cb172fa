// SPDX-License-Identifier: Apache-2.0
// Camera traces from anywhere: parse_trace(), and that what it accepts survives being written and read again.
#include <cmath>
#include <string_view>

#include "common/trace/trace_file.h"
#include "tests/fuzz/require.h"

using farfield::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto trace = farfield::parse_trace(text, "fuzz.trace");
  if (!trace) {
    require(!trace.error().message.empty(), "every error says what is wrong");
    return 0;
  }
  for (std::size_t i = 0; i < trace->frames.size(); ++i) {
    const farfield::TraceFrame& frame = trace->frames[i];
    require(std::isfinite(frame.time_s), "times are finite");
    require(i == 0 || frame.time_s > trace->frames[i - 1].time_s, "times strictly increase");
    for (int axis = 0; axis < 3; ++axis) require(std::isfinite(frame.pose.position[axis]), "positions are finite");
    require(std::abs(glm::length(frame.pose.world_from_camera) - 1.0) < 1e-9, "rotations are unit quaternions");
  }
  const auto again = farfield::parse_trace(farfield::format_trace(*trace), "again");
  require(again.has_value(), "what was written can be read");
  require(again->frames.size() == trace->frames.size(), "no frame is lost");
  return 0;
}
