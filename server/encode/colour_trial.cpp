// SPDX-License-Identifier: Apache-2.0
#include "server/encode/colour_trial.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/codec/colour_codec.h"
#include "common/math/cube_face.h"
#include "server/visibility/sphere_rays.h"

namespace farfield {
namespace {

// Each step of the quantiser a sixth larger than the next.
constexpr int kQualities[] = {kCoarsestQuality, 12, 14, 17, 20, 24, 29, 35, 42, 50, 58, 65, 71, 76, 80, 83, 86, 88, 90, kFinestQuality};

// A uniform quantiser's error is step²/12 a sample and falls by 6 dB a bit: ln 4/12 step² for a bit at the last, eight times that
// for a byte. The mean over a tile's channels and frequencies, of which many are not sent, was measured to be 0.85 of it (0.4 to 1.1 in
// 12 shells of three scenes).
constexpr double kErrorOfByte = 0.85 * 8 * 1.3862943611198906 / 12;

// Steradians of each covered sample, by its place on the face.
std::vector<float> sample_angles(const Tile& tile) {
  const double pitch = sample_pitch(tile.edge_samples);
  const auto angle_at = [&](int i, int j) {
    const double u = sample_tangent(tile.edge_samples, i), v = sample_tangent(tile.edge_samples, j);
    return static_cast<float>(sample_solid_angle(u, v, pitch));
  };
  std::vector<float> angles(tile.samples(), 0);
  for (int y = 0; y < tile.height; ++y)
    for (int x = 0; x < tile.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * tile.width + x;
      if (!tile.coverage[at]) continue;
      if (!tile.is_packed()) {
        angles[at] = angle_at(tile.id.x * kTileStride + x, tile.id.y * kTileStride + y);
        continue;
      }
      const BlockPlace block = tile.blocks[static_cast<std::size_t>(y / kBlockSamples) * kPackedColumns + x / kBlockSamples];
      angles[at] = angle_at(block.x * kBlockSamples + x % kBlockSamples, block.y * kBlockSamples + y % kBlockSamples);
    }
  return angles;
}

}  // namespace

ColourTrial::ColourTrial(const Tile& tile)
    : tile_(tile), bits_(tile), surfaces_(find_surfaces(tile, bits_)), differences_(tile.rgb), angles_(sample_angles(tile)) {
  bases_ = take_out_base_colours(surfaces_, differences_);
  std::array<double, 3> sum{}, squares{};
  for (std::size_t at = 0; at < tile.samples(); ++at) {
    covered_ += tile.coverage[at];
    solid_angle_ += angles_[at];
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = tile.rgb[3 * at + c];
      sum[c] += angles_[at] * value, squares[c] += angles_[at] * value * value;
    }
  }
  for (std::size_t c = 0; c < 3; ++c) spread_ += (squares[c] - sum[c] * sum[c] / solid_angle_) / 3;
}

ColourOutcome ColourTrial::at(int quality) {
  const auto [found, is_new] = tried_.try_emplace(quality);
  ColourOutcome& outcome = found->second;
  if (!is_new) return outcome;
  std::vector<std::uint8_t> decoded;
  const Bytes coded = encode_colour(differences_, bits_, quality, &decoded);
  put_back_base_colours(bases_, surfaces_, decoded);
  outcome.bytes = static_cast<double>(coded.size() + bases_.size());
  for (std::size_t at = 0; at < tile_.samples(); ++at) {
    if (!tile_.coverage[at]) continue;
    int squares = 0;
    for (std::size_t c = 3 * at; c < 3 * at + 3; ++c) {
      const int difference = int{tile_.rgb[c]} - int{decoded[c]};
      squares += difference * difference;
    }
    outcome.error += angles_[at] * squares / 3.0;
  }
  return outcome;
}

int ColourTrial::best_quality(double slope, double weight) {
  const double angle = solid_angle_ / static_cast<double>(covered_);
  const double step = std::sqrt(slope / (kErrorOfByte * weight * angle));
  const auto cost = [&](int index) {
    const ColourOutcome outcome = at(kQualities[index]);
    return weight * outcome.error + slope * outcome.bytes;
  };
  constexpr int kLast = static_cast<int>(std::size(kQualities)) - 1;
  const auto is_coarser = [](int quality, double wanted) { return colour_step(quality) > wanted; };
  int best = std::min(static_cast<int>(std::lower_bound(std::begin(kQualities), std::end(kQualities), step, is_coarser) - std::begin(kQualities)), kLast);
  double least = cost(best);
  const int start = best;
  for (const int direction : {1, -1}) {
    if (best != start) break;
    for (int next = best + direction; next >= 0 && next <= kLast; next += direction) {
      const double here = cost(next);
      if (here >= least) break;
      least = here, best = next;
    }
  }
  return kQualities[best];
}

double slope_of_quality(int quality, int edge_samples) {
  constexpr double kMeanAngle = 0.5235987755982988;  // of a face's samples, in squares of their pitch: 4π/6 over 2²
  const double step = colour_step(quality), pitch = sample_pitch(edge_samples);
  return kErrorOfByte * step * step * kMeanAngle * pitch * pitch;
}

}  // namespace farfield
