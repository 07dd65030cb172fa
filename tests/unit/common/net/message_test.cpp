// SPDX-License-Identifier: Apache-2.0
#include "common/net/message.h"

#include <gtest/gtest.h>

#include "proto/farfield.pb.h"

namespace farfield {
namespace {

TEST(Message, TextThatIsNotUtf8IsAnErrorAndNothingIsPrinted) {
  IncomingFrame frame;
  frame.type = static_cast<decltype(frame.type)>(MessageType::kHello);
  frame.message = {0x1a, 0x02, 0xff, 0xfe};  // Hello.program of two bytes
  testing::internal::CaptureStderr();
  const Result<wire::Hello> hello = parse_message<wire::Hello>(frame);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_FALSE(hello);
  EXPECT_EQ(hello.error().code, ErrorCode::kBadData);
  EXPECT_NE(hello.error().message.find("Hello"), std::string::npos);
}

}  // namespace
}  // namespace farfield
