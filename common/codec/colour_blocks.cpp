// SPDX-License-Identifier: Apache-2.0
// Format: one range-coded stream. Block by block, plane by plane: the mean, as the difference from the mean of the blocks
// to the left and above; how many other coefficients are not zero; then, in zig-zag order until that many were met, for
// each whether it is zero, and if not its magnitude in unary and its sign.
#include "common/codec/colour_blocks.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <memory>

#include "common/codec/mixed_bits.h"

namespace farfield {
namespace {

using Levels = std::array<std::int16_t, kBlockSamples * kBlockSamples>;

constexpr int kUnary = 16;  // larger magnitudes go on as integers

// Classes of magnitudes: 0, 1, 2, 3…4, 5…8, 9…16, more.
int size_class(int magnitude) { return magnitude < 3 ? magnitude : magnitude < 5 ? 3 : magnitude < 9 ? 4 : magnitude < 17 ? 5 : 6; }
constexpr int kNoClass = 7;
int sign_class(int value) { return value > 0 ? 1 : value < 0 ? 2 : 0; }
// Of how low a frequency a coefficient is, by its place in zig-zag order: each of the first by itself, later ones in bands.
constexpr std::array<std::uint8_t, 64> kBands = [] {
  std::array<std::uint8_t, 64> bands{};
  for (int k = 0; k < 64; ++k) bands[k] = k < 4 ? k : k < 7 ? 4 : k < 11 ? 5 : k < 16 ? 6 : k < 22 ? 7 : k < 29 ? 8 : k < 37 ? 9 : 10;
  return bands;
}();
// What share of the places left, [how many][how many are not zero], in eight classes.
constexpr std::array<std::array<std::uint8_t, 64>, 64> kShares = [] {
  std::array<std::array<std::uint8_t, 64>, 64> shares{};
  for (int places = 1; places < 64; ++places)
    for (int found = 0; found < 64; ++found) shares[places][found] = static_cast<std::uint8_t>(std::min(7, found * 16 / places));
  return shares;
}();

struct PlaneContexts {
  MixedContexts<64, 32, 64> has_mean;
  MixedContexts<9, 64, 8> mean_sign;
  MixedContexts<64, 64, 64> mean_size;
  IntegerContext large;
  MixedContexts<256, 2048, 512, 2> count_class;
  MixedContexts<32, 256, 256> count_rest;
  MixedContexts<512, 880, 288, 8> is_set;
  MixedContexts<88, 160, 216, 2> size;
  MixedContexts<576, 576, 9> sign;
};

template <class Coder>
class ColourWalk {
 public:
  ColourWalk(Coder& coder, const TileBits& bits, std::vector<ColourBlock>& blocks)
      : coder_(coder), bits_(bits), blocks_(blocks), counts_(blocks.size()), planes_(std::make_unique<std::array<PlaneContexts, 2>>()) {}

  void run() {
    for (int block = 0; block < bits_.grid().size(); ++block) {
      if (bits_[block].covered == 0) continue;
      const BlockGrid::Beside& beside = bits_.grid().beside(block);
      left_ = earlier(beside.left, block), above_ = earlier(beside.above, block);
      const int covered = std::popcount(bits_[block].covered);
      cover_ = covered == 64 ? 3 : covered > 32 ? 2 : covered > 12 ? 1 : 0;
      for (int plane = 0; plane < kColourPlanes; ++plane) {
        code_mean(block, plane);
        code_count(block, plane);
        code_places(block, plane);
      }
    }
  }

 private:
  // Blue and red share what they learn: alone, either sees too little.
  PlaneContexts& contexts_of(int plane) { return (*planes_)[plane == 0 ? 0 : 1]; }
  int earlier(int other, int block) const { return other >= 0 && other < block && bits_[other].covered != 0 ? other : -1; }
  int level(int block, int plane, int at) const { return block < 0 ? 0 : int{blocks_[block].levels[plane][at]}; }

