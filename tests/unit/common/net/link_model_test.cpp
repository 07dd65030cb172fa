// SPDX-License-Identifier: Apache-2.0
#include "common/net/link_model.h"

#include <gtest/gtest.h>

namespace farfield {
namespace {

using Seconds = LinkShaper::Seconds;

TEST(LinkModel, ReadsEveryProperty) {
  const auto model = parse_link_model("rate=20mbit,delay=50ms,jitter=20ms,loss=0.1%");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_DOUBLE_EQ(model->rate_bits_per_second, 20e6);
  EXPECT_DOUBLE_EQ(model->delay.count(), 0.05);
  EXPECT_DOUBLE_EQ(model->jitter.count(), 0.02);
  EXPECT_DOUBLE_EQ(model->loss, 0.001);
  EXPECT_EQ(to_string(*model), "rate=20mbit,delay=50ms,jitter=20ms,loss=0.1%");
  EXPECT_EQ(to_string(*parse_link_model("none")), "none");
  EXPECT_DOUBLE_EQ(parse_link_model("delay=1.5s")->delay.count(), 1.5);
  EXPECT_DOUBLE_EQ(parse_link_model("cut=90s")->cut.count(), 90);
  EXPECT_FALSE(parse_link_model("cut=90s")->is_none());
  EXPECT_EQ(to_string(*parse_link_model("delay=5ms,cut=90s")), "delay=5ms,cut=90s");
}

TEST(LinkModel, RefusesWhatItDoesNotKnow) {
  for (const char* text : {"", "fast", "rate=20", "rate=20mb", "delay=5", "loss=3", "loss=101%", "rate=-1mbit", "rate=nanmbit",
                           "speed=3ms", "rate=1mbit,", "rate=1mbit,,delay=1ms", "cut=30", "cut=100000s"}) {
    const auto model = parse_link_model(text);
    ASSERT_FALSE(model) << text;
    EXPECT_EQ(model.error().code, ErrorCode::kInvalidArgument) << text;
  }
}

TEST(LinkShaper, RateAndDelayAddUp) {
  LinkShaper shaper(*parse_link_model("rate=8mbit,delay=50ms"), 1);
  EXPECT_NEAR(shaper.deliver(Seconds(0), 100000).count(), 0.15, 1e-12);       // 0.1 s on the link, then 50 ms
  EXPECT_NEAR(shaper.deliver(Seconds(0), 100000).count(), 0.25, 1e-12);       // queued behind the first
  EXPECT_NEAR(shaper.deliver(Seconds(10), 1000).count(), 10.051, 1e-12);      // the link has been idle
}

TEST(LinkShaper, NoModelIsNoDelay) {
  LinkShaper shaper({}, 1);
  EXPECT_DOUBLE_EQ(shaper.deliver(Seconds(3), std::size_t{1} << 30).count(), 3);
}

TEST(LinkShaper, JitterStaysWithinItsBoundsAndNeverReorders) {
  LinkShaper shaper(*parse_link_model("delay=10ms,jitter=20ms"), 5);
  double last = 0, smallest = 1, largest = 0;
  for (int i = 0; i < 2000; ++i) {
    const double now = i * 0.1;
    const double late = shaper.deliver(Seconds(now), 100).count();
    EXPECT_GE(late, last);
    last = late;
    smallest = std::min(smallest, late - now);
    largest = std::max(largest, late - now);
  }
  EXPECT_GE(smallest, 0.01);
  EXPECT_LT(smallest, 0.011);
  EXPECT_GT(largest, 0.029);
  EXPECT_LT(largest, 0.03);
}

TEST(LinkShaper, LossStallsForRoundTripsAtTheStatedShare) {
  LinkShaper shaper(*parse_link_model("delay=10ms,loss=2%"), 9);
  int stalled = 0;
  for (int i = 0; i < 20000; ++i) {
    const double late = shaper.deliver(Seconds(i * 1.0), 1000).count() - i;
    if (late > 0.0101) {
      ++stalled;
      EXPECT_NEAR(late, 0.03, 1e-9) << "one way plus a round trip";
    }
  }
  EXPECT_NEAR(stalled / 20000.0, 0.02, 0.005);
}

TEST(LinkShaper, TheSameSeedGivesTheSameLink) {
  const LinkModel model = *parse_link_model("rate=1mbit,delay=10ms,jitter=30ms,loss=5%");
  LinkShaper first(model, 3), same(model, 3), other(model, 4);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const double time = first.deliver(Seconds(i * 0.5), 3000).count();
    EXPECT_DOUBLE_EQ(time, same.deliver(Seconds(i * 0.5), 3000).count());
    differs |= std::abs(time - other.deliver(Seconds(i * 0.5), 3000).count()) > 1e-6;
  }
  EXPECT_TRUE(differs);
}

}  // namespace
}  // namespace farfield
