// SPDX-License-Identifier: Apache-2.0
#include "server/app/baker.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <thread>
#include <unordered_set>
#include <utility>

namespace farfield {
namespace {

using Clock = std::chrono::steady_clock;

/// One answer, waited for.
template <class T>
class Reply {
 public:
  Answer<T> receiver() {
    return [state = state_](Result<T> value) {
      const std::lock_guard lock(state->mutex);
      if (!state->value) state->value.emplace(std::move(value));
      state->changed.notify_all();
    };
  }
  /// Returns: kCancelled once `is_stopped`.
  Result<T> wait(const std::atomic<bool>& is_stopped) {
    constexpr std::chrono::milliseconds kGlance{100};
    std::unique_lock lock(state_->mutex);
    while (!state_->changed.wait_for(lock, kGlance, [this] { return state_->value.has_value(); })) {
      if (is_stopped) return fail(ErrorCode::kCancelled, "stopped");
    }
    return std::move(*state_->value);
  }

 private:
  struct State {
    std::mutex mutex;
    std::condition_variable changed;
    std::optional<Result<T>> value;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

class Baker {
 public:
  Baker(MeasuredCellService& service, const BakeWork& work, const std::atomic<bool>& is_stopped)
      : service_(service), work_(work), is_stopped_(is_stopped), grid_{service.scene().settings.finest_side_m} {
    progress_.places = work.count;
  }

  void run() {
    for (std::uint64_t index = next_++; index < work_.count && !is_stopped_; index = next_++) {
      bake_at(work_.place(index));
      const std::lock_guard lock(mutex_);
      ++progress_.places_done;
    }
  }

  BakeProgress progress() const {
    const std::lock_guard lock(mutex_);
    BakeProgress result = progress_;
    result.tiles_made = service_.statistics().tile_seconds.count;
    result.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    if (result.places_done > 0 && result.places_done * 100 >= result.places) {
      const double share = static_cast<double>(result.places_done) / static_cast<double>(result.places);
      result.seconds_left = result.seconds * (1 - share) / share;
      result.bytes_expected = static_cast<std::uint64_t>(static_cast<double>(result.bytes) / share);
    }
    return result;
  }

 private:
  void bake_at(const glm::dvec3& viewpoint) {
    // Whoever comes back after a cut, or walks faster than cells arrive, begins anywhere.
    if (!work_.is_survey) bake_fallback(viewpoint);
    // On a path every finest cell is asked for, so that its leaf's name is stored too.
    if (work_.is_survey && is_known(viewpoint)) return;
    Reply<SharedPlan> reply;
    const Ticket ticket = service_.leaf(viewpoint, {0, 1, work_.is_survey}, reply.receiver());
    const Result<SharedPlan> whole = reply.wait(is_stopped_);
    if (!whole) {
      if (work_.is_survey && whole.error().code == ErrorCode::kNotFound) {
        const std::lock_guard lock(mutex_);
        ++progress_.blocked;
      } else {
        note(whole.error());
      }
      return;
    }
    const SharedPlan plan = work_.is_survey ? *whole : plan_at(*whole, grid_, viewpoint);
    {
      const std::lock_guard lock(mutex_);
      std::vector<EnclosureMask>& enclosures = baked_[plan->leaf];
      if (std::find(enclosures.begin(), enclosures.end(), plan->enclosure) != enclosures.end()) return;  // another thread's
      enclosures.push_back(plan->enclosure);
      progress_.leaves += enclosures.size() == 1;
    }
    if (work_.is_survey) bake_fallback(viewpoint);
    bake_tiles(*plan);
  }

  void bake_fallback(const glm::dvec3& viewpoint) {
    Reply<SharedPlan> reply;
    const Ticket ticket = service_.fallback(viewpoint, {0, 1, false}, reply.receiver());
    const Result<SharedPlan> plan = reply.wait(is_stopped_);
    if (plan) bake_tiles(**plan); else note(plan.error());
  }

  void bake_tiles(const LeafPlan& plan) {
    std::vector<std::pair<Reply<std::shared_ptr<const EncodedTile>>, Ticket>> asked;
    for (const NeededTile& needed : plan.tiles) {
      {
        const std::lock_guard lock(mutex_);
        if (!tiles_.insert(needed.id).second) continue;
      }
      Reply<std::shared_ptr<const EncodedTile>> reply;
      Ticket ticket = service_.tile(needed.id, {0, needed.view_share, false}, reply.receiver());
      asked.emplace_back(std::move(reply), std::move(ticket));
    }
    for (auto& [reply, ticket] : asked) {
      const auto tile = reply.wait(is_stopped_);
      if (!tile) {
        note(tile.error());
        continue;
      }
      const std::lock_guard lock(mutex_);
      ++progress_.tiles;
      progress_.bytes += (*tile)->bytes->size();
    }
  }

  bool is_known(const glm::dvec3& viewpoint) const {
    const std::lock_guard lock(mutex_);
    CellId cell = grid_.cell_at(viewpoint, 0);
    for (;;) {
      if (const auto found = baked_.find(cell); found != baked_.end()) {
        for (const EnclosureMask& enclosure : found->second) {
          if (enclosure.contains(grid_.box(cell), viewpoint)) return true;
        }
      }
      if (cell.level >= kMaxCellLevel) return false;
      cell = cell.parent();
    }
  }

  void note(const Error& error) {
    if (error.code == ErrorCode::kCancelled) return;
    const std::lock_guard lock(mutex_);
    if (progress_.failed++ == 0) progress_.first_error = error.message;
  }

  MeasuredCellService& service_;
  const BakeWork& work_;
  const std::atomic<bool>& is_stopped_;
  const CellGrid grid_;
  const Clock::time_point start_ = Clock::now();
  std::atomic<std::uint64_t> next_{0};
  mutable std::mutex mutex_;  // guards everything below
  BakeProgress progress_;
  std::unordered_map<CellId, std::vector<EnclosureMask>> baked_;  // leaves, and which of their enclosures
  std::unordered_set<TileId> tiles_;
};

}  // namespace

BakeProgress bake(MeasuredCellService& service, const BakeWork& work, int threads, const std::atomic<bool>& is_stopped,
                  const std::function<void(const BakeProgress&)>& report) {
  constexpr std::chrono::milliseconds kBetweenReports{1000};
  Baker baker(service, work, is_stopped);
  std::mutex mutex;
  std::condition_variable changed;
  int running = threads;
  std::vector<std::jthread> workers;
  for (int i = 0; i < threads; ++i) {
    workers.emplace_back([&] {
      baker.run();
      const std::lock_guard lock(mutex);
      --running;
      changed.notify_all();
    });
  }
  std::unique_lock lock(mutex);
  while (!changed.wait_for(lock, kBetweenReports, [&] { return running == 0; })) {
    lock.unlock();
    report(baker.progress());
    lock.lock();
  }
  lock.unlock();
  workers.clear();
  return baker.progress();
}

}  // namespace farfield
