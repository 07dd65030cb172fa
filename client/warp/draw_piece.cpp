// SPDX-License-Identifier: Apache-2.0
// The same arithmetic as draw_piece_scalar.cpp, for blocks of 8×2 pixels at once. Of the two samples left and right of a
// pixel's place, all that is said of them stands in the lower and upper half of the pixel's 32 bits.
#include "client/warp/piece_on_screen.h"
#include "client/warp/splat_key.h"

#if defined(__AVX512BW__) && defined(__AVX512VBMI__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // GCC 12 says so of its own header: bug 105593
#include <immintrin.h>

namespace farfield::client {
namespace {

constexpr int kColumns = 8;  // of a block: one vector of keys
constexpr int kRightHalves = static_cast<int>(0xAAAAAAAAu);

/// The part of a linear function that a row of blocks shares, and the rest.
inline __m512 along_y(const ScreenLinear& f, __m512 y) {
  return _mm512_add_ps(_mm512_set1_ps(f.origin), _mm512_mul_ps(_mm512_set1_ps(f.along_y), y));
}
inline __m512 along_x(const ScreenLinear& f, __m512 in_row, __m512 x) {
  return _mm512_add_ps(in_row, _mm512_mul_ps(_mm512_set1_ps(f.along_x), x));
}

/// A number of 16 bits in both halves.
inline __m512i both(__m512i value) {
  return _mm512_mask_blend_epi16(static_cast<__mmask32>(kRightHalves), value, _mm512_slli_epi32(value, 16));
}
inline __m512i pair(int left, int right) { return _mm512_set1_epi32((left & 0xffff) | right << 16); }
/// Pixels for which something holds of the left or the right sample.
inline __mmask16 either(__mmask32 halves) {
  const __m512i all_ones = _mm512_movm_epi16(halves);
  return _mm512_test_epi32_mask(all_ones, all_ones);
}

struct Place {
  __m512i i, j, x, y;
  __m512i to_x;  // distances from the left and the right sample
};

/// Which pixels the piece's samples reach.
class Reaches {
 public:
  explicit Reaches(const PlacedPiece& placed)
      : upper_(_mm512_maskz_loadu_epi16(static_cast<__mmask32>(placed.piece->own), placed.reach)),
        lower_(_mm512_maskz_loadu_epi16(static_cast<__mmask32>(placed.piece->own >> 32), placed.reach + 32)),
        farthest_u_(_mm512_set1_epi16(static_cast<short>(placed.farthest_u))),
        farthest_v_(_mm512_set1_epi16(static_cast<short>(placed.farthest_v))) {
  }

  __mmask16 covered(const Place& place) const {
    const __m512i edge = _mm512_set1_epi16(kSquareEdge), one = _mm512_set1_epi16(1);
    const __m512i i = _mm512_add_epi16(both(place.i), pair(0, 1)), j = both(place.j);
    const __mmask32 in_columns = _mm512_cmplt_epu16_mask(i, edge);
    const __mmask32 in_upper = _mm512_mask_cmplt_epu16_mask(in_columns, j, edge);
    const __mmask32 in_lower = _mm512_mask_cmplt_epu16_mask(in_columns, _mm512_add_epi16(j, one), edge);
    const __m512i index = _mm512_add_epi16(_mm512_slli_epi16(j, 3), i);
    const __m512i up = _mm512_maskz_permutex2var_epi16(in_upper, upper_, index, lower_);
    const __m512i down = _mm512_maskz_permutex2var_epi16(in_lower, upper_, _mm512_add_epi16(index, edge), lower_);
    // Less by one: kRoundingMargin.
    const __m512i to_x = _mm512_subs_epu16(place.to_x, one), from_up = both(place.y);
    const __m512i to_up = _mm512_subs_epu16(from_up, one);
    const __m512i to_down = _mm512_subs_epu16(_mm512_sub_epi16(_mm512_set1_epi16(kPositionSteps), from_up), one);
    const __m512i high_nibble = _mm512_set1_epi16(0xf0), to_nibble = pair(0, 4);
    const auto along_u = [&](__m512i reach) {
      return _mm512_min_epu16(_mm512_and_si512(_mm512_sllv_epi16(reach, to_nibble), high_nibble), farthest_u_);
    };
    const auto along_v = [&](__m512i shifted) { return _mm512_min_epu16(_mm512_and_si512(shifted, high_nibble), farthest_v_); };
    __mmask32 hit_up = _mm512_cmple_epu16_mask(to_x, along_u(up)), hit_down = _mm512_cmple_epu16_mask(to_x, along_u(down));
    hit_up = _mm512_mask_cmple_epu16_mask(hit_up, to_up, along_v(_mm512_srli_epi16(up, 8)));
    hit_down = _mm512_mask_cmple_epu16_mask(hit_down, to_down, along_v(_mm512_srli_epi16(down, 4)));
    hit_up = _mm512_mask_test_epi16_mask(hit_up, up, up), hit_down = _mm512_mask_test_epi16_mask(hit_down, down, down);
    return either(hit_up | hit_down);
  }

