// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/border_pairs.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "common/image/flip.h"
#include "tests/bench/distribution.h"

namespace farfield::bench {
namespace {

constexpr double kStepSeconds = 1.0 / 60;  // between frames of a common display

std::vector<std::size_t> pick_evenly(const std::vector<std::size_t>& from, std::size_t count) {
  count = std::min(count, from.size());
  std::vector<std::size_t> picked;
  for (std::size_t k = 0; k < count; ++k) picked.push_back(from[(2 * k + 1) * from.size() / (2 * count)]);
  return picked;
}

std::filesystem::path truth_path(const ScratchFolder& folder, std::size_t index) {
  return folder.path() / fmt::format("truth_{:05d}.rgb", index);
}

Status write_bytes(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) return fail(ErrorCode::kIo, "{}: cannot be written (is the disk full?)", file.string());
  return {};
}

}  // namespace

std::vector<BorderPair> pick_border_pairs(std::span<const CellId> leaf_of_step, std::size_t count) {
  std::vector<std::size_t> crossing, inside;
  for (std::size_t k = 0; k + 1 < leaf_of_step.size(); ++k) (leaf_of_step[k] == leaf_of_step[k + 1] ? inside : crossing).push_back(k);
  using Place = BorderPair::Place;
  // One place after the other, so that what belongs to a crossing follows it.
  std::vector<BorderPair> places;
  for (const std::size_t step : pick_evenly(crossing, count)) places.push_back({step, Place::kCrossing});
  for (const std::size_t step : pick_evenly(inside, count)) places.push_back({step, Place::kInside});
  std::sort(places.begin(), places.end(), [](const BorderPair& a, const BorderPair& b) { return a.step < b.step; });
  std::vector<BorderPair> pairs;
  for (const BorderPair& place : places) {
    pairs.push_back(place);
    const std::size_t after = place.step + kStepsAfterCrossing;
    if (place.place == Place::kCrossing && after + 1 < leaf_of_step.size()) pairs.push_back({after, Place::kAfterCrossing});
  }
  return pairs;
}

Result<BorderPairs> BorderPairs::create(const Scene& scene, const ViewerCells& cells, const Trace& trace, std::size_t count,
                                        const Display& display, int truth_samples) {
  Result<ScratchFolder> folder = ScratchFolder::create();
  if (!folder) return tl::unexpected(folder.error());
  BorderPairs result(std::move(*folder));
  result.scene_origin_ = scene.origin();
  const auto steps = static_cast<std::size_t>(std::floor(trace.seconds() / kStepSeconds)) + 1;
  const auto pose_of = [&](std::size_t step) {
    Pose pose = pose_at(trace, trace.frames.front().time_s + kStepSeconds * static_cast<double>(step));
    pose.position -= scene.origin();
    return pose;
  };
  std::vector<CellId> leaves;
  for (std::size_t step = 0; step < steps; ++step) leaves.push_back(cells.leaf_at(pose_of(step).position));
  result.pairs_ = pick_border_pairs(leaves, count);
  for (const BorderPair& pair : result.pairs_)
    for (const std::size_t step : {pair.step, pair.step + 1}) {
      const Pose eye = pose_of(step);
      const ReferenceImage truth = render_reference(scene, eye, display, truth_samples);
      if (Status status = write_bytes(truth_path(result.folder_, result.poses_.size()), truth.rgb); !status)
        return tl::unexpected(status.error());
      result.poses_.push_back(eye);
    }
  return result;
}

Trace BorderPairs::trace() const {
  Trace trace;
  double start_s = 0;         // of a place
  std::size_t first_step = 0;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (pairs_[p].place != BorderPair::Place::kAfterCrossing) {
      start_s = trace.frames.empty() ? 0 : trace.frames.back().time_s + 1;
      first_step = pairs_[p].step;
    }
    for (const std::size_t side : {0, 1}) {
      const Pose& pose = poses_[2 * p + side];
      const double time_s = start_s + kStepSeconds * static_cast<double>(pairs_[p].step + side - first_step);
      trace.frames.push_back({time_s, {pose.position + scene_origin_, pose.world_from_camera}});
    }
  }
  return trace;
}

Result<BorderFlip> BorderPairs::judge(const Display& display,
                                      const std::function<Result<std::vector<std::uint8_t>>(std::size_t)>& rgb_of) const {
  std::array<std::vector<double>, 3> changes;  // by place
  Image8 wanted(display.width, display.height, 3), seen = wanted;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    double error[2];
    for (const std::size_t side : {0, 1}) {
      const std::size_t index = 2 * p + side;
      std::ifstream in(truth_path(folder_, index), std::ios::binary);
      in.read(reinterpret_cast<char*>(wanted.values.data()), static_cast<std::streamsize>(wanted.values.size()));
      if (!in) return fail(ErrorCode::kIo, "{}: cannot be read", truth_path(folder_, index).string());
      Result<std::vector<std::uint8_t>> rgb = rgb_of(index);
      if (!rgb) return tl::unexpected(rgb.error());
      seen.values = std::move(*rgb);
      error[side] = flip(wanted, seen).mean;
    }
    changes[static_cast<std::size_t>(pairs_[p].place)].push_back(std::abs(error[1] - error[0]));
  }
  const auto p99 = [&](BorderPair::Place place) { return percentile(changes[static_cast<std::size_t>(place)], 0.99); };
  return BorderFlip{p99(BorderPair::Place::kInside), p99(BorderPair::Place::kCrossing), p99(BorderPair::Place::kAfterCrossing)};
}

}  // namespace farfield::bench
