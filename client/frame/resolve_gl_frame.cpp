// SPDX-License-Identifier: Apache-2.0
#include "client/frame/resolve_gl_frame.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
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
  float share = 1;  // of its samples that are covered
};

/// Fully covered pixels get their class at once; all others count as uncovered until cracks and voids are decided.
/// Returns: whether some are covered in part. Written for the vectoriser.
bool classify_row(const std::uint32_t* pixels, const float* depth, std::size_t width, float per_metre,
                  std::uint32_t background, std::uint32_t* rgba, float* disparity, Coverage* coverage) {
  constexpr auto kNear = static_cast<std::uint8_t>(Coverage::kNear);
  constexpr auto kImpostor = static_cast<std::uint8_t>(Coverage::kImpostor);
  constexpr auto kBackground = static_cast<std::uint8_t>(Coverage::kBackground);
  std::uint32_t partly = 0;
  for (std::size_t x = 0; x < width; ++x) {
    const std::uint32_t alpha = pixels[x] >> 24;
    const bool is_covered = alpha >= kImpostorAlpha;
    rgba[x] = (is_covered ? pixels[x] : background) | 0xff000000u;
    disparity[x] = is_covered ? depth[x] * per_metre : 0.0f;
    // Averages of both classes lie between the two codes: the rounding decides.
    const std::uint8_t covered = alpha == kNearAlpha ? kNear : kImpostor;
    coverage[x] = static_cast<Coverage>(is_covered ? covered : kBackground);
    partly |= static_cast<std::uint32_t>(!is_covered) & static_cast<std::uint32_t>(alpha > 0);
  }
  return partly != 0;
}

std::vector<PartialPixel> classify(const GlImage& image, const GlResolveOptions& options, Frame& frame) {
  const auto width = static_cast<std::size_t>(image.width);
  const std::uint32_t background =
      options.background.r | std::uint32_t{options.background.g} << 8 | std::uint32_t{options.background.b} << 16;
  std::vector<std::vector<PartialPixel>> partial(static_cast<std::size_t>(image.height));
  tbb::parallel_for(0, image.height, [&](int y) {
    const std::size_t begin = static_cast<std::size_t>(y) * width;
    std::vector<std::uint32_t> pixels(width), rgba(width);  // byte arrays may not be read as words
    std::memcpy(pixels.data(), &image.rgba[4 * begin], 4 * width);
    const bool is_partial =
        classify_row(pixels.data(), &image.depth[begin], width, static_cast<float>(1.0 / image.near_plane_m),
                     background, rgba.data(), &frame.disparity[begin], &frame.coverage[begin]);
    std::memcpy(&frame.rgba[4 * begin], rgba.data(), 4 * width);
    if (!is_partial) return;
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint32_t alpha = pixels[x] >> 24;
      if (alpha == 0 || alpha >= kImpostorAlpha) continue;
      partial[static_cast<std::size_t>(y)].push_back({begin + x, static_cast<float>(alpha) / kNearAlpha});
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
  // A pixel with any sample on a surface is covered. Class and, where the one sample that depth was taken from is empty, disparity are those of a whole neighbour: the
  // one most like this pixel, or the nearest one.
  const float own = image.depth[at] * static_cast<float>(1.0 / image.near_plane_m);
  const auto width = static_cast<std::size_t>(frame.width);
  const std::size_t column = at % width;
  float best = -1;
  Coverage coverage = Coverage::kImpostor;
  const auto consider = [&](std::size_t neighbour) {
    if (frame.coverage[neighbour] != Coverage::kNear && frame.coverage[neighbour] != Coverage::kImpostor) return;
    const float d = frame.disparity[neighbour];
    if (best >= 0 && (own > 0 ? std::fabs(d - own) >= std::fabs(best - own) : d <= best)) return;
    best = d, coverage = frame.coverage[neighbour];
  };
  if (column > 0) consider(at - 1);
  if (column + 1 < width) consider(at + 1);
  if (at >= width) consider(at - width);
  if (at + width < frame.pixels()) consider(at + width);
  frame.disparity[at] = own > 0 ? own : std::max(best, 0.0f);
  frame.coverage[at] = coverage;
}

}  // namespace

void resolve_gl_frame(const GlImage& image, const GlResolveOptions& options, Frame& frame) {
  frame.width = image.width, frame.height = image.height;
  frame.rgba.resize(4 * frame.pixels());
  frame.disparity.resize(frame.pixels());
  frame.coverage.resize(frame.pixels());
  const std::vector<PartialPixel> partial = classify(image, options, frame);
  const auto count = [&](Coverage c) {
    return static_cast<std::uint64_t>(std::count(frame.coverage.begin(), frame.coverage.end(), c));
  };
  frame.statistics.crack_pixels = frame.statistics.void_pixels = frame.statistics.background_pixels = 0;
  if (count(Coverage::kBackground) == 0) return;  // indoors, mostly
  close_mesh_cracks(frame);
  fill_voids(frame, options.sky, options.void_radius);
  for (const PartialPixel& pixel : partial) mix_partial(image, pixel, frame);
  frame.statistics.crack_pixels = count(Coverage::kCrackClosed);
  frame.statistics.void_pixels = count(Coverage::kVoidFilled);
  frame.statistics.background_pixels = count(Coverage::kBackground);
}

}  // namespace farfield::client