 private:
  __m512i upper_, lower_;  // 64 reaches; 0: not the piece's
  __m512i farthest_u_, farthest_v_;
};

struct Weights {
  __m512i up, down;
};

/// Bilinear, in 256ths: see weights_of() in the reference.
class Shares {
 public:
  explicit Shares(const SurfacePiece& piece)
      : rows_(_mm512_cvtepu16_epi32(_mm256_maskz_loadu_epi16((1u << kRingEdge) - 1, piece.held.data()))) {}

  static Weights whole(const Place& place) { return split(place, _mm512_srli_epi32(place.y, 1)); }

  Weights of(const Place& place) const {
    const __m512i one = _mm512_set1_epi32(1), column = _mm512_add_epi32(place.i, one);
    const auto held_in = [&](__m512i row) { return _mm512_srlv_epi32(_mm512_permutexvar_epi32(row, rows_), column); };
    const __m512i up = held_in(_mm512_add_epi32(place.j, one)), down = held_in(_mm512_add_epi32(place.j, _mm512_set1_epi32(2)));
    const __m512i either_bit = _mm512_set1_epi32(3);
    __m512i share = _mm512_srli_epi32(place.y, 1);
    share = _mm512_maskz_mov_epi32(_mm512_test_epi32_mask(down, either_bit), share);
    share = _mm512_mask_mov_epi32(share, _mm512_testn_epi32_mask(up, either_bit), _mm512_set1_epi32(128));
    const Weights all = split(place, share);
    return {held_only(all.up, up), held_only(all.down, down)};
  }

 private:
  static Weights split(const Place& place, __m512i down_of_128) {
    const __m512i across = _mm512_sub_epi16(_mm512_set1_epi16(kPositionSteps), place.to_x);
    const __m512i down = _mm512_srli_epi16(_mm512_mullo_epi16(across, both(down_of_128)), 7);
    return {_mm512_sub_epi16(across, down), down};
  }
  static __m512i held_only(__m512i weights, __m512i bits) {
    const __mmask32 held = _mm512_test_epi16_mask(both(bits), pair(1, 2));
    const __m512i lost = _mm512_maskz_mov_epi16(~held, weights);
    return _mm512_maskz_add_epi16(held, weights, _mm512_rol_epi32(lost, 16));
  }

  __m512i rows_;
};

/// A square's texels, all at hand: looked up sixteen pixels and two corners at a time.
class Texels {
 public:
  explicit Texels(const std::uint8_t* texels) {
    for (int c = 0; c < 3; ++c) {
      first_[c] = _mm512_loadu_si512(texels + c * kSquareTexels);
      rest_[c] = _mm512_loadu_si512(texels + c * kSquareTexels + 64);
    }
  }