  void code_mean(int block, int plane) {
    PlaneContexts& contexts = contexts_of(plane);
    const int left = level(left_, plane, 0), above = level(above_, plane, 0);
    const int known = (left_ >= 0) + (above_ >= 0);
    const int guess = known == 2 ? (left + above) / 2 : left + above;
    const int unrest = known == 2 ? size_class(std::abs(left - above)) : kNoClass, guess_size = size_class(std::abs(guess));
    const int luma = plane == 0 ? 0 : level(block, 0, 0), blue = plane == 2 ? level(block, 1, 0) : 0;
    const int before = plane == 0 ? 0 : size_class(std::abs(level(block, plane - 1, 0)));
    const auto seven = [](int value) { return std::clamp(value, -3, 3) + 3; };
    const int others = plane == 0 ? 0 : seven(luma) * 8 + (plane == 2 ? seven(blue) : 0);

    int difference = level(block, plane, 0) - guess;
    if (!coder_.code(difference != 0, contexts.has_mean(unrest * 8 + guess_size, cover_ * 8 + before, others))) {
      difference = 0;
    } else {
      const bool is_negative = coder_.code(difference < 0, contexts.mean_sign(sign_class(guess) + 3 * known, others, others / 8));
      const int size = code_size(std::abs(difference), contexts.large, [&](int i) {
        i = std::min(i, 7);
        return contexts.mean_size(unrest * 8 + i, guess_size * 8 + i, before * 8 + i);
      });
      difference = is_negative ? -size : size;
    }
    blocks_[block].levels[plane][0] = static_cast<std::int16_t>(std::clamp(guess + difference, -kLargestLevel, kLargestLevel));
  }

  void code_count(int block, int plane) {
    PlaneContexts& contexts = contexts_of(plane);
    const auto count_in = [&](int other) { return other < 0 ? 0 : int{counts_[other][plane]}; };
    const auto class_of = [&](int other) { return other < 0 ? kNoClass : size_class(counts_[other][plane]); };
    const int around = left_ < 0 && above_ < 0     ? kNoClass
                       : left_ >= 0 && above_ >= 0 ? size_class((count_in(left_) + count_in(above_) + 1) / 2)
                                                   : size_class(count_in(left_) + count_in(above_));
    const int luma = plane == 0 ? 0 : size_class(counts_[block][0]), blue = plane == 2 ? size_class(counts_[block][1]) : 0;
    const Levels& levels = blocks_[block].levels[plane];
    const int count = static_cast<int>(std::count_if(levels.begin() + 1, levels.end(), [](int level) { return level != 0; }));

    const int digits = std::bit_width(static_cast<unsigned>(count));
    int coded_digits = 0;
    while (coded_digits < 6) {
      const int i = coded_digits;
      if (!coder_.code(digits > i, contexts.count_class((around * 4 + cover_) * 8 + i, ((luma * 8 + blue) * 4 + std::min(around, 3)) * 8 + i,
                                                        (class_of(left_) * 8 + class_of(above_)) * 8 + i, i > 0)))
        break;
      ++coded_digits;
    }
    int value = coded_digits > 0;
    for (int digit = coded_digits - 2; digit >= 0; --digit) {
      const int at = coded_digits * 4 + std::min(value, 3);
      value = value * 2 + coder_.code(count >> digit & 1, contexts.count_rest(at, around * 32 + at, luma * 32 + at));
    }
    counts_[block][plane] = static_cast<std::uint8_t>(value);
  }

  void code_places(int block, int plane) {
    int left_to_find = counts_[block][plane], largest = 0;
    if (left_to_find == 0) return;  // as in a block that is new
    PlaneContexts& contexts = contexts_of(plane);
    Levels& levels = blocks_[block].levels[plane];
    const Levels wanted = levels;
    std::fill(levels.begin() + 1, levels.end(), std::int16_t{0});
    const Levels& left_levels = levels_of(left_, plane);
    const Levels& above_levels = levels_of(above_, plane);
    LowerFrequencies lower;
    lower.add(0, std::abs(int{levels[0]}));
    for (int k = 1; left_to_find > 0 && k < kBlockSamples * kBlockSamples; ++k) {
      const int at = kZigZag[k], places = 64 - k;
      const int near = std::min(std::abs(int{left_levels[at]}) + std::abs(int{above_levels[at]}), 3);
      const int inside = lower.size_class(at) * 4 + near;
      const int luma = plane == 0 ? 0 : std::min(std::abs(level(block, 0, at)), 2), blue = plane == 2 ? std::min(std::abs(level(block, 1, at)), 2) : 0;
      const int share = kShares[places][left_to_find], remaining = std::min(left_to_find, 7), band = kBands[k];
      const int beside = plane == 0 ? inside / 4 : luma * 3 + blue;
      const bool is_set = left_to_find == places ||
                          coder_.code(wanted[at] != 0, contexts.is_set(k * 8 + remaining, (inside * 11 + band) * 4 + luma, (share * 9 + beside) * 4 + near,
                                                                       std::min(left_to_find - 1, 7)));
      if (!is_set) continue;
      const int others = (plane == 0 ? remaining : luma * 3 + blue) * 3 + std::min(largest, 2);
      const int size = code_size(std::abs(int{wanted[at]}), contexts.large, [&](int i) {
        const int step = std::min(i, 7);
        return contexts.size(band * 8 + step, inside * 8 + step, others * 8 + step, i > 1);
      });
      largest = std::max(largest, size - 1);
      const bool is_negative = code_sign(block, plane, at, wanted[at] < 0);
      levels[at] = static_cast<std::int16_t>(is_negative ? -size : size);
      lower.add(at, size);
      --left_to_find;
    }
  }

