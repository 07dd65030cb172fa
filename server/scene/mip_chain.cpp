// SPDX-License-Identifier: Apache-2.0
#include "server/scene/mip_chain.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/shading/shading.h"

namespace farfield {
namespace {

// A texel without any alpha still weighs this much, so that a region that is all hole keeps its colour; it is below
// one alpha code, so it never shows beside a texel that is there.
constexpr float kHoleWeight = 1.0f / 4096;

// Linear colour × weight, and the weight: alpha + kHoleWeight.
struct LinearImage {
  int width = 0, height = 0;
  std::vector<glm::vec4> texels;
};

LinearImage to_linear(const TextureImage& image, bool keeps_alpha) {
  LinearImage out{image.width, image.height, {}};
  out.texels.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  std::array<float, 256> linear;
  for (int code = 0; code < 256; ++code) linear[code] = srgb_to_linear(static_cast<std::uint8_t>(code));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.texels.size(), 1 << 14),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        const std::uint8_t* p = &image.rgba[4 * i];
                        const float weight = (keeps_alpha ? p[3] / 255.0f : 1.0f) + kHoleWeight;
                        out.texels[i] = {linear[p[0]] * weight, linear[p[1]] * weight, linear[p[2]] * weight, weight};
                      }
                    });
  return out;
}

// The source texels one target texel covers along an axis, with their shares: at most 4 (a half of 3 is 1).
struct Taps {
  int first = 0, count = 0;
  float share[4];
};

Taps taps_of(int target, int target_size, int source_size) {
  Taps taps;
  const double begin = static_cast<double>(target) * source_size / target_size;
  const double end = static_cast<double>(target + 1) * source_size / target_size;
  taps.first = static_cast<int>(begin);
  for (int s = taps.first; s < source_size && s < end && taps.count < 4; ++s) {
    const double covered = std::min<double>(s + 1, end) - std::max<double>(s, begin);
    taps.share[taps.count++] = static_cast<float>(covered / (end - begin));
  }
  return taps;
}

LinearImage halved(const LinearImage& source) {
  LinearImage out{std::max(1, source.width / 2), std::max(1, source.height / 2), {}};
  out.texels.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
  std::vector<Taps> columns;
  for (int x = 0; x < out.width; ++x) columns.push_back(taps_of(x, out.width, source.width));
  tbb::parallel_for(0, out.height, [&](int y) {
    const Taps rows = taps_of(y, out.height, source.height);
    for (int x = 0; x < out.width; ++x) {
      glm::vec4 sum{0};
      for (int j = 0; j < rows.count; ++j) {
        const glm::vec4* row =
            &source.texels[static_cast<std::size_t>(rows.first + j) * static_cast<std::size_t>(source.width)];
        for (int i = 0; i < columns[x].count; ++i)
          sum += row[columns[x].first + i] * (rows.share[j] * columns[x].share[i]);
      }
      out.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(x)] = sum;
    }
  });
  return out;
}

constexpr int kAlphaBins = 1024;

// histogram[i]: how many texels have alpha in bin i.
std::vector<std::size_t> alpha_histogram(const LinearImage& image) {
  std::vector<std::size_t> histogram(kAlphaBins + 1, 0);
  for (const glm::vec4& t : image.texels)
    ++histogram[static_cast<std::size_t>(
        std::clamp((t.w - kHoleWeight) * kAlphaBins, 0.0f, static_cast<float>(kAlphaBins)))];
  return histogram;
}

double share_from(const std::vector<std::size_t>& histogram, int bin, std::size_t texels) {
  std::size_t count = 0;
  for (int i = bin; i <= kAlphaBins; ++i) count += histogram[static_cast<std::size_t>(i)];
  return static_cast<double>(count) / static_cast<double>(texels);
}

// The factor on alpha that makes the share of texels at or above the cutoff come closest to `coverage`.
float alpha_scale(const LinearImage& image, float cutoff, double coverage) {
  if (coverage <= 0 || coverage >= 1 || cutoff <= 0) return 1.0f;
  const std::vector<std::size_t> histogram = alpha_histogram(image);
  int best = static_cast<int>(std::lround(cutoff * kAlphaBins));
  double best_error = std::abs(share_from(histogram, best, image.texels.size()) - coverage);
  std::size_t above = 0;
  for (int bin = kAlphaBins; bin >= 1; --bin) {
    above += histogram[static_cast<std::size_t>(bin)];
    const double error = std::abs(static_cast<double>(above) / static_cast<double>(image.texels.size()) - coverage);
    if (error < best_error) {
      best_error = error;
      best = bin;
    }
  }
  return cutoff * kAlphaBins / static_cast<float>(std::max(best, 1));
}

MipLevel to_codes(const LinearImage& image, float scale) {
  MipLevel level{image.width, image.height, {}};
  level.texels.resize(image.texels.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, image.texels.size(), 1 << 14),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        const glm::vec4 t = image.texels[i];
                        const float alpha = std::clamp((t.w - kHoleWeight) * scale, 0.0f, 1.0f);
                        level.texels[i] = linear_to_srgb(t.x / t.w) | linear_to_srgb(t.y / t.w) << 8 |
                                          linear_to_srgb(t.z / t.w) << 16 |
                                          static_cast<std::uint32_t>(std::lround(alpha * 255.0f)) << 24;
                      }
                    });
  return level;
}

}  // namespace

std::vector<MipLevel> build_mip_chain(const TextureImage& image, const MipOptions& options) {
  LinearImage linear = to_linear(image, options.keeps_alpha);
  while (std::max(linear.width, linear.height) > options.largest_edge) linear = halved(linear);
  const int cutoff_bin = static_cast<int>(std::lround(options.alpha_cutoff * kAlphaBins));
  const double coverage =
      options.keeps_alpha ? share_from(alpha_histogram(linear), cutoff_bin, linear.texels.size()) : 1.0;
  std::vector<MipLevel> chain;
  chain.push_back(to_codes(linear, 1.0f));
  while (linear.width > 1 || linear.height > 1) {
    linear = halved(linear);
    chain.push_back(to_codes(linear, alpha_scale(linear, options.alpha_cutoff, coverage)));
  }
  return chain;
}

}  // namespace farfield
