// SPDX-License-Identifier: Apache-2.0
// Vectorised code against the same written one value after another. Both round alike (no contraction, no reassociation:
// deploy/cmake/toolchain.cmake), so results are bit-identical; averages of four samples go through tables and have a bound.
#include <algorithm>
#include <bit>
#include <cstring>
#include <random>

#include "client/warp/average_samples.h"
#include "client/warp/hidden_pixels.h"
#include "client/warp/write_pixels.h"
#include "common/shading/shading.h"
#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"

namespace farfield::stability {
namespace {

using namespace client;

// Whole frames, by both kernels, from eyes in the leaf and on its corners.
StressRow frames(const Effort& effort) {
  const auto scene = build_scene(hall_model());
  const ImpostorSettings settings = hall_settings();
  const ImpostorSources sources = make_impostor_sources(scene, settings);
  const Visit there = visit(scene, sources, settings, kHallEyes[0] - scene->origin(), effort.is_full ? 10000 : 60);
  CpuWarper vector({.samples_per_pixel = 1, .threads = 1}),
      scalar({.samples_per_pixel = 1, .threads = 1, .kernel = ProjectionKernel::kScalar});
  WorstError worst;
  for (int k = 0; k < (effort.is_full ? 27 : 9); ++k) {
    const glm::dvec3 share(0.5 * (k % 3), 0.5 * (k / 3 % 3), 0.5 * (k / 9 % 3));
    const Pose eye{there.view.leaf_box.min + there.view.leaf_box.extent() * share,
                   glm::angleAxis(0.7 * k, glm::normalize(glm::dvec3(1, 4, 2)))};
    for (const double fovy_deg : {1.0, 60.0, 170.0}) {
      Frame a, b;
      const Display display{257, 143, fovy_deg * 3.14159265358979323846 / 180};
      vector.draw(there.view, eye, display, nullptr, a);
      scalar.draw(there.view, eye, display, nullptr, b);
      for (std::size_t p = 0; p < a.pixels(); ++p)
        worst.count(!std::equal(&a.rgba[4 * p], &a.rgba[4 * p] + 4, &b.rgba[4 * p]) || a.coverage[p] != b.coverage[p] ||
                    std::bit_cast<std::uint32_t>(a.disparity[p]) != std::bit_cast<std::uint32_t>(b.disparity[p]));
    }
  }
  return worst.row("frames of the CPU warper, vector code", "scalar code", "pixels that differ", 0);
}

// Single rows at the ends of floats' range: infinity, denormals, the eye's plane, splats of no and of any size.
StressRow extreme_rows(const Effort& effort) {
  std::mt19937 random(1);
  const float ends[] = {0.0f, -0.0f, 1e-45f, -1e-45f, 1e-38f, 1e-30f, -1e-20f, 1.0f, -1.0f, 0.5f, 1e10f, -1e20f, 1e30f, 3e38f};
  const auto any = [&](float low, float high) {
    return random() % 4 == 0 ? ends[random() % std::size(ends)] : std::uniform_real_distribution<float>(low, high)(random);
  };
  RowSamples samples;
  std::array<float, kRowPiece> disparity, slope_u, slope_v;
  std::array<std::uint16_t, kRowPiece> reach;
  std::array<std::uint32_t, kRowPiece> colour;
  samples.disparity = disparity.data(), samples.slope_u = slope_u.data(), samples.slope_v = slope_v.data();
  samples.reach = reach.data();
  samples.colour = samples.colour_left = samples.colour_right = samples.colour_up = samples.colour_down = colour.data();
  const auto vector = std::make_unique<ProjectedRow>(), scalar = std::make_unique<ProjectedRow>();
  const auto vector_pixels = std::make_unique<SplatPixels>(), scalar_pixels = std::make_unique<SplatPixels>();
  const PixelWindow window{200, 40, 120};
  WorstError worst;
  for (int trial = 0; trial < (effort.is_full ? 20000 : 1000); ++trial) {
    RowProjection row;
    row.disparity_scale = std::abs(any(0.01f, 10));
    for (int k = 0; k < 3; ++k) row.per_disparity[k] = any(-100, 100), row.step_u[k] = any(-3, 3), row.step_v[k] = any(-3, 3);
    samples.count = 1 + static_cast<int>(random() % kRowPiece);
    for (int i = 0; i < kRowPiece; ++i) {
      samples.infinity_x[i] = any(-200, 400), samples.infinity_y[i] = any(-200, 400), samples.infinity_w[i] = any(-1, 2);
      disparity[i] = std::abs(any(0, 0.6f)), slope_u[i] = any(-0.01f, 0.01f), slope_v[i] = any(-0.01f, 0.01f);
      reach[i] = static_cast<std::uint16_t>(random()), colour[i] = static_cast<std::uint32_t>(random()) & 0xffffff;
    }
    project_row(row, window, samples, *vector);
    project_row_scalar(row, window, samples, *scalar);
    worst.count(vector->second_column != scalar->second_column || vector->second_line != scalar->second_line);
    for (int i = 0; i < samples.count; ++i) {
      const bool lands = vector->bottom[i] >= vector->top[i];
      worst.count(lands != (scalar->bottom[i] >= scalar->top[i]));
      if (!lands) continue;
      worst.count(vector->left[i] != scalar->left[i] || vector->right[i] != scalar->right[i] || vector->top[i] != scalar->top[i] ||
                  vector->bottom[i] != scalar->bottom[i] || vector->wide[i] != scalar->wide[i]);
      worst.count(vector->left[i] < 0 || vector->right[i] >= window.width || vector->top[i] < window.top ||
                  vector->bottom[i] >= window.bottom);
    }
    for (int pixel = 0; pixel < 4; ++pixel) {
      sample_pixels(*vector, samples, window.width, pixel & 1, pixel >> 1, *vector_pixels);
      sample_pixels_scalar(*scalar, samples, window.width, pixel & 1, pixel >> 1, *scalar_pixels);
      for (int i = 0; i < samples.count; ++i) {
        worst.count(vector_pixels->offset[i] != scalar_pixels->offset[i]);
        if (vector_pixels->offset[i] < 0) continue;
        worst.count(vector_pixels->high[i] != scalar_pixels->high[i] || vector_pixels->low[i] != scalar_pixels->low[i]);
      }
    }
  }
  return worst.row("samples at the ends of floats' range, vector code", "scalar code", "values that differ", 0);
}

StressRow writing_pixels(const Effort& effort) {
  std::mt19937 random(2);
  const auto pixels = std::make_unique<SplatPixels>();
  RowIndices hits;
  WorstError worst;
  for (int trial = 0; trial < (effort.is_full ? 20000 : 2000); ++trial) {
    std::vector<std::uint64_t> keys(97), expected(97);
    for (std::uint64_t& key : keys)
      key = random() % 2 ? 0 : make_key(key_high(std::ldexp(1.0f, -static_cast<int>(random() % 150))), random() & 0xffffff);
    expected = keys;
    const int count = static_cast<int>(random() % (kRowPiece + 1));
    for (int i = 0; i < kRowPiece; ++i) {
      pixels->offset[i] = static_cast<int>(random() % 140) - 43;
      if (pixels->offset[i] < 0) pixels->offset[i] = -1;
      pixels->high[i] = key_high(std::ldexp(static_cast<float>(random() % 1000), -static_cast<int>(random() % 158)));
      pixels->low[i] = static_cast<std::uint32_t>(random()) & 0xffffff;
      if (i < count && pixels->offset[i] >= 0) {
        std::uint64_t& cell = expected[static_cast<std::size_t>(pixels->offset[i])];
        cell = std::max(cell, make_key(pixels->high[i], pixels->low[i]));
      }
    }
    write_pixels(*pixels, count, hits, keys.data());
    for (std::size_t k = 0; k < keys.size(); ++k) worst.count(keys[k] != expected[k]);
    const std::uint64_t bound = keys[random() % keys.size()] + random() % 2;
    const int from = static_cast<int>(random() % 40), some = static_cast<int>(random() % 57);
    worst.count(any_smaller(&keys[static_cast<std::size_t>(from)], some, bound) != std::any_of(&keys[static_cast<std::size_t>(from)],
                                                                                               &keys[static_cast<std::size_t>(from)] + some,
                                                                                               [&](auto key) { return key < bound; }));
  }
  return worst.row("writing pixels and asking what is hidden, vector code", "one after another", "keys that differ", 0);
}

// The mean of four samples in linear light. Tables hold linear light in 16 bits (half a unit off each, so is the mean) and
// codes for 2^14 steps of it (two units of 16 bits off); near black, where codes are steepest, a code is 20 units
// (65535/(255·12.92)), elsewhere more: the code is off by less than a half plus 2.5/20, so by one at most after rounding.
StressRow averages() {
  std::mt19937 random(3);
  Frame fine, frame;
  fine.width = fine.height = 512;
  fine.rgba.resize(4 * fine.pixels()), fine.disparity.resize(fine.pixels()), fine.coverage.resize(fine.pixels());
  for (std::size_t p = 0; p < fine.pixels(); ++p) {
    const unsigned spread = 1u << (p / 2 % 9);
    const unsigned base = static_cast<unsigned>(random() % 256);
    for (int c = 0; c < 4; ++c)
      fine.rgba[4 * p + static_cast<std::size_t>(c)] =
          static_cast<std::uint8_t>(std::min(255u, base / spread + static_cast<unsigned>(random()) % spread));
  }
  average_samples(fine, frame);
  WorstError worst;
  const auto linear = [](std::uint8_t code) {
    const long double c = code / 255.0L;
    return c <= 0.04045L ? c / 12.92L : std::pow((c + 0.055L) / 1.055L, 2.4L);
  };
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x)
      for (int c = 0; c < 3; ++c) {
        long double sum = 0;
        for (int k = 0; k < 4; ++k)
          sum += linear(fine.rgba[4 * (static_cast<std::size_t>(2 * y + k / 2) * 512 + static_cast<std::size_t>(2 * x + k % 2)) +
                                  static_cast<std::size_t>(c)]);
        const long double mean = sum / 4, code = mean <= 0.0031308L ? 12.92L * mean : 1.055L * std::pow(mean, 1 / 2.4L) - 0.055L;
        worst.add(static_cast<double>(
            frame.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(x)) +
                       static_cast<std::size_t>(c)] -
            255 * code));
      }
  return worst.row("averages of 2×2 samples", "long double", "codes", 0.5 + 2.5 / 20);
}

}  // namespace

Rows stress_kernels(const Effort& effort) {
  return {frames(effort), extreme_rows(effort), writing_pixels(effort), averages()};
}

}  // namespace farfield::stability