  // How large the coefficients of lower frequency beside each are: kept up to date while they become known, which few do.
  class LowerFrequencies {
   public:
    void add(int at, int size) {
      std::int32_t* own = &sums_[place_of(at)];
      own[1] += 2 * size, own[2] += size, own[kColumns] += 2 * size, own[kColumns + 1] += size, own[2 * kColumns] += size;
    }
    // In five classes.
    int size_class(int at) const {
      const std::int32_t sum = sums_[place_of(at)];
      return sum < 2 ? sum : sum < 4 ? 2 : sum < 8 ? 3 : 4;
    }

   private:
    // Two columns and rows beyond the block, so that none needs asking about.
    static constexpr int kColumns = kBlockSamples + 2;
    static int place_of(int at) { return at / kBlockSamples * kColumns + at % kBlockSamples; }
    std::array<std::int32_t, kColumns * kColumns> sums_{};
  };

  const Levels& levels_of(int block, int plane) const {
    static constexpr Levels kNone{};
    return block < 0 ? kNone : blocks_[block].levels[plane];
  }

  bool code_sign(int block, int plane, int at, bool is_negative) {
    const int left = sign_class(level(left_, plane, at)), above = sign_class(level(above_, plane, at));
    const int others = plane == 0 ? left * 3 + above : sign_class(level(block, 0, at)) * 3 + (plane == 2 ? sign_class(level(block, 1, at)) : 0);
    if (plane > 0) return coder_.code(is_negative, contexts_of(plane).sign(others + 9 * cover_, at * 9 + others, left * 3 + above));
    const int edge = at % kBlockSamples == 0 ? above : at < kBlockSamples ? left + 3 : 6;
    return coder_.code(is_negative, contexts_of(plane).sign(at * 9 + others, edge, 0));
  }

  // A magnitude from 1.
  template <class Predict>
  int code_size(int wanted, IntegerContext& large, Predict predict) {
    int size = 1;
    while (size < kUnary && coder_.code(wanted > size, predict(size))) ++size;
    if (size == kUnary) size += std::abs(coder_.code_integer(wanted - kUnary, large));
    return std::min(size, kLargestLevel);
  }

  Coder& coder_;
  const TileBits& bits_;
  std::vector<ColourBlock>& blocks_;
  std::vector<std::array<std::uint8_t, kColourPlanes>> counts_;  // of coefficients that are not zero, without the mean
  std::unique_ptr<std::array<PlaneContexts, 2>> planes_;
  int left_ = -1, above_ = -1;  // blocks beside the one being coded, -1: none that is coded
  int cover_ = 0;               // how much of it is covered, in four classes
};

}  // namespace

Bytes encode_colour_blocks(std::vector<ColourBlock>& blocks, const TileBits& bits) {
  BitWriter writer;
  ColourWalk<BitWriter>(writer, bits, blocks).run();
  return writer.finish();
}

std::vector<ColourBlock> decode_colour_blocks(ByteView bytes, const TileBits& bits) {
  BitReader reader(bytes);
  std::vector<ColourBlock> blocks(static_cast<std::size_t>(bits.grid().size()));
  ColourWalk<BitReader>(reader, bits, blocks).run();
  return blocks;
}

}  // namespace farfield
