// SPDX-License-Identifier: Apache-2.0
#include "server/store/disk_database.h"

#include <vector>

#include "server/store/disk_store.h"

namespace farfield {
namespace {

constexpr int kBusyMs = 5000;  // another process writes
// Of 4 to 64 KiB this writes tiles fastest and wastes least (docs/store.md).
constexpr int kPageBytes = 32768;
constexpr int kCacheKiB = 32768;  // of the writer: the indices of a million tiles
constexpr int kEvictedAtOnce = 64;

std::int64_t as_signed(ContentHash hash) { return static_cast<std::int64_t>(hash); }

// Rewinds a statement when its use ends, however it ends.
class Use {
 public:
  explicit Use(SQLite::Statement& statement) : statement_(statement) {}
  ~Use() { statement_.tryReset(); }
  SQLite::Statement* operator->() { return &statement_; }

 private:
  SQLite::Statement& statement_;
};

}  // namespace

DiskDatabase::DiskDatabase(const std::filesystem::path& file, Access access)
    : database_(file.string(), access == Access::kWrite ? SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE : SQLite::OPEN_READONLY, kBusyMs) {
  if (access == Access::kWrite) {
    database_.exec(fmt::format("PRAGMA page_size={}; PRAGMA auto_vacuum=INCREMENTAL; PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL; "
                               "PRAGMA journal_size_limit={}; PRAGMA wal_autocheckpoint={}; PRAGMA cache_size=-{}",
                               kPageBytes, kDiskStoreLogBytes, kDiskStoreLogBytes / kPageBytes / 2, kCacheKiB));
    database_.exec("CREATE TABLE IF NOT EXISTS contents (number INTEGER PRIMARY KEY, hash INTEGER NOT NULL, bytes BLOB NOT NULL)");
    database_.exec("CREATE INDEX IF NOT EXISTS contents_hash ON contents(hash)");
    database_.exec("CREATE TABLE IF NOT EXISTS names (key BLOB PRIMARY KEY, content INTEGER NOT NULL, used INTEGER NOT NULL) WITHOUT ROWID");
    database_.exec("CREATE INDEX IF NOT EXISTS names_used ON names(used)");
    database_.exec("CREATE INDEX IF NOT EXISTS names_content ON names(content)");
    insert_name_.emplace(database_, "INSERT INTO names(key, content, used) VALUES (?, ?, ?) "
                                    "ON CONFLICT(key) DO UPDATE SET content=excluded.content, used=excluded.used");
    find_content_.emplace(database_, "SELECT number FROM contents WHERE hash=?");
    insert_content_.emplace(database_, "INSERT INTO contents(hash, bytes) VALUES (?, ?)");
    touch_.emplace(database_, "UPDATE names SET used=? WHERE key=?");
    content_of_name_.emplace(database_, "SELECT content FROM names WHERE key=?");
    erase_name_.emplace(database_, "DELETE FROM names WHERE key=?");
    has_name_.emplace(database_, "SELECT 1 FROM names WHERE content=? LIMIT 1");
    erase_content_.emplace(database_, "DELETE FROM contents WHERE number=?");
    oldest_.emplace(database_, "SELECT key FROM names ORDER BY used LIMIT ?");
    count_items();
  }
  find_.emplace(database_, "SELECT contents.hash, contents.bytes FROM names JOIN contents ON contents.number=names.content WHERE names.key=?");
}

std::optional<DiskDatabase::Found> DiskDatabase::find(const std::string& key) {
  Use row(*find_);
  row->bindNoCopy(1, key.data(), static_cast<int>(key.size()));
  if (!row->executeStep()) return std::nullopt;
  const SQLite::Column bytes = row->getColumn(1);
  const auto* begin = static_cast<const std::uint8_t*>(bytes.getBlob());
  return Found{static_cast<ContentHash>(row->getColumn(0).getInt64()), Bytes(begin, begin + bytes.getBytes())};
}

void DiskDatabase::insert(const std::string& key, ByteView bytes, std::int64_t used) {
  erase(key);  // what it named before may have no other name
  const std::int64_t content = content_of(bytes);
  Use name(*insert_name_);
  name->bindNoCopy(1, key.data(), static_cast<int>(key.size()));
  name->bind(2, content);
  name->bind(3, used);
  name->exec();
  ++items_;
}

std::int64_t DiskDatabase::content_of(ByteView bytes) {
  const std::int64_t hash = as_signed(hash_bytes(bytes));
  {
    Use known(*find_content_);
    known->bind(1, hash);
    if (known->executeStep()) return known->getColumn(0).getInt64();
  }
  Use content(*insert_content_);
  content->bind(1, hash);
  content->bindNoCopy(2, bytes.data(), static_cast<int>(bytes.size()));
  content->exec();
  return database_.getLastInsertRowid();
}

void DiskDatabase::touch(const std::string& key, std::int64_t used) {
  Use row(*touch_);
  row->bind(1, used);
  row->bindNoCopy(2, key.data(), static_cast<int>(key.size()));
  row->exec();
}

void DiskDatabase::erase(const std::string& key) {
  std::int64_t content = 0;
  {
    Use row(*content_of_name_);
    row->bindNoCopy(1, key.data(), static_cast<int>(key.size()));
    if (!row->executeStep()) return;
    content = row->getColumn(0).getInt64();
  }
  {
    Use row(*erase_name_);
    row->bindNoCopy(1, key.data(), static_cast<int>(key.size()));
    row->exec();
    --items_;
  }
  erase_content_without_name(content);
}

void DiskDatabase::erase_content_without_name(std::int64_t content) {
  {
    Use row(*has_name_);
    row->bind(1, content);
    if (row->executeStep()) return;
  }
  Use row(*erase_content_);
  row->bind(1, content);
  row->exec();
}

void DiskDatabase::erase_damaged(ContentHash content) {
  std::vector<std::int64_t> numbers;
  {
    Use row(*find_content_);
    row->bind(1, as_signed(content));
    while (row->executeStep()) numbers.push_back(row->getColumn(0).getInt64());
  }
  for (const std::int64_t number : numbers) {
    SQLite::Statement names(database_, "DELETE FROM names WHERE content=?");
    names.bind(1, number);
    items_ -= static_cast<std::uint64_t>(names.exec());
    Use row(*erase_content_);
    row->bind(1, number);
    row->exec();
  }
}

std::uint64_t DiskDatabase::evict_to(std::uint64_t bytes) {
  std::uint64_t evicted = 0;
  while (used_bytes() > bytes) {
    std::vector<std::string> keys;
    {
      Use row(*oldest_);
      row->bind(1, kEvictedAtOnce);
      while (row->executeStep()) keys.push_back(row->getColumn(0).getString());
    }
    if (keys.empty()) break;
    for (const std::string& key : keys) {
      erase(key);
      ++evicted;
      if (used_bytes() <= bytes) break;
    }
  }
  return evicted;
}

std::uint64_t DiskDatabase::pragma(const char* name) {
  return static_cast<std::uint64_t>(database_.execAndGet(fmt::format("PRAGMA {}", name)).getInt64());
}

std::uint64_t DiskDatabase::used_bytes() { return (pragma("page_count") - pragma("freelist_count")) * pragma("page_size"); }
void DiskDatabase::count_items() { items_ = static_cast<std::uint64_t>(database_.execAndGet("SELECT count(*) FROM names").getInt64()); }
std::int64_t DiskDatabase::latest_use() { return database_.execAndGet("SELECT coalesce(max(used), 0) FROM names").getInt64(); }
void DiskDatabase::shrink() { database_.exec("PRAGMA incremental_vacuum"); }

}  // namespace farfield
