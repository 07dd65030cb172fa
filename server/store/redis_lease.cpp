// SPDX-License-Identifier: Apache-2.0
#include "server/store/redis_lease.h"

#include <pthread.h>

#include <random>
#include <utility>

namespace farfield {
namespace {

// KEYS: value, lease; ARGV: owner, milliseconds.
constexpr std::string_view kAcquire =
    "if redis.call('EXISTS', KEYS[1]) == 1 then return 2 end "
    "local holder = redis.call('GET', KEYS[2]) "
    "if holder and holder ~= ARGV[1] then return 0 end "
    "redis.call('SET', KEYS[2], ARGV[1], 'PX', ARGV[2]) return 1";
// KEYS: lease; ARGV: owner. A lease that expired meanwhile may be another's.
constexpr std::string_view kRelease = "if redis.call('GET', KEYS[1]) == ARGV[1] then return redis.call('DEL', KEYS[1]) end return 0";
// KEYS: leases; ARGV: milliseconds, their owners.
constexpr std::string_view kRenew =
    "for i, lease in ipairs(KEYS) do "
    "if redis.call('GET', lease) == ARGV[i + 1] then redis.call('PEXPIRE', lease, ARGV[1]) end end return #KEYS";

std::string random_name() {
  std::random_device device;
  return fmt::format("{:08x}{:08x}", device(), device());
}

}  // namespace

RedisLease::RedisLease(std::shared_ptr<RedisClient> client, std::shared_ptr<RedisStore> store, std::chrono::milliseconds duration)
    : client_(std::move(client)), store_(std::move(store)), duration_(duration), process_(random_name()) {
  renewer_ = std::jthread([this](const std::stop_token& stop) { renew(stop); });
  pthread_setname_np(renewer_.native_handle(), "redis-lease");
}

RedisLease::~RedisLease() = default;

Turn RedisLease::acquire(const BlobKey& key) {
  std::string owner;
  {
    const std::scoped_lock lock(mutex_);
    owner = fmt::format("{}:{}", process_, ++acquired_);
  }
  const std::string value = redis_key(key), lease = redis_key(key, 'l'), milliseconds = std::to_string(duration_.count());
  const Result<RedisReply> reply = client_->run({"EVAL", kAcquire, "2", value, lease, owner, milliseconds});
  if (!reply || reply->kind != RedisReply::Kind::kInteger) return Turn::kAlone;
  if (reply->integer == 0) return Turn::kTheirs;
  if (reply->integer == 2) return Turn::kMade;
  const std::scoped_lock lock(mutex_);
  held_[key] = std::move(owner);
  changed_.notify_all();
  return Turn::kOurs;
}

void RedisLease::release(const BlobKey& key) {
  std::string owner;
  {
    const std::scoped_lock lock(mutex_);
    const auto at = held_.find(key);
    if (at == held_.end()) return;
    owner = std::move(at->second);
    held_.erase(at);
  }
  store_->run_after_inserts({"EVAL", std::string(kRelease), "1", redis_key(key, 'l'), std::move(owner)});
}

std::vector<bool> RedisLease::are_held(std::span<const BlobKey> keys) {
  std::vector<bool> held(keys.size(), false);
  if (keys.empty()) return held;
  std::vector<std::string> leases;
  for (const BlobKey& key : keys) leases.push_back(redis_key(key, 'l'));
  RedisCommand command{"MGET"};
  command.insert(command.end(), leases.begin(), leases.end());
  const Result<RedisReply> reply = client_->run(command);
  if (!reply || reply->list.size() != keys.size()) return held;
  for (std::size_t i = 0; i < keys.size(); ++i) held[i] = reply->list[i].kind == RedisReply::Kind::kBytes;
  return held;
}

void RedisLease::renew(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    changed_.wait(lock, stop, [this] { return !held_.empty(); });
    changed_.wait_for(lock, stop, duration_ / 3, [] { return false; });
    if (stop.stop_requested() || held_.empty()) continue;
    std::vector<std::string> arguments{"EVAL", std::string(kRenew), std::to_string(held_.size())};
    for (const auto& [key, owner] : held_) arguments.push_back(redis_key(key, 'l'));
    arguments.push_back(std::to_string(duration_.count()));
    for (const auto& [key, owner] : held_) arguments.push_back(owner);
    lock.unlock();
    (void)client_->run(RedisCommand(arguments.begin(), arguments.end()));
    lock.lock();
  }
}

}  // namespace farfield
