// SPDX-License-Identifier: Apache-2.0
#include "common/trace/trace_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>

#include "common/base/complete_file.h"

namespace farfield {
namespace {

constexpr double kLargestCoordinate = 1e12;  // metres: beyond any place, and still far from overflow

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Reads exactly eight numbers. Returns: an empty string, or what is wrong.
std::string read_numbers(std::string_view line, std::array<double, 8>& values) {
  std::size_t count = 0;
  while (!(line = trimmed(line)).empty()) {
    if (count == values.size()) return "more than 8 numbers; a frame is \"t x y z qx qy qz qw\"";
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), values[count]);
    const std::size_t used = static_cast<std::size_t>(end - line.data());
    if (error != std::errc{} || (used < line.size() && line[used] != ' ' && line[used] != '\t')) {
      return fmt::format("\"{}\" is not a number", line.substr(0, std::min<std::size_t>(line.find_first_of(" \t"), 24)));
    }
    if (!std::isfinite(values[count]) || std::abs(values[count]) > kLargestCoordinate) {
      return fmt::format("number {} is out of range", count + 1);
    }
    ++count;
    line.remove_prefix(used);
  }
  if (count < values.size()) return fmt::format("{} numbers where a frame has 8: \"t x y z qx qy qz qw\"", count);
  return {};
}

// Header comments that change the meaning are checked. Returns: an empty string, or what is wrong.
std::string read_comment(std::string_view comment, Trace& trace) {
  const std::size_t colon = comment.find(':');
  if (colon == std::string_view::npos) return {};
  const std::string_view key = trimmed(comment.substr(0, colon)), value = trimmed(comment.substr(colon + 1));
  if (key == "scene") trace.scene = value.substr(0, 1024);
  if (key == "frame" && !value.starts_with("world")) {
    return fmt::format("frame \"{}\": only world coordinates are read; convert the trace", value.substr(0, 40));
  }
  if (key == "units" && !value.starts_with("metres")) {
    return fmt::format("units \"{}\": only metres are read; convert the trace", value.substr(0, 40));
  }
  return {};
}

}  // namespace

std::string format_trace(const Trace& trace) {
  std::string scene = trace.scene;
  for (char& c : scene) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::string text = fmt::format(
      "# farfield trace 1\n# scene: {}\n# frame: world (right-handed, +Y up, the camera looks along its -Z)\n"
      "# units: metres, seconds\n# t x y z qx qy qz qw\n",
      scene);
  for (const TraceFrame& frame : trace.frames) {
    const glm::dvec3& p = frame.pose.position;
    const glm::dquat& q = frame.pose.world_from_camera;
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {} {}\n", frame.time_s, p.x, p.y, p.z, q.x, q.y, q.z, q.w);
  }
  return text;
}

Result<Trace> parse_trace(std::string_view text, const std::string& name) {
  Trace trace;
  std::size_t line_number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++line_number;
    const auto bad = [&](const std::string& what) { return fail(ErrorCode::kBadData, "{}:{}: {}", name, line_number, what); };
    if (line.empty()) continue;
    if (line.front() == '#') {
      if (const std::string wrong = read_comment(line.substr(1), trace); !wrong.empty()) return bad(wrong);
      continue;
    }
    std::array<double, 8> v{};
    if (const std::string wrong = read_numbers(line, v); !wrong.empty()) return bad(wrong);
    const glm::dquat rotation(v[7], v[4], v[5], v[6]);
    const double length = glm::length(rotation);
    if (!(length > 0.5 && length < 2)) return bad(fmt::format("quaternion of length {:.3g} is not a rotation", length));
    if (!trace.frames.empty() && v[0] <= trace.frames.back().time_s) {
      return bad(fmt::format("time {} does not follow {}", v[0], trace.frames.back().time_s));
    }
    if (trace.frames.size() == kMaxTraceFrames) {
      return fail(ErrorCode::kLimitExceeded, "{}:{}: more than {} frames; split the trace", name, line_number, kMaxTraceFrames);
    }
    // Already of unit length to the last digits: kept as it is, so that reading returns what was written.
    const bool is_unit = std::abs(length - 1) < 1e-12;
    trace.frames.push_back({v[0], {{v[1], v[2], v[3]}, is_unit ? rotation : rotation / length}});
  }
  if (trace.frames.empty()) return fail(ErrorCode::kBadData, "{}: no frames in it; a frame is a line \"t x y z qx qy qz qw\"", name);
  return trace;
}

Result<Trace> read_trace(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    return fail(ErrorCode::kNotFound, "{}: no such file; check the path", path.string());
  }
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return fail(ErrorCode::kIo, "{}: not a file; name a trace, not a folder or device", path.string());
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return fail(ErrorCode::kIo, "{}: {}", path.string(), error.message());
  if (size > kMaxTraceBytes) return fail(ErrorCode::kLimitExceeded, "{}: {} bytes; traces may have {}", path.string(), size, kMaxTraceBytes);
  std::ifstream file(path, std::ios::binary);
  std::string text(size, '\0');
  if (!file.read(text.data(), static_cast<std::streamsize>(size))) return fail(ErrorCode::kIo, "{}: cannot be read; check its permissions", path.string());
  return parse_trace(text, path.string());
}

Status write_trace(const std::filesystem::path& path, const Trace& trace) {
  return write_complete_file(path, format_trace(trace));
}

}  // namespace farfield
