// SPDX-License-Identifier: Apache-2.0
#include "server/store/disk_store.h"

#include <pthread.h>
#include <sqlite3.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <shared_mutex>
#include <thread>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/store/disk_database.h"

namespace farfield {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kBatchBytes = std::size_t{4} << 20;
// Uses are written with the next batch, or when so many wait: which was used last is only asked when something is evicted.
constexpr std::size_t kMostTouches = 4096;
// Room that evictions leave free beyond what is needed, so that not every batch evicts.
constexpr double kEvictTo = 0.98;
constexpr std::chrono::minutes kBetweenComplaints{1};

bool is_damage(int code) { return code == SQLITE_CORRUPT || code == SQLITE_NOTADB; }

class DiskStore final : public BlobStore {
 public:
  explicit DiskStore(DiskStoreOptions options) : options_(std::move(options)), file_(options_.folder / "cells.sqlite") {}

  Status open() {
    std::error_code error;
    std::filesystem::create_directories(options_.folder, error);
    if (error) return fail(ErrorCode::kIo, "the store's folder {} cannot be made: {}", options_.folder.string(), error.message());
    for (int tries = 0;; ++tries) {
      try {
        begin();
        break;
      } catch (const SQLite::Exception& e) {
        if (!is_damage(e.getErrorCode()) || tries > 0) {
          return fail(ErrorCode::kIo, "the store {} cannot be opened: {}", file_.string(), e.what());
        }
        set_aside();
      }
    }
    writer_thread_ = std::jthread([this](const std::stop_token& stop) { write(stop); });
    pthread_setname_np(writer_thread_.native_handle(), "disk-write");
    return {};
  }

  ~DiskStore() override {
    writer_thread_.request_stop();
    changed_.notify_all();
    if (writer_thread_.joinable()) writer_thread_.join();
    readers_.clear();  // the last to close the file empties its log into it, and readers may not write
  }

  SharedBytes find(const BlobKey& key) override {
    {
      const std::scoped_lock lock(mutex_);
      if (const auto at = waiting_.find(key); at != waiting_.end()) {
        ++statistics_.hits;
        return at->second;
      }
    }
    const std::string name = key.bytes();
    std::optional<DiskDatabase::Found> found;
    bool is_broken = false;
    try {
      const std::shared_lock file_lock(file_mutex_);
      auto reader = take_reader();
      found = reader->find(name);
      give_back(std::move(reader));
    } catch (const SQLite::Exception& e) {
      is_broken = is_damage(e.getErrorCode());
      complain(fmt::format("reading failed, taken for missing: {}", e.what()));
    }
    const bool is_whole = found && hash_bytes(found->bytes) == found->content;
    const std::scoped_lock lock(mutex_);
    if (is_whole) {
      ++statistics_.hits;
      touched_.push_back(name);
      if (touched_.size() >= kMostTouches) changed_.notify_all();
      return std::make_shared<const Bytes>(std::move(found->bytes));
    }
    ++statistics_.misses;
    if (found) ++statistics_.damaged, damaged_.push_back(found->content), changed_.notify_all();
    if (is_broken) ++statistics_.damaged, is_file_damaged_ = true, changed_.notify_all();
    return nullptr;
  }

  void insert(const BlobKey& key, SharedBytes bytes) override {
    const std::scoped_lock lock(mutex_);
    if (waiting_bytes_ + bytes->size() > options_.waiting_bytes || bytes->size() > options_.capacity_bytes / 4) {
      ++statistics_.dropped;
      has_lost_ = true;
      return;
    }
    const auto [at, is_new] = waiting_.try_emplace(key, bytes);
    if (is_new) {
      order_.push_back(key);
    } else {
      waiting_bytes_ -= at->second->size();
      at->second = bytes;
    }
    waiting_bytes_ += bytes->size();
    changed_.notify_all();
  }

  Status flush() override {
    std::unique_lock lock(mutex_);
    written_.wait(lock, [this] { return order_.empty() && !is_writing_; });
    if (!std::exchange(has_lost_, false)) return {};
    return fail(ErrorCode::kIo, "not everything could be written to the store {}: {}", file_.string(), last_failure_.empty() ? "the disk is too slow" : last_failure_);
  }

