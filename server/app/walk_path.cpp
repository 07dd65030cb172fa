// SPDX-License-Identifier: Apache-2.0
// From free places to camera frames: smoothing, even speed with eased ends, and the way a head turns while walking.
#include "server/app/walk_path.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "server/app/body_probe.h"
#include "server/app/path_search.h"
#include "server/model/random_stream.h"

namespace farfield {
namespace {

constexpr double kTau = 6.283185307179586;
constexpr double kEaseSeconds = 0.5;
constexpr double kLongestSeconds = 24 * 3600.0, kMostFrames = 5e6;

// Metres covered after `t` of `seconds` at unit cruising speed, starting and stopping gently.
double eased_distance(double t, double seconds) {
  const double ease = std::min(kEaseSeconds, 0.5 * seconds);
  const auto ramp = [ease](double s) { return ease * (s * s * s - 0.5 * s * s * s * s); };  // integral of 3s² - 2s³
  if (t < ease) return ramp(t / ease);
  if (t > seconds - ease) return seconds - ease - ramp((seconds - t) / ease);
  return 0.5 * ease + (t - ease);
}

/// Gaussian mean over the neighbours of each value, mirrored at the ends so that these stay where they are.
template <class T>
std::vector<T> smoothed(const std::vector<T>& values, double sigma_steps) {
  const int reach = static_cast<int>(std::ceil(3 * sigma_steps)), last = static_cast<int>(values.size()) - 1;
  if (reach < 1 || last < 1) return values;
  std::vector<T> result(values.size());
  for (int i = 0; i <= last; ++i) {
    T sum = 0.0 * values[0];
    double weights = 0;
    for (int k = -reach; k <= reach; ++k) {
      const int at = i + k;
      const T value = at < 0 ? 2.0 * values[0] - values[static_cast<std::size_t>(std::min(-at, last))]
                      : at > last ? 2.0 * values[static_cast<std::size_t>(last)] - values[static_cast<std::size_t>(std::max(2 * last - at, 0))]
                                  : values[static_cast<std::size_t>(at)];
      const double weight = std::exp(-0.5 * (k / sigma_steps) * (k / sigma_steps));
      sum += weight * value;
      weights += weight;
    }
    result[static_cast<std::size_t>(i)] = (1 / weights) * sum;
  }
  return result;
}

/// A polyline that can be asked for the place after so many metres.
class Polyline {
 public:
  explicit Polyline(std::vector<glm::dvec3> points) : points_(std::move(points)), lengths_{0} {
    for (std::size_t i = 1; i < points_.size(); ++i) lengths_.push_back(lengths_.back() + glm::distance(points_[i - 1], points_[i]));
  }
  double length() const { return lengths_.back(); }
  glm::dvec3 at(double metres) const {
    const auto after = std::upper_bound(lengths_.begin(), lengths_.end(), metres);
    if (after == lengths_.begin()) return points_.front();
    if (after == lengths_.end()) return points_.back();
    const std::size_t i = static_cast<std::size_t>(after - lengths_.begin());
    const double part = (metres - lengths_[i - 1]) / (lengths_[i] - lengths_[i - 1]);
    return glm::mix(points_[i - 1], points_[i], part);
  }

 private:
  std::vector<glm::dvec3> points_;
  std::vector<double> lengths_;
};

// Slow looking about: a few sines of periods that never meet.
class HeadTurns {
 public:
  HeadTurns(RandomStream random, double yaw_rad, double pitch_rad) {
    for (int k = 0; k < 3; ++k) {
      yaw_[k] = {yaw_rad / (k + 1.0), random.between(4.0, 6.0) * (1.0 + 0.7 * k), random.between(0.0, kTau)};
      pitch_[k] = {pitch_rad / (k + 1.0), random.between(3.5, 5.5) * (1.0 + 0.6 * k), random.between(0.0, kTau)};
    }
  }
  double yaw(double t) const { return sum(yaw_, t); }
  double pitch(double t) const { return sum(pitch_, t); }

