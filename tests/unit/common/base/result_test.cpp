// SPDX-License-Identifier: Apache-2.0
#include "common/base/result.h"

#include <gtest/gtest.h>

#include <set>

namespace farfield {
namespace {

Result<int> half(int value) {
  if (value % 2) return fail(ErrorCode::kInvalidArgument, "{} is odd", value);
  return value / 2;
}

Result<int> quarter(int value) {
  const Result<int> once = half(value);
  if (!once) return fail_within("quarter", once.error());
  return half(*once);
}

TEST(Result, CarriesAValueOrAnErrorWithContext) {
  EXPECT_EQ(quarter(8).value(), 2);
  ASSERT_FALSE(quarter(7).has_value());
  EXPECT_EQ(quarter(7).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(quarter(7).error().message, "quarter: 7 is odd");
}

TEST(Result, AStatusHasNoValueButErrors) {
  const Status good;
  EXPECT_TRUE(good.has_value());
  const Status bad = fail(ErrorCode::kIo, "disk {} full", 1);
  EXPECT_EQ(bad.error().message, "disk 1 full");
}

TEST(Result, EveryCodeHasItsOwnName) {
  std::set<std::string> names;
  for (int code = 0; code <= static_cast<int>(ErrorCode::kInternal); ++code) {
    names.insert(error_code_name(static_cast<ErrorCode>(code)));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(ErrorCode::kInternal) + 1);
  EXPECT_FALSE(names.contains("unknown"));
  EXPECT_STREQ(error_code_name(static_cast<ErrorCode>(999)), "unknown");
}

}  // namespace
}  // namespace farfield
