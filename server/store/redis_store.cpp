// SPDX-License-Identifier: Apache-2.0
#include "server/store/redis_store.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

namespace farfield {
namespace {

constexpr std::size_t kBatchBytes = std::size_t{1} << 20;
constexpr std::size_t kBatchSteps = 256;
constexpr std::size_t kMostSteps = 100'000;  // whatever their size
constexpr std::chrono::milliseconds kBatchTimeout{2000};
constexpr std::chrono::milliseconds kBetweenLooks{100};
constexpr std::chrono::minutes kBetweenComplaints{1};

// What leases are taken for: of the rest, small and quickly made, everybody may make their own.
bool takes_turns(BlobKind kind) { return kind == BlobKind::kTile || kind == BlobKind::kPlan; }

char letter_of(BlobKind kind) {
  switch (kind) {
    case BlobKind::kTile: return 't';
    case BlobKind::kPlan: return 'p';
    case BlobKind::kLeafName: return 'n';
    case BlobKind::kFallback: return 'f';
    case BlobKind::kTransitions: return 'w';
  }
  return 'x';
}

std::string_view view_of(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// Of the key too: a value that came under another's name is damaged.
ContentHash checksum(std::string_view key, ByteView bytes) {
  return hash_bytes(bytes, hash_bytes({reinterpret_cast<const std::uint8_t*>(key.data()), key.size()}));
}

Bytes with_checksum(std::string_view key, const Bytes& bytes) {
  ByteWriter out;
  out.bytes().reserve(bytes.size() + sizeof(ContentHash));
  out.put_bytes(bytes);
  out.put(checksum(key, bytes));
  return out.take();
}

// Takes the checksum off. Returns: whether it was the right one.
bool strip_checksum(std::string_view key, Bytes& bytes) {
  if (bytes.size() < sizeof(ContentHash)) return false;
  const ByteView content = ByteView(bytes).first(bytes.size() - sizeof(ContentHash));
  const bool is_whole = ByteReader(ByteView(bytes).subspan(content.size())).get<ContentHash>() == checksum(key, content);
  bytes.resize(content.size());
  return is_whole;
}

}  // namespace

std::string redis_key(const BlobKey& key, char letter) { return fmt::format("ff:{}:", letter) + key.bytes(); }
std::string redis_key(const BlobKey& key) { return redis_key(key, letter_of(key.kind)); }

RedisStore::RedisStore(std::shared_ptr<RedisClient> client, RedisStoreOptions options) : client_(std::move(client)), options_(std::move(options)) {
  writer_thread_ = std::jthread([this](const std::stop_token& stop) { write(stop); });
  pthread_setname_np(writer_thread_.native_handle(), "redis-write");
}

RedisStore::~RedisStore() {
  writer_thread_.request_stop();
  writer_thread_.join();
}

SharedBytes RedisStore::find(const BlobKey& key) {
  {
    const std::scoped_lock lock(mutex_);
    if (const auto at = waiting_.find(key); at != waiting_.end()) {
      ++statistics_.hits;
      return at->second;
    }
  }
  const std::string name = redis_key(key);
  Result<RedisReply> reply = client_->run({"GET", name});
  const bool is_found = reply && reply->kind == RedisReply::Kind::kBytes;
  const bool is_whole = is_found && strip_checksum(name, reply->bytes);
  const std::scoped_lock lock(mutex_);
  if (is_whole) {
    ++statistics_.hits;
    return std::make_shared<const Bytes>(std::move(reply->bytes));
  }
  ++statistics_.misses;
  if (is_found) {
    ++statistics_.damaged;
    steps_.push_back({.key = key});
    changed_.notify_all();
  }
  return nullptr;
}

void RedisStore::insert(const BlobKey& key, SharedBytes bytes) {
  const std::scoped_lock lock(mutex_);
  if (waiting_bytes_ + bytes->size() > options_.waiting_bytes || steps_.size() >= kMostSteps) {
    ++statistics_.dropped;
    has_lost_ = true;
    return;
  }
  waiting_bytes_ += bytes->size();
  waiting_[key] = bytes;
  steps_.push_back({.key = key, .bytes = std::move(bytes)});
  changed_.notify_all();
}

void RedisStore::run_after_inserts(std::vector<std::string> command) {
  const std::scoped_lock lock(mutex_);
  if (steps_.size() >= kMostSteps) return;
  steps_.push_back({.command = std::move(command)});
  changed_.notify_all();
}

Status RedisStore::flush() {
  std::unique_lock lock(mutex_);
  while (!steps_.empty() || is_writing_) {
    written_.wait_for(lock, kBetweenLooks);
    if (!client_->is_there() && !is_writing_ && !steps_.empty()) {
      return fail(ErrorCode::kIo, "Redis at {} is gone: what waits is not written", to_string(client_->address()));
    }
  }
  if (!std::exchange(has_lost_, false)) return {};
  return fail(ErrorCode::kIo, "not everything could be written to Redis at {}", to_string(client_->address()));
}

BlobStoreStatistics RedisStore::statistics() const {
  const std::scoped_lock lock(mutex_);
  BlobStoreStatistics result = statistics_;
  result.tier = "redis";
  result.is_reachable = client_->is_there();
  return result;
}

void RedisStore::write(const std::stop_token& stop) {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, stop, [this] { return !steps_.empty(); });
      if (steps_.empty()) return;  // told to stop, and nothing waits
    }
    if (!client_->wait_until_there(stop, kBetweenLooks)) {
      if (stop.stop_requested()) return;
      continue;
    }
    std::unique_lock lock(mutex_);
    std::vector<Step> batch = take_batch();
    is_writing_ = true;
    lock.unlock();
    const bool is_done = send(batch);
    lock.lock();
    is_writing_ = false;
    if (is_done) {
      for (const Step& step : batch) forget_waiting(step);
    } else {
      // Leases are lost with the server that kept them; the rest is tried again when it is back.
      std::erase_if(batch, [](const Step& step) { return !step.command.empty(); });
      for (Step& step : batch) step.was_tried = true;
      steps_.insert(steps_.begin(), std::make_move_iterator(batch.begin()), std::make_move_iterator(batch.end()));
    }
    written_.notify_all();
  }
}