 private:
  struct Wave {
    double amplitude = 0, period_s = 1, phase = 0;
  };
  static double sum(const Wave (&waves)[3], double t) {
    double total = 0;
    for (const Wave& wave : waves) total += wave.amplitude * std::sin(kTau * t / wave.period_s + wave.phase);
    return total;
  }
  Wave yaw_[3], pitch_[3];
};

glm::dquat looking(double yaw, double pitch) {
  return glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0));
}

struct Timing {
  double speed_m_s = 0, seconds = 0, step_s = 0;
  std::size_t frames() const { return static_cast<std::size_t>(std::lround(seconds / step_s)) + 1; }
  double length_m() const { return speed_m_s * eased_distance(seconds, seconds); }
};

// Eyes along `path`, looking where it goes, with head turns on top.
Trace trace_along(const Polyline& path, const Scene& scene, const Timing& timing, const HeadTurns& turns, double gaze_m, double pitch_share) {
  Trace trace;
  trace.scene = scene.name();
  const std::size_t count = timing.frames();
  std::vector<double> yaws, pitches;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = std::min(timing.step_s * static_cast<double>(i), timing.seconds);
    const double metres = timing.speed_m_s * eased_distance(t, timing.seconds);
    // The eye leads: it looks where the body will be a little later.
    const double from = std::min(metres, path.length() - gaze_m);
    const glm::dvec3 ahead = path.at(from + gaze_m) - path.at(from);
    double yaw = std::atan2(-ahead.x, -ahead.z);
    if (!yaws.empty()) yaw += kTau * std::round((yaws.back() - yaw) / kTau);
    yaws.push_back(yaw);
    pitches.push_back(pitch_share * std::atan2(ahead.y, std::hypot(ahead.x, ahead.z)));
    trace.frames.push_back({t, {scene.origin() + path.at(metres), {}}});
  }
  const double sigma = 0.35 / timing.step_s;
  yaws = smoothed(yaws, sigma);
  pitches = smoothed(pitches, sigma);
  for (std::size_t i = 0; i < count; ++i) {
    TraceFrame& frame = trace.frames[i];
    frame.pose.world_from_camera = looking(yaws[i] + turns.yaw(frame.time_s), pitches[i] + turns.pitch(frame.time_s));
  }
  return trace;
}

// Eight directions to set out in, the openest first.
std::vector<double> open_yaws(const FreeSpace& space, const glm::dvec3& from, double reach, RandomStream& random) {
  std::vector<std::pair<double, double>> ways;
  for (int k = 0; k < 8; ++k) {
    const double yaw = kTau * (k + random.unit()) / 8;
    ways.emplace_back(-space.openness(from, {-std::sin(yaw), 0, -std::cos(yaw)}, reach), yaw);
  }
  std::sort(ways.begin(), ways.end());
  std::vector<double> yaws;
  for (const auto& way : ways) yaws.push_back(way.second);
  return yaws;
}

