// SPDX-License-Identifier: Apache-2.0
#include "client/decode/decode_pool.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace farfield::client {
namespace {

std::size_t index_of(DecodeGroup group) { return std::min<std::size_t>(static_cast<std::size_t>(group), kDecodeGroups - 1); }

/// Libraries throw when memory runs out: this is the edge where that becomes an error.
Result<DecodedPayload> decode_at_edge(const PayloadDecoder& decoder, const EncodedPayload& payload) {
  try {
    return decoder.decode(payload);
  } catch (const std::exception& exception) {
    return fail(ErrorCode::kInternal, "{} {:016x}: decoding failed: {}", payload_kind_name(payload.name.kind),
                payload.name.key, exception.what());
  }
}

}  // namespace

DecodePool::DecodePool(PayloadDecoder decoder, int threads, Done done)
    : decoder_(std::move(decoder)), done_(std::move(done)) {
  for (int i = 0; i < std::max(1, threads); ++i) threads_.emplace_back([this] { run(); });
}

DecodePool::~DecodePool() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void DecodePool::submit(EncodedPayload payload, DecodeGroup group) {
  {
    const std::lock_guard lock(mutex_);
    queued_bytes_ += payload.bytes->size();
    waiting_[index_of(group)].push_back(std::move(payload));
  }
  wake_.notify_one();
}

void DecodePool::regroup(const std::function<DecodeGroup(const PayloadName&)>& group_of) {
  const std::lock_guard lock(mutex_);
  std::deque<EncodedPayload> sorted[kDecodeGroups];
  for (std::deque<EncodedPayload>& group : waiting_) {
    for (EncodedPayload& payload : group) sorted[index_of(group_of(payload.name))].push_back(std::move(payload));
  }
  std::swap(waiting_, sorted);
}

std::size_t DecodePool::queued_bytes() const {
  const std::lock_guard lock(mutex_);
  return queued_bytes_;
}

void DecodePool::run() {
  const auto next_group = [this] {
    return std::find_if(std::begin(waiting_), std::end(waiting_), [](const auto& group) { return !group.empty(); });
  };
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return is_stopping_ || next_group() != std::end(waiting_); });
    if (is_stopping_) return;
    const auto group = next_group();
    const EncodedPayload payload = std::move(group->front());
    group->pop_front();
    queued_bytes_ -= payload.bytes->size();
    lock.unlock();
    done_(payload.name, decode_at_edge(decoder_, payload));
    lock.lock();
  }
}

}  // namespace farfield::client
