// SPDX-License-Identifier: Apache-2.0
// The disk tier over its life: reopened, too small, damaged, full, and used by many at once.
#include "server/store/disk_store.h"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <random>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

namespace fs = std::filesystem;

class DiskStoreTest : public testing::Test {
 protected:
  std::unique_ptr<BlobStore> open(std::uint64_t capacity = std::uint64_t{64} << 20) {
    auto store = open_disk_store({.folder = folder(), .capacity_bytes = capacity, .log = [this](const std::string& line) {
                                    const std::scoped_lock lock(mutex_);
                                    log_.push_back(line);
                                  }});
    EXPECT_TRUE(store) << store.error().message;
    return std::move(*store);
  }
  fs::path folder() const { return scratch_.path() / "store"; }
  fs::path file() const { return folder() / "cells.sqlite"; }
  std::size_t complaints() {
    const std::scoped_lock lock(mutex_);
    return log_.size();
  }
  // What one connection of our own does to the file behind the store's back.
  void execute(const char* sql) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file().c_str(), &database), SQLITE_OK);
    char* message = nullptr;
    EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, &message), SQLITE_OK) << message;
    sqlite3_close(database);
  }

  TemporaryFolder scratch_;
  std::mutex mutex_;
  std::vector<std::string> log_;
};

BlobKey key_of(int k, ContentHash world = 1) { return {.world = world, .kind = BlobKind::kTile, .name = {.cell = {.level = 1, .x = k}}}; }

// Bytes that do not compress and tell which they are.
SharedBytes blob_of(int k, std::size_t size = 1000) {
  std::mt19937 random(static_cast<unsigned>(k));
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return std::make_shared<const Bytes>(std::move(bytes));
}

bool holds(BlobStore& store, int k, std::size_t size = 1000) {
  const SharedBytes found = store.find(key_of(k));
  EXPECT_TRUE(!found || *found == *blob_of(k, size)) << "another's bytes under name " << k;
  return found != nullptr;
}

TEST_F(DiskStoreTest, WhatIsInsertedIsFoundAtOnceAndAfterReopening) {
  {
    const auto store = open();
    for (int k = 0; k < 500; ++k) store->insert(key_of(k), blob_of(k));
    for (int k = 0; k < 500; ++k) EXPECT_TRUE(holds(*store, k)) << "written or waiting";
    EXPECT_FALSE(holds(*store, 500));
    ASSERT_TRUE(store->flush());
    for (int k = 0; k < 500; ++k) EXPECT_TRUE(holds(*store, k));
    EXPECT_EQ(store->statistics().items, 500u);
    EXPECT_EQ(store->statistics().inserts, 500u);
  }
  const auto again = open();
  for (int k = 0; k < 500; ++k) EXPECT_TRUE(holds(*again, k));
  EXPECT_EQ(again->statistics().items, 500u);
  EXPECT_EQ(again->statistics().hits, 500u);
}

TEST_F(DiskStoreTest, DestroyingItWritesWhatWaitsAndLeavesOneFile) {
  open()->insert(key_of(1), blob_of(1));
  EXPECT_TRUE(holds(*open(), 1));
  EXPECT_TRUE(fs::exists(file()));
  EXPECT_FALSE(fs::exists(file().string() + "-wal"));
}

TEST_F(DiskStoreTest, WorldsAndKindsDoNotMix) {
  const auto store = open();
  store->insert(key_of(1), blob_of(1));
  ASSERT_TRUE(store->flush());
  EXPECT_FALSE(store->find(key_of(1, 2))) << "a changed model";
  BlobKey plan = key_of(1);
  plan.kind = BlobKind::kPlan;
  EXPECT_FALSE(store->find(plan));
}

TEST_F(DiskStoreTest, TheSameBytesUnderManyNamesAreKeptOnce) {
  const auto store = open();
  for (int k = 0; k < 100; ++k) store->insert(key_of(k), blob_of(7, 50000));
  ASSERT_TRUE(store->flush());
  EXPECT_LT(store->statistics().bytes, 500000u) << "not five million";
  for (int k = 0; k < 100; ++k) EXPECT_EQ(*store->find(key_of(k)), *blob_of(7, 50000));
}

TEST_F(DiskStoreTest, ANewValueTakesTheOldOnesPlace) {
  const auto store = open();
  for (const int value : {1, 2, 3}) {
    store->insert(key_of(0), blob_of(value));
    EXPECT_EQ(*store->find(key_of(0)), *blob_of(value));
    if (value > 1) {
      ASSERT_TRUE(store->flush());
    }
  }
  EXPECT_EQ(*store->find(key_of(0)), *blob_of(3));
  EXPECT_EQ(store->statistics().items, 1u);
}

