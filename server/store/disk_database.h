// SPDX-License-Identifier: Apache-2.0
// The tables of the disk store and what is asked of them. One connection; not thread-safe. Failures throw SQLite::Exception: the
// disk store catches them.
//
//   names     key (primary) · content: its number · used: grows with every use
//   contents  number, in the order of writing (primary) · hash of the bytes · bytes
//
// Contents are numbered so that new ones go to the file's end: by hash they would go anywhere, at a quarter of the speed.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <optional>
#include <string>

#include "common/base/bytes.h"
#include "common/base/hash.h"

namespace farfield {

class DiskDatabase {
 public:
  enum class Access { kRead, kWrite };
  /// Makes file and tables if they are not there and `access` says so.
  DiskDatabase(const std::filesystem::path& file, Access access);

  struct Found {
    ContentHash content = 0;  // as it was when written
    Bytes bytes;
  };
  std::optional<Found> find(const std::string& key);

  // ── writing, inside a transaction ──
  using Transaction = SQLite::Transaction;
  /// Takes the file's one right to write now, not at the first change: waits for other processes here.
  Transaction transaction() { return Transaction(database_, SQLite::TransactionBehavior::IMMEDIATE); }
  void insert(const std::string& key, ByteView bytes, std::int64_t used);
  void touch(const std::string& key, std::int64_t used);
  void erase(const std::string& key);
  /// A content that is not what its hash says, and all its names.
  void erase_damaged(ContentHash content);
  /// Forgets names used longest ago, until the file would shrink to `bytes`. Returns: how many.
  std::uint64_t evict_to(std::uint64_t bytes);

  /// Pages in use, as bytes.
  std::uint64_t used_bytes();
  /// Names, as this connection counted them: what other processes add is seen by count_items().
  std::uint64_t items() const { return items_; }
  /// O(items): when it is opened, and after a transaction was given up.
  void count_items();
  std::int64_t latest_use();
  /// Gives all free pages back to the disk. Outside a transaction.
  void shrink();

 private:
  std::int64_t content_of(ByteView bytes);
  void erase_content_without_name(std::int64_t content);
  std::uint64_t pragma(const char* name);

  SQLite::Database database_;
  std::uint64_t items_ = 0;
  std::optional<SQLite::Statement> find_, insert_name_, find_content_, insert_content_, touch_, content_of_name_, erase_name_, has_name_, erase_content_, oldest_;
};

}  // namespace farfield
