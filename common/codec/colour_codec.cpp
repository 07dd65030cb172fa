// SPDX-License-Identifier: Apache-2.0
#include "common/codec/colour_codec.h"

#include <algorithm>
#include <bit>

#include "common/codec/colour_quantiser.h"

namespace farfield {
namespace {

// How much finer or coarser than colour_step() the mean, the lowest and the highest frequency are quantised: eyes see
// gradual errors in smooth surfaces, and of colour almost nothing else (the contrast sensitivity that FLIP models: Andersson et
// al. 2020, section 4.1).
struct StepScale {
  float mean, low, high;
};
constexpr StepScale kLumaScale{0.4f, 0.7f, 1.3f}, kDifferenceScale{0.3f, 0.5f, 1.5f};

BlockPlane scaled(const StepScale& scale, float step) {
  constexpr int kLowest = 1, kHighest = 2 * (kBlockSamples - 1);
  BlockPlane steps;
  for (int k = 0; k < kBlockSamples * kBlockSamples; ++k) {
    const int frequency = k % kBlockSamples + k / kBlockSamples;
    const float share = static_cast<float>(frequency - kLowest) / (kHighest - kLowest);
    steps[k] = step * (frequency == 0 ? scale.mean : scale.low + share * (scale.high - scale.low));
  }
  return steps;
}
ColourSteps colour_steps(int quality) {
  const float step = colour_step(quality);
  return {scaled(kLumaScale, step), scaled(kDifferenceScale, step)};
}

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::clamp(value + 128.5f, 0.0f, 255.0f)); }

// Calls visit(row of the block, its first byte in the image, samples in it) for each row of a block that the image has.
template <class Visit>
void each_row(const BlockGrid& grid, int block, Visit visit) {
  const std::uint64_t samples = grid.samples(block);
  const auto first = static_cast<std::size_t>(grid.first_sample(block)), width = static_cast<std::size_t>(grid.width());
  for (int y = 0; y < kBlockSamples && (samples >> kBlockSamples * y & 1); ++y)
    visit(y, 3 * (first + static_cast<std::size_t>(y) * width), std::popcount(samples & kFirstRow));
}

// ITU-T T.871, section 7.
void convert_to_planes(const std::uint8_t* rgb, int count, float* luma, float* blue, float* red) {
  for (int x = 0; x < count; ++x) {
    const auto r = static_cast<float>(int{rgb[3 * x]} - 128), g = static_cast<float>(int{rgb[3 * x + 1]} - 128), b = static_cast<float>(int{rgb[3 * x + 2]} - 128);
    luma[x] = 0.299f * r + 0.587f * g + 0.114f * b;
    blue[x] = -0.168736f * r - 0.331264f * g + 0.5f * b;
    red[x] = 0.5f * r - 0.418688f * g - 0.081312f * b;
  }
}
void convert_to_bytes(const float* luma, const float* blue, const float* red, int count, std::uint8_t* rgb) {
  for (int x = 0; x < count; ++x) {
    rgb[3 * x] = to_byte(luma[x] + 1.402f * red[x]);
    rgb[3 * x + 1] = to_byte(luma[x] - 0.344136f * blue[x] - 0.714136f * red[x]);
    rgb[3 * x + 2] = to_byte(luma[x] + 1.772f * blue[x]);
  }
}

std::vector<std::uint8_t> colours_of(const std::vector<ColourBlock>& blocks, const TileBits& bits, int quality) {
  const BlockGrid& grid = bits.grid();
  std::vector<std::uint8_t> rgb(std::size_t{3} * grid.width() * grid.height(), 128);
  static const BlockTransform transform;
  const ColourSteps steps = colour_steps(quality);
  for (int block = 0; block < grid.size(); ++block) {
    const std::uint64_t covered = bits[block].covered;
    if (covered == 0) continue;
    std::array<BlockPlane, kColourPlanes> planes;
    for (int p = 0; p < kColourPlanes; ++p) {
      const auto& levels = blocks[block].levels[p];
      if (std::all_of(levels.begin() + 1, levels.end(), [](std::int16_t level) { return level == 0; })) {
        planes[p].fill(transform.inverse_of_mean(steps.of(p)[0] * static_cast<float>(levels[0])));
        continue;
      }
      BlockPlane coefficients;
      for (std::size_t k = 0; k < levels.size(); ++k) coefficients[k] = steps.of(p)[k] * static_cast<float>(levels[k]);
      planes[p] = transform.inverse(coefficients);
    }
    each_row(grid, block, [&](int y, std::size_t at, int) {
      const auto first = static_cast<std::size_t>(kBlockSamples * y);
      std::array<std::uint8_t, 3 * kBlockSamples> row;
      convert_to_bytes(&planes[0][first], &planes[1][first], &planes[2][first], kBlockSamples, row.data());
      const std::uint64_t in_row = covered >> first & kFirstRow;
      if (in_row == kFirstRow) {
        std::copy(row.begin(), row.end(), &rgb[at]);
      } else {
        for (std::uint64_t todo = in_row; todo != 0; todo &= todo - 1) {
          const auto x = static_cast<std::size_t>(std::countr_zero(todo));
          std::copy_n(&row[3 * x], 3, &rgb[at + 3 * x]);
        }
      }
    });
  }
  return rgb;
}

}  // namespace

float colour_step(int quality) {
  // JPEG's scale: percent of the tables that it calls quality 50.
  const float percent = quality < 50 ? 5000.0f / static_cast<float>(quality) : static_cast<float>(200 - 2 * quality);
  return std::max(1.0f, 0.3f * percent);
}

Bytes encode_colour(ByteView rgb, const TileBits& bits, int quality, std::vector<std::uint8_t>* decoded) {
  const BlockGrid& grid = bits.grid();
  std::vector<ColourPlane> planes(static_cast<std::size_t>(kColourPlanes * grid.size()));
  for (int block = 0; block < grid.size(); ++block) {
    const std::uint64_t covered = bits[block].covered;
    if (covered == 0) continue;
    ColourPlane* of_block = &planes[static_cast<std::size_t>(kColourPlanes * block)];
    each_row(grid, block, [&](int y, std::size_t at, int count) {
      float* row[kColourPlanes];
      for (int p = 0; p < kColourPlanes; ++p) row[p] = &of_block[p].samples[static_cast<std::size_t>(kBlockSamples * y)];
      if (count == kBlockSamples) {
        convert_to_planes(&rgb[at], kBlockSamples, row[0], row[1], row[2]);
      } else {
        convert_to_planes(&rgb[at], count, row[0], row[1], row[2]);
      }
    });
    for (int p = 0; p < kColourPlanes; ++p) {
      of_block[p].covered = covered;
      for (std::uint64_t todo = ~covered; todo != 0; todo &= todo - 1) of_block[p].samples[static_cast<std::size_t>(std::countr_zero(todo))] = 0;
    }
  }
  std::vector<ColourBlock> blocks = quantise_colours(planes, colour_steps(quality));
  const Bytes bytes = encode_colour_blocks(blocks, bits);
  if (decoded) *decoded = colours_of(blocks, bits, quality);
  return bytes;
}

std::vector<std::uint8_t> decode_colour(ByteView bytes, const TileBits& bits, int quality) {
  return colours_of(decode_colour_blocks(bytes, bits), bits, quality);
}

}  // namespace farfield
