// SPDX-License-Identifier: Apache-2.0
#include "common/codec/bit_coder.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace farfield {
namespace {

// The format's probabilities: a step is the doubled error over 2·seen + 3, towards zero.
TEST(BitContext, MovesByTheExactQuotient) {
  for (int seen = 0; seen <= BitContext::kSlowest; ++seen)
    for (int zero = BitContext::kLeast; zero <= 65536 - BitContext::kLeast; ++zero)
      for (const bool bit : {false, true}) {
        BitContext context{static_cast<std::uint16_t>(zero), static_cast<std::uint8_t>(seen)};
        context.update(bit);
        const int target = bit ? BitContext::kLeast : 65536 - BitContext::kLeast;
        ASSERT_EQ(context.zero, zero + (target - zero) * 2 / (2 * seen + 3));
        ASSERT_EQ(context.seen, std::min(seen + 1, BitContext::kSlowest));
      }
}

}  // namespace
}  // namespace farfield
