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

// Calls visit(sample in the block, first byte in the image) for each covered sample of a block.
template <class Visit>
void each_covered(const TileBits& bits, int block, Visit visit) {
  const auto first = static_cast<std::size_t>(bits.grid().first_sample(block));
  for (std::uint64_t todo = bits[block].covered; todo != 0; todo &= todo - 1) {
    const int k = std::countr_zero(todo);
    visit(k, 3 * (first + static_cast<std::size_t>(k / kBlockSamples) * bits.grid().width() + k % kBlockSamples));
  }
}

std::uint8_t to_byte(float value) { return static_cast<std::uint8_t>(std::clamp(value + 128.5f, 0.0f, 255.0f)); }

}  // namespace

float colour_step(int quality) {
  // JPEG's scale: percent of the tables that it calls quality 50.
  const float percent = quality < 50 ? 5000.0f / static_cast<float>(quality) : static_cast<float>(200 - 2 * quality);
  return std::max(1.0f, 0.3f * percent);
}

Bytes encode_colour(ByteView rgb, const TileBits& bits, int quality) {
  std::vector<ColourPlane> planes(static_cast<std::size_t>(kColourPlanes * bits.grid().size()));
  for (int block = 0; block < bits.grid().size(); ++block) {
    ColourPlane* of_block = &planes[static_cast<std::size_t>(kColourPlanes * block)];
    for (int p = 0; p < kColourPlanes; ++p) of_block[p].covered = bits[block].covered;
    each_covered(bits, block, [&](int k, std::size_t at) {
      const auto difference = [&](int c) { return static_cast<float>(int{rgb[at + static_cast<std::size_t>(c)]} - 128); };
      const float r = difference(0), g = difference(1), b = difference(2);
      // ITU-T T.871, section 7.
      of_block[0].samples[k] = 0.299f * r + 0.587f * g + 0.114f * b;
      of_block[1].samples[k] = -0.168736f * r - 0.331264f * g + 0.5f * b;
      of_block[2].samples[k] = 0.5f * r - 0.418688f * g - 0.081312f * b;
    });
  }
  return encode_colour_blocks(quantise_colours(planes, colour_steps(quality)), bits);
}

std::vector<std::uint8_t> decode_colour(ByteView bytes, const TileBits& bits, int quality) {
  const std::vector<ColourBlock> blocks = decode_colour_blocks(bytes, bits);
  std::vector<std::uint8_t> rgb(std::size_t{3} * bits.grid().width() * bits.grid().height(), 128);
  const BlockTransform transform;
  const ColourSteps steps = colour_steps(quality);
  for (int block = 0; block < bits.grid().size(); ++block) {
    if (bits[block].covered == 0) continue;
    std::array<BlockPlane, kColourPlanes> planes;
    for (int p = 0; p < kColourPlanes; ++p) {
      const auto& levels = blocks[block].levels[p];
      BlockPlane coefficients;
      for (std::size_t k = 0; k < levels.size(); ++k) coefficients[k] = steps.of(p)[k] * static_cast<float>(levels[k]);
      planes[p] = transform.inverse(coefficients);
    }
    each_covered(bits, block, [&](int k, std::size_t at) {
      const float luma = planes[0][k], blue = planes[1][k], red = planes[2][k];
      rgb[at] = to_byte(luma + 1.402f * red);
      rgb[at + 1] = to_byte(luma - 0.344136f * blue - 0.714136f * red);
      rgb[at + 2] = to_byte(luma + 1.772f * blue);
    });
  }
  return rgb;
}

}  // namespace farfield