std::vector<RedisStore::Step> RedisStore::take_batch() {
  std::vector<Step> batch;
  for (std::size_t bytes = 0; !steps_.empty() && bytes < kBatchBytes && batch.size() < kBatchSteps; steps_.pop_front()) {
    bytes += steps_.front().bytes ? steps_.front().bytes->size() : 0;
    batch.push_back(std::move(steps_.front()));
  }
  return batch;
}

void RedisStore::forget_waiting(const Step& step) {
  if (!step.bytes) return;
  waiting_bytes_ -= step.bytes->size();
  // Inserted anew meanwhile, the later value still waits.
  if (const auto at = waiting_.find(step.key); at != waiting_.end() && at->second == step.bytes) waiting_.erase(at);
}

// Returns: whether Redis has answered; what it refused is counted and not tried again.
bool RedisStore::send(const std::vector<Step>& batch) {
  const std::string expiry = std::to_string(options_.expiry.count());
  std::vector<std::string> keys(batch.size());
  std::vector<Bytes> values(batch.size());
  std::vector<RedisCommand> commands;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Step& step = batch[i];
    if (!step.command.empty()) {
      commands.emplace_back(step.command.begin(), step.command.end());
      continue;
    }
    keys[i] = redis_key(step.key);
    if (!step.bytes) {
      commands.push_back({"DEL", keys[i]});
      continue;
    }
    values[i] = with_checksum(keys[i], *step.bytes);
    commands.push_back({"EXISTS", keys[i]});
    commands.push_back({"SET", keys[i], view_of(values[i]), "EX", expiry});
  }
  const Result<std::vector<RedisReply>> replies = client_->run(commands, kBatchTimeout);
  if (!replies) return false;
  std::string refusal;
  const std::scoped_lock lock(mutex_);
  for (std::size_t i = 0, at = 0; i < batch.size(); ++i, ++at) {
    if (!batch[i].bytes) continue;
    const RedisReply& existed = (*replies)[at];
    const RedisReply& written = (*replies)[++at];
    if (written.kind == RedisReply::Kind::kError) {
      refusal = written.text();
      ++statistics_.dropped;
      has_lost_ = true;
      continue;
    }
    ++statistics_.inserts;
    if (existed.integer > 0 && !batch[i].was_tried && takes_turns(batch[i].key.kind)) ++statistics_.rewritten;
  }
  if (!refusal.empty()) complain(refusal);
  return true;
}

// Requires: mutex_ held.
void RedisStore::complain(const std::string& what) {
  const auto now = std::chrono::steady_clock::now();
  if (!options_.log || now < next_complaint_) return;
  next_complaint_ = now + kBetweenComplaints;
  options_.log(fmt::format("Redis at {} refuses to keep what is made: {}", to_string(client_->address()), what));
}

}  // namespace farfield