// Inserted while an earlier value of the same name is being written, the later one must not be forgotten.
TEST_F(DiskStoreTest, TheLastOfManyValuesIsTheOneThatStays) {
  for (int round = 0; round < 20; ++round) {
    {
      const auto store = open();
      for (int k = 0; k < 300; ++k) store->insert(key_of(0), blob_of(k, 20000));
      ASSERT_TRUE(store->flush());
    }
    const SharedBytes found = open()->find(key_of(0));
    ASSERT_TRUE(found);
    ASSERT_EQ(*found, *blob_of(299, 20000)) << "in round " << round;
  }
}

TEST_F(DiskStoreTest, TheFileStaysWithinItsBoundAndWhatWasUsedLongestAgoGoesFirst) {
  constexpr std::uint64_t kCapacity = 4 << 20;
  const auto store = open(kCapacity);
  for (int k = 0; k < 2000; ++k) {
    store->insert(key_of(k), blob_of(k, 10000));
    if (k % 50 != 49) continue;
    ASSERT_TRUE(store->flush());
    EXPECT_TRUE(holds(*store, 0, 10000)) << "used again and again, after " << k;
    EXPECT_LE(store->statistics().bytes, kCapacity);
    EXPECT_LE(fs::file_size(file()), kCapacity + (1 << 20)) << "what one batch needs beyond";
  }
  EXPECT_TRUE(holds(*store, 1999, 10000));
  EXPECT_FALSE(holds(*store, 1, 10000));
  EXPECT_GT(store->statistics().evictions, 1000u);
  EXPECT_GE(store->statistics().bytes, kCapacity * 9 / 10) << "room that is there is used";
  EXPECT_TRUE(store->flush()) << "evicting is no failure";
}

TEST_F(DiskStoreTest, ASmallerBoundThanBeforeIsKeptFromTheStart) {
  {
    const auto store = open();
    for (int k = 0; k < 1000; ++k) store->insert(key_of(k), blob_of(k, 10000));
    ASSERT_TRUE(store->flush());
  }
  const auto store = open(2 << 20);
  EXPECT_LE(store->statistics().bytes, std::uint64_t{2} << 20);
  EXPECT_TRUE(holds(*store, 999, 10000));
  EXPECT_FALSE(holds(*store, 0, 10000));
  ASSERT_TRUE(store->flush());
  execute("PRAGMA wal_checkpoint(TRUNCATE)");
  EXPECT_LE(fs::file_size(file()), std::uint64_t{2} << 20) << "and the disk has the room";
}

TEST_F(DiskStoreTest, ADamagedBlobIsAMissAndCanBeWrittenAgain) {
  const auto store = open();
  for (int k = 0; k < 3; ++k) store->insert(key_of(k), blob_of(k));
  store->insert(key_of(3), blob_of(1));  // a second name of the same bytes
  ASSERT_TRUE(store->flush());
  execute("UPDATE contents SET bytes=zeroblob(1000) WHERE number=(SELECT content FROM names ORDER BY used LIMIT 1 OFFSET 1)");
  EXPECT_TRUE(holds(*store, 0));
  EXPECT_FALSE(store->find(key_of(1)));
  EXPECT_EQ(store->statistics().damaged, 1u);
  store->insert(key_of(1), blob_of(1));
  ASSERT_TRUE(store->flush());
  EXPECT_TRUE(holds(*store, 1)) << "repaired";
  EXPECT_FALSE(store->find(key_of(3))) << "its other name went with it";
  EXPECT_EQ(store->statistics().damaged, 1u);
}

TEST_F(DiskStoreTest, AFileThatIsNoDatabaseIsSetAsideAndANewOneBegun) {
  fs::create_directories(folder());
  std::ofstream(file()) << "this is no database, whatever its name says, and long enough to be looked at" << std::string(5000, 'x');
  const auto store = open();
  EXPECT_TRUE(fs::exists(file().string() + ".damaged"));
  EXPECT_EQ(complaints(), 1u);
  store->insert(key_of(1), blob_of(1));
  ASSERT_TRUE(store->flush());
  EXPECT_TRUE(holds(*store, 1));
}

TEST_F(DiskStoreTest, PagesDamagedWhileItRunsCostWhatTheyHeldAndNoMore) {
  constexpr int kBlobs = 300;
  {
    const auto store = open();
    for (int k = 0; k < kBlobs; ++k) store->insert(key_of(k), blob_of(k, 6000));
    ASSERT_TRUE(store->flush());
  }
  {
    // Every third stretch but the first, which says that this is a database.
    std::fstream stream(file(), std::ios::in | std::ios::out | std::ios::binary);
    const auto size = static_cast<std::streamoff>(fs::file_size(file()));
    const std::string garbage(4096, '\x5a');
    for (std::streamoff at = 4096; at + 4096 <= size; at += 3 * 4096) stream.seekp(at), stream.write(garbage.data(), 4096);
  }
  const auto store = open();
  for (int round = 0; round < 3; ++round)
    for (int k = 0; k < kBlobs; ++k)
      if (!holds(*store, k, 6000)) store->insert(key_of(k), blob_of(k, 6000)), (void)store->flush();
  for (int k = 0; k < kBlobs; ++k) EXPECT_TRUE(holds(*store, k, 6000)) << "made again and kept";
}

