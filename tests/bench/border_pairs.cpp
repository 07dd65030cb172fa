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

void add_evenly(const std::vector<std::size_t>& from, std::size_t count, bool is_crossing, std::vector<BorderPair>& out) {
  count = std::min(count, from.size());
  for (std::size_t k = 0; k < count; ++k) out.push_back({from[(2 * k + 1) * from.size() / (2 * count)], is_crossing});
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
  std::vector<BorderPair> pairs;
  add_evenly(crossing, count, true, pairs);
  add_evenly(inside, count, false, pairs);
  std::sort(pairs.begin(), pairs.end(), [](const BorderPair& a, const BorderPair& b) { return a.step < b.step; });
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
  for (const Pose& pose : poses_)
    trace.frames.push_back({static_cast<double>(trace.frames.size()), {pose.position + scene_origin_, pose.world_from_camera}});
  return trace;
}

Result<BorderFlip> BorderPairs::judge(const Display& display,
                                      const std::function<Result<std::vector<std::uint8_t>>(std::size_t)>& rgb_of) const {
  std::vector<double> crossing, inside;
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
    (pairs_[p].is_crossing ? crossing : inside).push_back(std::abs(error[1] - error[0]));
  }
  return BorderFlip{percentile(inside, 0.99), percentile(crossing, 0.99)};
}

}  // namespace farfield::bench
