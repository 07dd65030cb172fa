// SPDX-License-Identifier: Apache-2.0
// A network link in numbers, and when bytes that enter it come out: pure arithmetic over a virtual clock.
//
// TCP hides loss by sending again: a lost packet delays everything behind it by a round trip, it never reorders or
// drops bytes. That is what `loss` does here.
#pragma once

#include <chrono>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace farfield {

/// One direction of a link. The default is no link at all: every byte passes at once.
struct LinkModel {
  double rate_bits_per_second = 0;              // 0: unlimited
  std::chrono::duration<double> delay{0};       // one way
  std::chrono::duration<double> jitter{0};      // added to the delay, uniform in [0, jitter)
  double loss = 0;                              // share of packets lost, 0 … 1
  std::chrono::duration<double> cut{0};         // mean time until a connection breaks, whatever was before; 0: never

  bool is_none() const {
    return !(rate_bits_per_second > 0) && !(delay.count() > 0) && !(jitter.count() > 0) && !(loss > 0) && !(cut.count() > 0);
  }
  std::size_t bandwidth_delay_bytes() const;
};

/// "rate=20mbit,delay=50ms,jitter=20ms,loss=0.1%,cut=30s" in any order and choice, or "none". Rates in bit, kbit, mbit, gbit
/// (per second, factors of 1000), times in us, ms, s; loss in percent. Errors: kInvalidArgument.
Result<LinkModel> parse_link_model(std::string_view text);
std::string to_string(const LinkModel& model);

/// Bytes in, delivery times out. Deterministic by seed. Not thread-safe.
class LinkShaper {
 public:
  using Seconds = std::chrono::duration<double>;  // since any fixed start

  LinkShaper(const LinkModel& model, std::uint64_t seed) : model_(model), random_(seed) {}

  /// When the last of `bytes` that enter at `now` comes out; never earlier than anything that entered before.
  Seconds deliver(Seconds now, std::size_t bytes);

 private:
  LinkModel model_;
  std::mt19937_64 random_;
  Seconds link_free_{0};       // when the last byte queued so far will have been put on the link
  Seconds last_delivery_{0};
};

}  // namespace farfield