Result<Trace> make_walk(const Scene& scene, const TraceOptions& options, Timing timing, std::uint64_t attempt) {
  const BodyProbe probe(scene, BodyProbe::scale_for(scene));
  const double s = probe.scale();
  const Result<glm::dvec3> eye = standing_point(scene, options.seed + 1000 * attempt);
  if (!eye) return tl::unexpected(eye.error());
  const FreeSpace space{
      [&](const glm::dvec3& before, const glm::dvec3& wanted) -> std::optional<glm::dvec3> {
        // A step of a staircase or a kerb at most, up or down.
        const double step = 0.24 * s;
        const std::optional<double> floor = probe.floor_below(glm::dvec3(wanted.x, before.y + 0.5 * s, wanted.z), 1.0 * s);
        if (!floor || std::abs(*floor - before.y) > step) return std::nullopt;
        const glm::dvec3 there(wanted.x, *floor, wanted.z);
        if (!probe.has_room_to_stand(there)) return std::nullopt;
        return there;
      },
      [&](const glm::dvec3& from, const glm::dvec3& direction, double reach) {
        // The end of the model counts as a wall: beyond it there is nothing to see.
        const double inside = scene.bounds().contains(from + glm::dvec3(0, 0.5 * probe.eye_height_m(), 0)) ? exit_distance(scene.bounds(), from, direction) : 0.0;
        return std::min({inside, probe.free_distance(from + glm::dvec3(0, probe.eye_height_m(), 0), direction, reach),
                         probe.free_distance(from + glm::dvec3(0, 0.5 * probe.eye_height_m(), 0), direction, reach)});
      }};
  PathSearchOptions search;
  search.arc_m *= s, search.step_m *= s, search.tightest_radius_m *= s, search.easy_radius_m *= s, search.lookahead_m *= s;
  const double gaze = 0.7 * s;
  search.length_m = timing.length_m() + gaze + search.arc_m;
  RandomStream random(options.seed, 81, static_cast<int>(attempt));
  const glm::dvec3 floor = *eye - glm::dvec3(0, probe.eye_height_m(), 0);
  Result<std::vector<glm::dvec3>> places = fail(ErrorCode::kNotFound, "no way tried");
  for (const double yaw : open_yaws(space, floor, search.lookahead_m, random)) {
    places = search_path(space, floor, yaw, search, random);
    if (places) break;
  }
  if (!places) return tl::unexpected(places.error());
  std::vector<double> heights;
  for (const glm::dvec3& place : *places) heights.push_back(place.y);
  heights = smoothed(heights, 0.35 * s / search.step_m);
  for (std::size_t i = 0; i < places->size(); ++i) (*places)[i].y = heights[i] + probe.eye_height_m();
  const HeadTurns turns(RandomStream(options.seed, 82), 0.26, 0.05);
  return trace_along(Polyline(std::move(*places)), scene, timing, turns, gaze, 0.3);
}

// A free place for a flight: a standing point raised, or any free place inside the bounds that sees something.
Result<glm::dvec3> floating_point(const Scene& scene, const BodyProbe& probe, double radius, RandomStream random) {
  const Box& bounds = scene.bounds();
  for (int n = 0; n < 4000; ++n) {
    const double spread = n < 2000 ? 0.35 : 0.6;
    glm::dvec3 at = bounds.center();
    for (int axis = 0; axis < 3; ++axis) at[axis] += spread * random.between(-1.0, 1.0) * (bounds.extent()[axis] + radius);
    if (!probe.has_room_to_float(at, 1.3 * radius)) continue;
    const BodyProbe::Outlook outlook = probe.look_around(at);
    if (outlook.hit_share > 0.15 && !(outlook.hit_share > 0.9 && outlook.back_share > 0.7)) return at;
  }
  return fail(ErrorCode::kNotFound, "{}: no free place to fly from found", scene.name());
}

Result<Trace> make_flight(const Scene& scene, const TraceOptions& options, Timing timing, std::uint64_t attempt) {
  const BodyProbe probe(scene, BodyProbe::scale_for(scene));
  const double s = probe.scale(), radius = 0.6 * s;
  RandomStream random(options.seed, 83, static_cast<int>(attempt));
  const Result<glm::dvec3> start = floating_point(scene, probe, radius, random);
  if (!start) return tl::unexpected(start.error());
  const glm::dvec3 extent = scene.bounds().extent();
  const Box limits{scene.bounds().min - 0.15 * extent - 2 * s, scene.bounds().max + 0.15 * extent + 2 * s};
  const FreeSpace space{
      [&](const glm::dvec3&, const glm::dvec3& wanted) -> std::optional<glm::dvec3> {
        if (!limits.contains(wanted) || !probe.has_room_to_float(wanted, radius)) return std::nullopt;
        return wanted;
      },
      [&](const glm::dvec3& from, const glm::dvec3& direction, double reach) {
        if (!limits.contains(from)) return 0.0;
        return std::min(probe.free_distance(from, direction, reach), exit_distance(limits, from, direction));
      }};
  PathSearchOptions search;
  search.arc_m = 2.0 * s, search.step_m = 0.2 * s, search.tightest_radius_m = 1.6 * s, search.easy_radius_m = 3 * s, search.lookahead_m = 25 * s;
  search.climbs = true;
  const double gaze = 1.5 * s;
  search.length_m = timing.length_m() + gaze + search.arc_m;
  Result<std::vector<glm::dvec3>> places = search_path(space, *start, random.between(0.0, kTau), search, random);
  if (!places) return tl::unexpected(places.error());
  const HeadTurns turns(RandomStream(options.seed, 84), 0.15, 0.05);
  return trace_along(Polyline(std::move(*places)), scene, timing, turns, gaze, 0.8);
}

