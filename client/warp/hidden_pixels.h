// SPDX-License-Identifier: Apache-2.0
// Whether all pixels of a rectangle already show something nearer than what is still to be drawn there.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#if defined(__AVX512F__)
#include <immintrin.h>
#endif

#include "client/warp/splat_key.h"

namespace farfield::client {

/// Pixels [left, right] × [top, bottom].
struct PixelRectangle {
  int left = 0, right = -1, top = 0, bottom = -1;
};

/// Whether one of `count` keys is smaller than `bound`.
inline bool any_smaller(const std::uint64_t* keys, int count, std::uint64_t bound) {
#if defined(__AVX512F__)
  const __m512i bounds = _mm512_set1_epi64(static_cast<long long>(bound));
  for (int i = 0; i < count; i += 8) {
    const auto some = static_cast<__mmask8>(count - i >= 8 ? 0xff : (1 << (count - i)) - 1);
    const __m512i eight = _mm512_maskz_loadu_epi64(some, keys + i);
    if (_mm512_mask_cmplt_epu64_mask(some, eight, bounds) != 0) return true;
  }
  return false;
#else
  return std::any_of(keys, keys + count, [&](std::uint64_t key) { return key < bound; });
#endif
}

/// Keys with larger upper halves hide anything with an eye disparity up to `nearest`, but for the roundings on the way to it:
/// 2⁻²⁰ covers up to 16 of them.
inline std::uint32_t largest_high(float nearest) { return key_high(std::max(nearest * (1 + 0x1p-20f), 0.0f)); }
inline std::uint64_t largest_key(float nearest) { return make_key(largest_high(nearest), ~0u); }

/// At most so many numbers not_above() compares at once.
inline constexpr int kCells = 16;

/// Bit k: values[k] is not above the bound. Requires: `count` is 1 to kCells.
inline std::uint32_t not_above(const std::uint32_t* values, int count, std::uint32_t bound) {
#if defined(__AVX512F__)
  const auto some = static_cast<__mmask16>((1u << count) - 1);
  return _mm512_mask_cmple_epu32_mask(some, _mm512_maskz_loadu_epi32(some, values), _mm512_set1_epi32(static_cast<int>(bound)));
#else
  std::uint32_t bits = 0;
  for (int k = 0; k < count; ++k) bits |= static_cast<std::uint32_t>(values[k] <= bound) << k;
  return bits;
#endif
}

/// Whether one of the pixels' keys is smaller than `bound`.
inline bool any_smaller_in(const PixelRectangle& pixels, std::uint64_t bound, int width, const std::uint64_t* keys) {
  for (int line = pixels.top; line <= pixels.bottom; ++line) {
    const std::uint64_t* cells = keys + static_cast<std::size_t>(line) * static_cast<std::size_t>(width);
    if (any_smaller(cells + pixels.left, pixels.right + 1 - pixels.left, bound)) return true;
  }
  return false;
}

/// The smallest of the pixels' keys. Requires: there are pixels.
inline std::uint64_t smallest_key(const PixelRectangle& pixels, int width, const std::uint64_t* keys) {
  std::uint64_t smallest = ~std::uint64_t{0};
  const int count = pixels.right + 1 - pixels.left;
#if defined(__AVX512F__)
  if (count == 8) {
    __m512i eight = _mm512_set1_epi64(-1);
    for (int line = pixels.top; line <= pixels.bottom; ++line)
      eight = _mm512_mask_min_epu64(eight, 0xff, eight, _mm512_loadu_si512(keys + static_cast<std::size_t>(line) * static_cast<std::size_t>(width) + pixels.left));
    const auto smaller = [](__m512i a, __m512i b) { return _mm512_mask_min_epu64(a, 0xff, a, b); };
    eight = smaller(eight, _mm512_maskz_shuffle_i64x2(0xff, eight, eight, 0x4e));
    eight = smaller(eight, _mm512_maskz_shuffle_i64x2(0xff, eight, eight, 0xb1));
    eight = smaller(eight, _mm512_maskz_permutex_epi64(0xff, eight, 0xb1));
    _mm512_mask_storeu_epi64(&smallest, 1, eight);
    return smallest;
  }
#endif
  for (int line = pixels.top; line <= pixels.bottom; ++line) {
    const std::uint64_t* cells = keys + static_cast<std::size_t>(line) * static_cast<std::size_t>(width) + pixels.left;
    smallest = std::min(smallest, *std::min_element(cells, cells + count));
  }
  return smallest;
}

/// `nearest`: the largest eye disparity that anything to be drawn can have.
inline bool are_hidden(const PixelRectangle& pixels, float nearest, int width, const std::uint64_t* keys) {
  return !any_smaller_in(pixels, largest_key(nearest), width, keys);
}

}  // namespace farfield::client