  __m512i colours(const Place& place, const Weights& weights) const {
    const __m512i position = _mm512_mask_blend_epi16(static_cast<__mmask32>(kRightHalves), place.i, _mm512_slli_epi32(place.j, 16));
    constexpr int kOwn = kRingEdge + 1;
    const __m512i up = _mm512_add_epi16(both(_mm512_madd_epi16(position, pair(1, kRingEdge))), pair(kOwn, kOwn + 1));
    const __m512i down = _mm512_add_epi16(up, _mm512_set1_epi16(kRingEdge));
    const auto mixed = [&](int c) {
      const __m512i sum = _mm512_add_epi32(_mm512_madd_epi16(at(c, up), weights.up), _mm512_madd_epi16(at(c, down), weights.down));
      return _mm512_add_epi32(sum, _mm512_set1_epi32(128));
    };
    const __m512i upper_byte = _mm512_set1_epi32(0xff00);
    const __m512i red = _mm512_srli_epi32(mixed(0), 8), green = _mm512_and_si512(mixed(1), upper_byte);
    const __m512i blue = _mm512_slli_epi32(_mm512_and_si512(mixed(2), upper_byte), 8);
    return _mm512_or_si512(_mm512_or_si512(red, green), blue);
  }

 private:
  __m512i at(int c, __m512i indices) const { return _mm512_maskz_permutex2var_epi8(0x5555555555555555u, first_[c], indices, rest_[c]); }