  BlobStoreStatistics statistics() const override {
    const std::scoped_lock lock(mutex_);
    BlobStoreStatistics result = statistics_;
    result.capacity_bytes = options_.capacity_bytes;
    return result;
  }

 private:
  // ── connections ──
  void begin() {
    writer_ = std::make_unique<DiskDatabase>(file_, DiskDatabase::Access::kWrite);
    last_use_ = writer_->latest_use();
    evict_to(options_.capacity_bytes);
    const std::scoped_lock lock(mutex_);
    statistics_.items = writer_->items(), statistics_.bytes = writer_->used_bytes();
  }

  // A file that is no database any more is kept for whoever wants to know why, in place of an earlier one.
  void set_aside() {
    std::error_code ignored;
    const std::filesystem::path aside = file_.string() + ".damaged";
    std::filesystem::rename(file_, aside, ignored);
    for (const char* companion : {"-wal", "-shm"}) std::filesystem::remove(file_.string() + companion, ignored);
    complain(fmt::format("the file is damaged: kept as {}, and a new one begun", aside.string()));
  }

  std::unique_ptr<DiskDatabase> take_reader() {
    {
      const std::scoped_lock lock(readers_mutex_);
      if (!readers_.empty()) {
        auto reader = std::move(readers_.back());
        readers_.pop_back();
        return reader;
      }
    }
    return std::make_unique<DiskDatabase>(file_, DiskDatabase::Access::kRead);
  }
  void give_back(std::unique_ptr<DiskDatabase> reader) {
    const std::scoped_lock lock(readers_mutex_);
    readers_.push_back(std::move(reader));
  }

  void reopen() {
    const std::unique_lock file_lock(file_mutex_);
    readers_.clear();
    writer_.reset();
    set_aside();
    begin();
  }

  // ── the writer's thread ──
  struct Batch {
    std::vector<std::pair<BlobKey, SharedBytes>> blobs;
    std::vector<std::string> touched;
    std::vector<ContentHash> damaged;
    std::uint64_t bytes = 0;
    bool is_file_damaged = false;
  };

  void write(const std::stop_token& stop) {
    for (;;) {
      Batch batch;
      {
        std::unique_lock lock(mutex_);
        const auto has_work = [this] { return !order_.empty() || !damaged_.empty() || is_file_damaged_ || touched_.size() >= kMostTouches; };
        changed_.wait(lock, stop, has_work);
        if (!has_work() && touched_.empty() && stop.stop_requested()) return;
        batch = take_batch();
        is_writing_ = true;
      }
      const bool is_done = store(batch);
      const std::scoped_lock lock(mutex_);
      is_writing_ = false;
      for (const auto& [key, bytes] : batch.blobs) {
        const auto at = waiting_.find(key);
        if (at == waiting_.end()) continue;
        if (at->second != bytes) {  // inserted anew meanwhile
          order_.push_back(key);
          continue;
        }
        waiting_bytes_ -= bytes->size();
        waiting_.erase(at);
      }
      (is_done ? statistics_.inserts : statistics_.dropped) += batch.blobs.size();
      has_lost_ = has_lost_ || (!is_done && !batch.blobs.empty());
      written_.notify_all();
    }
  }

  // Requires: mutex_ held.
  Batch take_batch() {
    Batch batch;
    while (!order_.empty() && batch.bytes < kBatchBytes) {
      const BlobKey key = order_.front();
      order_.pop_front();
      const auto at = waiting_.find(key);
      if (at == waiting_.end()) continue;
      batch.bytes += at->second->size();
      batch.blobs.emplace_back(key, at->second);
    }
    batch.touched = std::exchange(touched_, {});
    batch.damaged = std::exchange(damaged_, {});
    batch.is_file_damaged = std::exchange(is_file_damaged_, false);
    return batch;
  }

