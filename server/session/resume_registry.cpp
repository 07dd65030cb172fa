// SPDX-License-Identifier: Apache-2.0
#include "server/session/resume_registry.h"

#include <algorithm>
#include <random>

namespace farfield {

std::string ResumeRegistry::open(std::function<void()> supersede) {
  std::random_device device;
  std::string token;
  for (int word = 0; word < 4; ++word) {
    const std::uint32_t bits = device();
    token.append(reinterpret_cast<const char*>(&bits), sizeof bits);
  }
  const std::lock_guard lock(mutex_);
  entries_[token].supersede = std::move(supersede);
  return token;
}

void ResumeRegistry::update(const std::string& token, ResumeState state) {
  const std::lock_guard lock(mutex_);
  if (const auto entry = entries_.find(token); entry != entries_.end()) entry->second.state = std::move(state);
}

void ResumeRegistry::close(const std::string& token, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const auto entry = entries_.find(token);
  if (entry == entries_.end()) return;
  entry->second.supersede = nullptr;
  entry->second.expires = now + keep_for_;
  drop_expired(now);
}

void ResumeRegistry::forget(const std::string& token) {
  const std::lock_guard lock(mutex_);
  entries_.erase(token);
}

std::optional<ResumeState> ResumeRegistry::claim(const std::string& token, Clock::time_point now) {
  std::function<void()> supersede;
  std::optional<ResumeState> state;
  {
    const std::lock_guard lock(mutex_);
    drop_expired(now);
    const auto entry = entries_.find(token);
    if (entry == entries_.end()) return std::nullopt;
    supersede = std::move(entry->second.supersede);
    state = std::move(entry->second.state);
    entries_.erase(entry);
  }
  if (supersede) supersede();
  return state;
}

std::size_t ResumeRegistry::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

void ResumeRegistry::drop_expired(Clock::time_point now) {
  std::erase_if(entries_, [&](const auto& entry) { return entry.second.expires && *entry.second.expires <= now; });
  // Live sessions are bounded elsewhere; of the others the one that would expire first goes.
  std::size_t waiting = 0;
  auto first = entries_.end();
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    if (!entry->second.expires) continue;
    ++waiting;
    if (first == entries_.end() || *entry->second.expires < *first->second.expires) first = entry;
  }
  if (waiting > capacity_) entries_.erase(first);
}

}  // namespace farfield