  __m512i first_[3], rest_[3];
};

inline __m512i high_halves(__m512 disparity, const Place& place) {
  const __m512i steps = _mm512_set1_epi32(kPositionSteps);
  const __m512i to_x = _mm512_min_epu32(place.x, _mm512_sub_epi32(steps, place.x));
  const __m512i to_y = _mm512_min_epu32(place.y, _mm512_sub_epi32(steps, place.y));
  const __m512i offset = _mm512_or_si512(to_x, _mm512_slli_epi32(to_y, 16));
  constexpr float kPenalty = kDistancePenalty / (kPositionSteps * kPositionSteps);
  const __m512 nearness = _mm512_sub_ps(_mm512_set1_ps(1.0f), _mm512_mul_ps(_mm512_set1_ps(kPenalty),
                                                                          _mm512_cvtepi32_ps(_mm512_madd_epi16(offset, offset))));
  const __m512 positive = _mm512_max_ps(_mm512_mul_ps(disparity, nearness), _mm512_setzero_ps());
  return _mm512_or_si512(_mm512_slli_epi32(_mm512_castps_si512(positive), 1), _mm512_set1_epi32(1));
}

/// Upper and lower halves of 16 keys in two vectors, one after another.
inline __m512i halves(__m512i first, __m512i second, int which) {
  const __m512i lanes = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  return _mm512_permutex2var_epi32(first, _mm512_add_epi32(lanes, _mm512_set1_epi32(which)), second);
}

template <bool kIsWhole>
bool draw(const PlacedPiece& placed, const Reaches* reaches, const Shares* shares, int width, std::uint64_t* keys) {
  // Where a whole square's samples reach; else all that has samples at its corners. Positions are rounded afterwards.
  constexpr int kReach = static_cast<int>(kReachConnected) * kPositionSteps / 16 + 1;
  const __m512 first = _mm512_set1_ps(static_cast<float>(kIsWhole ? -kReach : -kPositionSteps) - 0.5f);
  const __m512 last = _mm512_set1_ps(
      static_cast<float>(kIsWhole ? (kSquareEdge - 1) * kPositionSteps + kReach : kSquareEdge * kPositionSteps - 1) + 0.5f);
  const __m512 block_x = _mm512_setr_ps(0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
  const __m512 block_y = _mm512_setr_ps(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1);
  const __m512i low_bits = _mm512_set1_epi32(kPositionSteps - 1);
  const Texels texels(placed.texels);
  bool any = false;
  for (int line = placed.top; line <= placed.bottom; line += 2) {
    const __m512 y = _mm512_add_ps(_mm512_set1_ps(static_cast<float>(line - placed.origin_y)), block_y);
    const __m512 row_of_columns = along_y(placed.column, y), row_of_rows = along_y(placed.row, y), row_per_w = along_y(placed.per_w, y);
    const __m512 row_of_disparities = along_y(placed.disparity, y);
    std::uint64_t* upper = keys + static_cast<std::size_t>(line) * static_cast<std::size_t>(width);
    const unsigned lines = line < placed.bottom ? 0xffff : 0xff;
    for (int left = placed.left; left <= placed.right; left += kColumns) {
      const __m512 x = _mm512_add_ps(_mm512_set1_ps(static_cast<float>(left - placed.origin_x)), block_x);
      const unsigned columns = placed.right - left >= kColumns - 1 ? 0xff : (1u << (placed.right - left + 1)) - 1;
      __mmask16 pixels = static_cast<__mmask16>(lines & (columns | columns << 8));
      const __m512 per_w = along_x(placed.per_w, row_per_w, x), w = _mm512_div_ps(_mm512_set1_ps(1.0f), per_w);
      const __m512 column = _mm512_mul_ps(along_x(placed.column, row_of_columns, x), w);
      const __m512 row = _mm512_mul_ps(along_x(placed.row, row_of_rows, x), w);
      pixels = _mm512_mask_cmp_ps_mask(pixels, per_w, _mm512_setzero_ps(), _CMP_GT_OQ);
      pixels = _mm512_mask_cmp_ps_mask(pixels, column, first, _CMP_GT_OQ);
      pixels = _mm512_mask_cmp_ps_mask(pixels, column, last, _CMP_LT_OQ);
      pixels = _mm512_mask_cmp_ps_mask(pixels, row, first, _CMP_GT_OQ);
      pixels = _mm512_mask_cmp_ps_mask(pixels, row, last, _CMP_LT_OQ);
      if (pixels == 0) continue;
      const __m512i at_x = _mm512_cvtps_epi32(column), at_y = _mm512_cvtps_epi32(row);
      Place place{_mm512_srai_epi32(at_x, 8), _mm512_srai_epi32(at_y, 8), _mm512_and_si512(at_x, low_bits),
                  _mm512_and_si512(at_y, low_bits), {}};
      // What shows something nearer already is done with.
      std::uint64_t *upper_keys = upper + left, *lower_keys = upper_keys + width;
      const __m512i old_upper = _mm512_maskz_loadu_epi64(static_cast<__mmask8>(pixels), upper_keys);
      const __m512i old_lower = _mm512_maskz_loadu_epi64(static_cast<__mmask8>(pixels >> 8), lower_keys);
      const __m512i high = high_halves(along_x(placed.disparity, row_of_disparities, x), place);
      pixels = _mm512_mask_cmpge_epu32_mask(pixels, high, halves(old_upper, old_lower, 1));
      if (pixels == 0) continue;
      place.to_x = _mm512_or_si512(place.x, _mm512_slli_epi32(_mm512_sub_epi32(_mm512_set1_epi32(kPositionSteps), place.x), 16));
      if constexpr (!kIsWhole) {
        pixels &= reaches->covered(place);
        if (pixels == 0) continue;
      }
      any = true;
      const __m512i low = texels.colours(place, kIsWhole ? Shares::whole(place) : shares->of(place));
      const __m512i first_eight = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
      const __m512i last_eight = _mm512_add_epi32(first_eight, _mm512_set1_epi32(8));
      const __m512i new_upper = _mm512_permutex2var_epi32(low, first_eight, high), new_lower = _mm512_permutex2var_epi32(low, last_eight, high);
      _mm512_mask_storeu_epi64(upper_keys, static_cast<__mmask8>(pixels), _mm512_max_epu64(old_upper, new_upper));
      _mm512_mask_storeu_epi64(lower_keys, static_cast<__mmask8>(pixels >> 8), _mm512_max_epu64(old_lower, new_lower));
    }
  }
  return any;
}

}  // namespace

bool draw_piece(const PlacedPiece& placed, int width, std::uint64_t* keys) {
  if (!placed.reach) return draw<true>(placed, nullptr, nullptr, width, keys);
  const Reaches reaches(placed);
  const Shares shares(*placed.piece);
  return draw<false>(placed, &reaches, &shares, width, keys);
}

}  // namespace farfield::client
#pragma GCC diagnostic pop

#else

namespace farfield::client {

bool draw_piece(const PlacedPiece& placed, int width, std::uint64_t* keys) {
  draw_piece_scalar(placed, width, keys);
  return true;
}

}  // namespace farfield::client
#endif
