// SPDX-License-Identifier: Apache-2.0
// Long data between two runs or processes of one build of Farfield: numbers are memory images, lists are a u64 count and their entries,
// texts and arrays a u64 count and their bytes or elements.
//
// Written in blocks with a running hash, so that gigabytes need no second copy; read from a view, every count checked against what is
// left before memory is taken.
#pragma once

#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/hash.h"

namespace farfield {

inline constexpr std::size_t kMemoryImageBlock = std::size_t{1} << 20;

/// Of bytes in blocks of kMemoryImageBlock, the last one shorter: what MemoryImageWriter::hash() says of the same bytes.
ContentHash memory_image_hash(ByteView bytes);

/// One thread. Call flush() at the end.
class MemoryImageWriter {
 public:
  /// `sink` is given full blocks, and what remains by flush().
  explicit MemoryImageWriter(std::function<void(ByteView)> sink) : sink_(std::move(sink)) { block_.reserve(kMemoryImageBlock); }

  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    put_raw(&value, sizeof(T));
  }
  template <class T>
  void put_array(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    put<std::uint64_t>(values.size());
    put_raw(values.data(), values.size() * sizeof(T));
  }
  void put_text(const std::string& text) {
    put<std::uint64_t>(text.size());
    put_raw(text.data(), text.size());
  }
  void put_texts(const std::vector<std::string>& texts) {
    put<std::uint64_t>(texts.size());
    for (const std::string& text : texts) put_text(text);
  }
  void flush();
  /// Of everything flushed.
  ContentHash hash() const { return hash_; }

 private:
  void put_raw(const void* data, std::size_t size);

  std::function<void(ByteView)> sink_;
  Bytes block_;
  ContentHash hash_ = 0;
};

/// Never reads past the end; after the first value that does not fit, is_valid() is false and everything read is zero or empty.
class MemoryImageReader {
 public:
  explicit MemoryImageReader(ByteView bytes) : bytes_(bytes) {}

  template <class T>
  T get() {
    return bytes_.get<T>();
  }
  /// A list's length, refused if the rest could not hold so many entries of at least `entry_bytes`.
  std::size_t get_count(std::size_t entry_bytes);
  template <class T>
  std::vector<T> get_array() {
    std::vector<T> values(get_count(sizeof(T)));
    const ByteView view = bytes_.get_bytes(values.size() * sizeof(T));
    if (!view.empty()) std::memcpy(values.data(), view.data(), view.size());
    return values;
  }
  std::string get_text();
  std::vector<std::string> get_texts();
  void require(bool condition) { is_valid_ = is_valid_ && condition; }
  bool is_valid() const { return is_valid_ && bytes_.ok(); }
  bool is_at_end() const { return bytes_.remaining() == 0; }

 private:
  ByteReader bytes_;
  bool is_valid_ = true;
};

}  // namespace farfield
