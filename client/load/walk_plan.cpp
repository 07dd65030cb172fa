// SPDX-License-Identifier: Apache-2.0
#include "client/load/walk_plan.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <random>

#include "common/trace/trace_file.h"

namespace farfield::client {
namespace {

constexpr double kWalkingSpeed_m_s = 1.4;
constexpr double kRandomSeconds = 300, kReach_m = 60, kPoses_per_s = 10;
// One behind the other, so that each enters what the one before has just left.
constexpr double kHerdGap_s = 0.5;
// Viewers of one path enter it where multiples of the golden ratio fall, which is never where another did.
constexpr double kGoldenShare = 0.6180339887498949;

glm::dquat looking(double heading) { return glm::angleAxis(heading, glm::dvec3(0, 1, 0)); }

}  // namespace

Result<WalkOptions> parse_walk(std::string_view text) {
  WalkOptions options;
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  if (colon != text.npos) options.traces = std::string(text.substr(colon + 1));
  const bool has_file = !options.traces.empty();
  if (kind == "random" && colon == text.npos) return options;
  options.kind = kind == "herd" ? WalkOptions::Kind::kHerd : WalkOptions::Kind::kTraces;
  if ((kind == "herd" && (has_file || colon == text.npos)) || (kind == "trace" && has_file)) return options;
  return fail(ErrorCode::kInvalidArgument, "'{}' is no walk: write random, trace:FILE, trace:FOLDER, herd or herd:FILE", text);
}

Pose WalkPath::at(double seconds) const {
  const double first = path_->frames.front().time_s, length = path_->seconds();
  if (!(length > 0)) return path_->frames.front().pose;
  const double along = std::fmod(begin_s_ + rate_ * seconds, 2 * length);
  if (along <= length) return pose_at(*path_, first + along);
  Pose pose = pose_at(*path_, first + 2 * length - along);
  pose.world_from_camera = glm::angleAxis(std::numbers::pi, glm::dvec3(0, 1, 0)) * pose.world_from_camera;
  return pose;
}

Result<WalkPlan> WalkPlan::load(const WalkOptions& options) {
  WalkPlan plan(options);
  if (options.traces.empty()) return plan;
  std::vector<std::filesystem::path> files;
  std::error_code error;
  if (std::filesystem::is_directory(options.traces, error)) {
    for (const auto& entry : std::filesystem::directory_iterator(options.traces, error))
      if (entry.path().extension() == ".trace") files.push_back(entry.path());
    if (files.empty()) return fail(ErrorCode::kNotFound, "{}: no file there is called *.trace", options.traces.string());
    std::sort(files.begin(), files.end());
  } else {
    files.push_back(options.traces);
  }
  for (const std::filesystem::path& file : files) {
    Result<Trace> trace = read_trace(file);
    if (!trace) return tl::unexpected(trace.error());
    if (trace->frames.empty()) return fail(ErrorCode::kBadData, "{}: the trace has no frames", file.string());
    plan.traces_.push_back(std::make_shared<const Trace>(std::move(*trace)));
  }
  return plan;
}

double WalkPlan::rate_of(const Trace& trace) const {
  const double metres = length_of(trace), seconds = trace.seconds();
  return options_.speed_m_s > 0 && metres > 0 ? options_.speed_m_s * seconds / metres : 1;
}

WalkPath WalkPlan::path_of(std::size_t index, const Box& bounds, const glm::dvec3& start) const {
  const bool is_herd = options_.kind == WalkOptions::Kind::kHerd;
  if (traces_.empty()) {
    const double speed = options_.speed_m_s > 0 ? options_.speed_m_s : kWalkingSpeed_m_s;
    const std::uint64_t seed = options_.seed + (is_herd ? 0 : index);
    auto walk = std::make_shared<const Trace>(random_walk(bounds, start, speed, kRandomSeconds, kReach_m, seed));
    return {std::move(walk), 1, 0};
  }
  const auto& trace = traces_[is_herd ? 0 : index % traces_.size()];
  const double rate = rate_of(*trace);
  if (is_herd) {
    const double lap = 2 * trace->seconds();
    const double behind = std::fmod(rate * kHerdGap_s * static_cast<double>(index), std::max(lap, 1e-9));
    return {trace, rate, lap - behind};
  }
  const double share = static_cast<double>(index / traces_.size()) * kGoldenShare;
  return {trace, rate, (share - std::floor(share)) * 2 * trace->seconds()};
}

Trace random_walk(const Box& bounds, const glm::dvec3& start, double speed_m_s, double seconds, double reach_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  Trace trace;
  glm::dvec3 position = start;
  double heading = std::numbers::pi * unit(random), turn = 0;
  const glm::dvec2 low(std::max(bounds.min.x, start.x - reach_m), std::max(bounds.min.z, start.z - reach_m));
  const glm::dvec2 high(std::min(bounds.max.x, start.x + reach_m), std::min(bounds.max.z, start.z + reach_m));
  const auto count = static_cast<std::size_t>(seconds * kPoses_per_s) + 1;
  for (std::size_t k = 0; k < count; ++k) {
    trace.frames.push_back({static_cast<double>(k) / kPoses_per_s, {position, looking(heading)}});
    // A turn is kept for a while, and never sharper than a person's, 60 degrees a second.
    if (k % 15 == 0) turn = unit(random) * std::numbers::pi / 3 / kPoses_per_s;
    glm::dvec3 ahead = position + speed_m_s / kPoses_per_s * (looking(heading) * glm::dvec3(0, 0, -1));
    if (ahead.x < low.x || ahead.x > high.x || ahead.z < low.y || ahead.z > high.y) {
      turn = std::numbers::pi / 3 / kPoses_per_s;
      ahead.x = std::clamp(ahead.x, std::min(low.x, high.x), high.x), ahead.z = std::clamp(ahead.z, std::min(low.y, high.y), high.y);
    }
    position = ahead;
    heading += turn;
  }
  return trace;
}

}  // namespace farfield::client
