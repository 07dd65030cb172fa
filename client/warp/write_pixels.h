// SPDX-License-Identifier: Apache-2.0
// Writes what a vectorised pass over samples found into the key buffer, where the nearest surface stays.
#pragma once

#include <array>
#include <cstdint>
#if defined(__AVX512F__)
#include <immintrin.h>
#endif

#include "client/warp/project_row.h"
#include "client/warp/splat_key.h"

namespace farfield::client {

/// Room for a whole vector to be stored after the last index.
using RowIndices = std::array<std::int32_t, kRowPiece + 16>;

/// Stores the places of the non-negative entries in order. Returns: how many there are. Without branches: half of them would be guessed wrong.
/// `values` are aligned to 64 bytes; `indices` has room for a vector after the last one.
inline int find_non_negative(const std::int32_t* values, int count, std::int32_t* indices) {
  int found = 0, i = 0;
#if defined(__AVX512F__)
  __m512i place = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  for (; i + 16 <= count; i += 16) {
    const __mmask16 kept = _mm512_cmpge_epi32_mask(_mm512_load_si512(values + i), _mm512_setzero_si512());
    _mm512_storeu_si512(indices + found, _mm512_maskz_compress_epi32(kept, place));
    found += __builtin_popcount(kept);
    place = _mm512_add_epi32(place, _mm512_set1_epi32(16));
  }
#endif
  for (; i < count; ++i) {
    indices[found] = i;
    found += values[i] >= 0;
  }
  return found;
}

inline void keep_larger(std::uint64_t& cell, std::uint64_t key) { cell = cell < key ? key : cell; }

inline void write_pixels(const SplatPixels& pixels, int count, RowIndices& hits, std::uint64_t* keys) {
  const int found = find_non_negative(pixels.offset.data(), count, hits.data());
  for (int k = 0; k < found; ++k) {
    const int i = hits[k];
    keep_larger(keys[pixels.offset[i]], make_key(pixels.high[i], pixels.low[i]));
  }
}

}  // namespace farfield::client