// Around the middle, on a circle outside the scene, looking at its middle.
Trace make_orbit(const Scene& scene, const TraceOptions& options, Timing timing) {
  const glm::dvec3 half = 0.5 * scene.bounds().extent(), middle = scene.bounds().center();
  const double radius = 1.25 * std::hypot(half.x, half.z) + half.y, height = half.y + 0.35 * radius;
  if (!(options.speed_m_s > 0)) timing.speed_m_s = kTau * radius / eased_distance(timing.seconds, timing.seconds);
  const double phase = RandomStream(options.seed, 85).between(0.0, kTau);
  Trace trace;
  trace.scene = scene.name();
  for (std::size_t i = 0; i < timing.frames(); ++i) {
    const double t = std::min(timing.step_s * static_cast<double>(i), timing.seconds);
    const double angle = phase + timing.speed_m_s * eased_distance(t, timing.seconds) / radius;
    const glm::dvec3 offset(radius * std::sin(angle), height, radius * std::cos(angle));
    trace.frames.push_back({t, {scene.origin() + middle + offset, looking(angle, -std::atan2(height, radius))}});
  }
  return trace;
}

}  // namespace

std::optional<TraceKind> trace_kind_of(std::string_view name) {
  if (name == "walk") return TraceKind::kWalk;
  if (name == "fly") return TraceKind::kFly;
  if (name == "orbit") return TraceKind::kOrbit;
  return std::nullopt;
}

const char* trace_kind_name(TraceKind kind) {
  return kind == TraceKind::kWalk ? "walk" : kind == TraceKind::kFly ? "fly" : "orbit";
}

Result<Trace> generate_trace(const Scene& scene, const TraceOptions& options, std::string* note) {
  if (!(options.seconds > 0 && options.seconds <= kLongestSeconds) || !(options.frames_per_second > 0) ||
      options.seconds * options.frames_per_second > kMostFrames) {
    return fail(ErrorCode::kInvalidArgument, "a trace of {} s at {} frames per second: ask for more than 0 s, at most a day and 5 million frames",
                options.seconds, options.frames_per_second);
  }
  if (!(options.speed_m_s >= 0 && options.speed_m_s < 1e6)) {
    return fail(ErrorCode::kInvalidArgument, "speed {} m/s: ask for 0 (natural) to 1e6", options.speed_m_s);
  }
  if (scene.bounds().is_empty()) return fail(ErrorCode::kInvalidArgument, "{}: the scene is empty", scene.name());
  Timing timing{options.speed_m_s, options.seconds, 1 / options.frames_per_second};
  if (options.kind == TraceKind::kOrbit) return make_orbit(scene, options, timing);
  const bool has_speed = options.speed_m_s > 0;
  const double scale = BodyProbe::scale_for(scene);
  constexpr std::uint64_t kAttempts = 6;  // other starting places, should one be a cell without a door
  if (options.kind == TraceKind::kWalk) {
    if (!has_speed) timing.speed_m_s = 1.4 * scale;
    for (std::uint64_t attempt = 0; attempt < kAttempts; ++attempt) {
      Result<Trace> walk = make_walk(scene, options, timing, attempt);
      if (walk) return walk;
      if (note) *note = fmt::format("no walk of this length found ({}): made a flight instead", walk.error().message);
    }
  }
  if (!has_speed) timing.speed_m_s = (options.kind == TraceKind::kWalk ? 1.4 : 4.0) * scale;
  Result<Trace> flight = fail(ErrorCode::kNotFound, "no flight tried");
  for (std::uint64_t attempt = 0; attempt < kAttempts && !flight; ++attempt) flight = make_flight(scene, options, timing, attempt);
  if (!flight) flight.error().message += "; try another seed, a shorter time or --kind orbit";
  return flight;
}

}  // namespace farfield