// A process that may not write files beyond a size stands for a disk that is full.
TEST_F(DiskStoreTest, AFullDiskLosesWhatWasToBeWrittenAndNothingElse) {
  const auto store = open();
  for (int k = 0; k < 100; ++k) store->insert(key_of(k), blob_of(k, 10000));
  ASSERT_TRUE(store->flush());
  const auto signal_before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit full = before;
  full.rlim_cur = fs::file_size(file());
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
  for (int k = 100; k < 600; ++k) store->insert(key_of(k), blob_of(k, 10000));
  const Status flushed = store->flush();
  const std::size_t said = complaints();
  for (int k = 0; k < 100; ++k) EXPECT_TRUE(holds(*store, k, 10000)) << "reading goes on";
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, signal_before);
  ASSERT_FALSE(flushed);
  EXPECT_EQ(flushed.error().code, ErrorCode::kIo);
  EXPECT_EQ(said, 1u) << "one line, however many could not be written";
  EXPECT_GT(store->statistics().dropped, 0u);
  for (int k = 100; k < 600; ++k) store->insert(key_of(k), blob_of(k, 10000));
  EXPECT_TRUE(store->flush()) << "there is room again";
  for (int k = 0; k < 600; ++k) EXPECT_TRUE(holds(*store, k, 10000));
}

TEST_F(DiskStoreTest, DamagedOnADiskThatIsFullItWaitsForRoom) {
  {
    const auto store = open();
    for (int k = 0; k < 50; ++k) store->insert(key_of(k), blob_of(k, 10000));
    ASSERT_TRUE(store->flush());
  }
  const auto store = open();
  const auto signal_before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit full = before;
  full.rlim_cur = 0;
  std::ofstream(file(), std::ios::binary) << std::string(100000, 'x');
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
  for (int round = 0; round < 4; ++round) {
    for (int k = 0; k < 50; ++k) (void)holds(*store, k, 10000);  // finds out that the file is damaged
    store->insert(key_of(100 + round), blob_of(100 + round, 10000));
    EXPECT_FALSE(store->flush());
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, signal_before);
  store->insert(key_of(1), blob_of(1, 10000));
  EXPECT_TRUE(store->flush());
  EXPECT_TRUE(holds(*store, 1, 10000));
}

TEST_F(DiskStoreTest, KilledWhileItWritesItLosesAtMostWhatWasNotFlushed) {
  int flushed[2];
  ASSERT_EQ(pipe(flushed), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto store = open_disk_store({.folder = folder()});
    for (int k = 0;; ++k) {
      (*store)->insert(key_of(k), blob_of(k));
      if (k % 20 == 19 && (*store)->flush()) (void)!write(flushed[1], &k, sizeof k);
    }
  }
  int last = 0;
  while (last < 1000 && read(flushed[0], &last, sizeof last) == sizeof last) continue;
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  close(flushed[0]), close(flushed[1]);
  const auto store = open();
  EXPECT_EQ(complaints(), 0u);
  for (int k = 0; k <= last; ++k) EXPECT_TRUE(holds(*store, k)) << k << " of " << last;
}

TEST_F(DiskStoreTest, ManyReadAndWriteAtOnce) {
  const auto store = open(8 << 20);
  std::atomic<int> found{0};
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&, t] {
        for (int k = 0; k < 500; ++k) {
          store->insert(key_of(k * 4 + t), blob_of(k * 4 + t, 3000));
          found += holds(*store, (k * 7919) % 2000, 3000);
        }
      });
  }
  ASSERT_TRUE(store->flush());
  EXPECT_GT(found, 0);
  for (int k = 0; k < 2000; ++k) (void)holds(*store, k, 3000);
  EXPECT_EQ(store->statistics().damaged, 0u);
}

TEST_F(DiskStoreTest, TwoProcessesShareAFolder) {
  const auto first = open(), second = open();
  first->insert(key_of(1), blob_of(1));
  second->insert(key_of(2), blob_of(2));
  ASSERT_TRUE(first->flush());
  ASSERT_TRUE(second->flush());
  EXPECT_TRUE(holds(*first, 2));
  EXPECT_TRUE(holds(*second, 1));
}

TEST_F(DiskStoreTest, SaysWhyItCannotBeOpened) {
  std::ofstream(scratch_.path() / "file") << "x";
  const auto in_file = open_disk_store({.folder = scratch_.path() / "file" / "store"});
  ASSERT_FALSE(in_file);
  EXPECT_EQ(in_file.error().code, ErrorCode::kIo);
  const auto too_small = open_disk_store({.folder = folder(), .capacity_bytes = 1000});
  ASSERT_FALSE(too_small);
  EXPECT_EQ(too_small.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace farfield
