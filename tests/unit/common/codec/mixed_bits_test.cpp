// SPDX-License-Identifier: Apache-2.0
#include "common/codec/mixed_bits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

namespace farfield {
namespace {

using Contexts = MixedContexts<2, 4, 1024>;

TEST(MixedBits, TablesAreTheLogisticFunctionAndItsInverse) {
  for (int i = 1; i < 2 * kLogitEnd; ++i) {
    const double exact = 65536 / (1 + std::exp(-(i - kLogitEnd) / double{kLogitOne}));
    ASSERT_NEAR(detail::kProbabilities[i], exact, 0.5 + 1e-6) << i;
  }
  for (int p = 0; p < 4096; ++p) {
    const double logit = kLogitOne * std::log((p + 0.5) / (4095.5 - p));
    if (std::abs(logit) < kLogitEnd - 1) { ASSERT_NEAR(detail::kLogits[p], logit, 1 + 0.01 * std::abs(logit)) << p; }
  }
}

// What the last two bits say of the next is lost in noise contexts: the mixer must find the one that knows.
TEST(MixedBits, ComesBackAndBelievesTheContextThatKnows) {
  std::mt19937 random(3);
  std::vector<bool> bits;
  std::vector<int> noise;
  for (int i = 0; i < 20000; ++i) {
    const bool expected = i >= 2 && bits[i - 1] != bits[i - 2];
    bits.push_back(random() % 16 == 0 ? !expected : expected);
    noise.push_back(static_cast<int>(random() % 1024));
  }
  const auto walk = [&](auto& coder, const auto& wanted) {
    auto contexts = std::make_unique<Contexts>();
    std::vector<bool> result;
    for (int i = 0; i < 20000; ++i) {
      const int last = i >= 2 ? result[i - 1] + 2 * result[i - 2] : 0;
      result.push_back(coder.code(wanted(i), (*contexts)(last & 1, last, noise[i])));
    }
    return result;
  };
  BitWriter writer;
  walk(writer, [&](int i) { return bits[i]; });
  const Bytes bytes = writer.finish();
  BitReader reader(bytes);
  EXPECT_EQ(walk(reader, [](int) { return false; }), bits);
  const double entropy = -(15 * std::log2(15 / 16.0) + std::log2(1 / 16.0)) / 16;
  EXPECT_LT(8.0 * bytes.size(), 1.1 * entropy * 20000);
}

TEST(MixedBits, WeightsStayBoundedWhateverIsCoded) {
  BitContext a, b, c;
  Mixer mixer;
  std::mt19937 random(4);
  for (int i = 0; i < 200000; ++i) {
    MixedPrediction prediction(a, b, c, mixer);
    ASSERT_TRUE(prediction.zero() > 0 && prediction.zero() < 65536);
    prediction.update(i % 1000 < 990 ? i / 1000 % 2 : static_cast<int>(random() % 2));
    for (const std::int32_t weight : mixer.weights) ASSERT_LE(std::abs(weight), Mixer::kLargest);
  }
}

}  // namespace
}  // namespace farfield