  bool store(const Batch& batch) {
    for (int tries = 0; tries < 2; ++tries) {
      try {
        if (batch.is_file_damaged && tries == 0) reopen();
        if (!writer_) begin();
        commit(batch);
        return true;
      } catch (const SQLite::Exception& e) {
        last_failure(e.what());
        complain(fmt::format("writing failed, {} tiles and plans will be made again when they are next wanted: {}", batch.blobs.size(), e.what()));
        try {
          if (!is_damage(e.getErrorCode())) {
            if (writer_) writer_->count_items();  // null: nothing could be opened, and the next batch tries again
            return false;
          }
          reopen();
        } catch (const SQLite::Exception&) {
          return false;  // nothing can be opened there now; the next batch tries again
        }
      }
    }
    return false;
  }

  void commit(const Batch& batch) {
    auto transaction = writer_->transaction();
    for (const ContentHash content : batch.damaged) writer_->erase_damaged(content);
    for (const std::string& name : batch.touched) writer_->touch(name, ++last_use_);
    const std::uint64_t evicted = make_room(batch.bytes + 256 * batch.blobs.size());
    for (const auto& [key, bytes] : batch.blobs) writer_->insert(key.bytes(), *bytes, ++last_use_);
    // Pages do not fill up: what was expected to fit may not.
    const std::uint64_t more = writer_->evict_to(options_.capacity_bytes);
    transaction.commit();
    const std::scoped_lock lock(mutex_);
    statistics_.evictions += evicted + more;
    statistics_.bytes = writer_->used_bytes(), statistics_.items = writer_->items();
  }

  std::uint64_t make_room(std::uint64_t bytes) {
    if (writer_->used_bytes() + bytes <= options_.capacity_bytes) return 0;
    const auto target = static_cast<std::uint64_t>(kEvictTo * static_cast<double>(options_.capacity_bytes));
    return writer_->evict_to(target > bytes ? target - bytes : 0);
  }

  // What an earlier, larger bound left.
  void evict_to(std::uint64_t bytes) {
    if (writer_->used_bytes() <= bytes) return;
    auto transaction = writer_->transaction();
    writer_->evict_to(bytes);
    transaction.commit();
    writer_->shrink();
  }

  // ── saying what went wrong ──
  void complain(const std::string& what) {
    if (!options_.log) return;
    {
      const std::scoped_lock lock(complaint_mutex_);
      if (complained_ && Clock::now() - *complained_ < kBetweenComplaints) return;
      complained_ = Clock::now();
    }
    options_.log(fmt::format("store {}: {}", file_.string(), what));
  }
  void last_failure(const std::string& what) {
    const std::scoped_lock lock(mutex_);
    last_failure_ = what;
  }

  const DiskStoreOptions options_;
  const std::filesystem::path file_;

  std::shared_mutex file_mutex_;  // shared: somebody reads; exclusive: the file is replaced. Taken before the next.
  std::mutex readers_mutex_;      // guards readers_
  std::vector<std::unique_ptr<DiskDatabase>> readers_;  // not in use

  std::unique_ptr<DiskDatabase> writer_;  // the writer thread's alone, once open
  std::int64_t last_use_ = 0;             // likewise

  mutable std::mutex mutex_;  // guards everything below but the last two
  std::condition_variable_any changed_, written_;
  std::unordered_map<BlobKey, SharedBytes> waiting_;
  std::deque<BlobKey> order_;  // of waiting_
  std::size_t waiting_bytes_ = 0;
  std::vector<std::string> touched_;
  std::vector<ContentHash> damaged_;
  bool is_file_damaged_ = false, is_writing_ = false, has_lost_ = false;
  std::string last_failure_;
  BlobStoreStatistics statistics_;

  std::mutex complaint_mutex_;  // guards complained_
  std::optional<Clock::time_point> complained_;
  std::jthread writer_thread_;
};

}  // namespace

Result<std::unique_ptr<BlobStore>> open_disk_store(DiskStoreOptions options) {
  if (options.capacity_bytes < kLeastDiskStoreBytes) {
    return fail(ErrorCode::kInvalidArgument, "a disk store needs at least {} bytes, not {}", kLeastDiskStoreBytes, options.capacity_bytes);
  }
  auto store = std::make_unique<DiskStore>(std::move(options));
  if (const Status opened = store->open(); !opened) return tl::unexpected(opened.error());
  return store;
}

}  // namespace farfield
