// SPDX-License-Identifier: Apache-2.0
#include "client/frame/resolve_gl_frame.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>

#include "client/frame/close_mesh_cracks.h"
#include "client/near/surface_program.h"
#include "client/warp/fill_voids.h"
#include "client/warp_gl/impostor_renderer.h"
#include "common/shading/shading.h"

namespace farfield::client {
namespace {

struct PartialPixel {
  std::size_t at = 0;
  float share = 1;      // of its samples that are covered
};

/// Fully covered pixels get their class at once; all others count as uncovered until cracks and voids are decided.
std::vector<PartialPixel> classify(const GlImage& image, const GlResolveOptions& options, Frame& frame) {
  const auto width = static_cast<std::size_t>(image.width);
  const auto per_metre = static_cast<float>(1.0 / image.near_plane_m);
  const std::uint8_t background[4] = {options.background.r, options.background.g, options.background.b, 255};
  std::vector<std::vector<PartialPixel>> partial(static_cast<std::size_t>(image.height));
  tbb::parallel_for(0, image.height, [&](int y) {
    for (std::size_t at = static_cast<std::size_t>(y) * width, end = at + width; at < end; ++at) {
      const std::uint8_t alpha = image.rgba[4 * at + 3];
      std::memcpy(&frame.rgba[4 * at], &image.rgba[4 * at], 3);
      frame.rgba[4 * at + 3] = 255;
      frame.disparity[at] = image.depth[at] * per_metre;
      if (alpha >= kImpostorAlpha) {
        // Averages of both classes lie between the two codes: the rounding decides.
        frame.coverage[at] = alpha == kNearAlpha ? Coverage::kNear : Coverage::kImpostor;
        continue;
      }
      frame.coverage[at] = Coverage::kBackground;
      frame.disparity[at] = 0;
      std::memcpy(&frame.rgba[4 * at], background, 4);
      if (alpha > 0) partial[static_cast<std::size_t>(y)].push_back({at, alpha / static_cast<float>(kNearAlpha)});
    }
  });
  std::vector<PartialPixel> all;
  for (const auto& row : partial) all.insert(all.end(), row.begin(), row.end());
  return all;
}

void mix_partial(const GlImage& image, const PartialPixel& pixel, Frame& frame) {
  const std::size_t at = pixel.at;
  for (std::size_t c = 0; c < 3; ++c) {
    // The average over all samples already holds the covered ones' share; empty samples are black.
    const float covered = srgb_to_linear(image.rgba[4 * at + c]);
    frame.rgba[4 * at + c] = linear_to_srgb(covered + (1 - pixel.share) * srgb_to_linear(frame.rgba[4 * at + c]));
  }
  if (pixel.share < 0.5f) return;
  if (image.depth[at] > 0) frame.disparity[at] = image.depth[at] * static_cast<float>(1.0 / image.near_plane_m);
  // Near and impostor alphas differ by one code in 254: what is missing is the share of empty samples, which a
  // mixture cannot tell from one more or less; the majority of silhouettes against nothing are impostors'.
  frame.coverage[at] = Coverage::kImpostor;
}

}  // namespace

void resolve_gl_frame(const GlImage& image, const GlResolveOptions& options, Frame& frame) {
  frame.width = image.width, frame.height = image.height;
  frame.rgba.resize(4 * frame.pixels());
  frame.disparity.resize(frame.pixels());
  frame.coverage.resize(frame.pixels());
  const std::vector<PartialPixel> partial = classify(image, options, frame);
  close_mesh_cracks(frame);
  fill_voids(frame, options.sky, options.void_radius);
  for (const PartialPixel& pixel : partial) mix_partial(image, pixel, frame);

  const auto count = [&](Coverage c) {
    return static_cast<std::uint64_t>(std::count(frame.coverage.begin(), frame.coverage.end(), c));
  };
  frame.statistics.crack_pixels = count(Coverage::kCrackClosed);
  frame.statistics.void_pixels = count(Coverage::kVoidFilled);
  frame.statistics.background_pixels = count(Coverage::kBackground);
}

}  // namespace farfield::client
