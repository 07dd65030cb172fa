// SPDX-License-Identifier: Apache-2.0
#include "common/base/memory_image.h"

#include <algorithm>

namespace farfield {

ContentHash memory_image_hash(ByteView bytes) {
  ContentHash hash = 0;
  for (std::size_t at = 0; at < bytes.size(); at += kMemoryImageBlock) {
    hash = hash_bytes(bytes.subspan(at, std::min(kMemoryImageBlock, bytes.size() - at)), hash);
  }
  return hash;
}

void MemoryImageWriter::flush() {
  if (block_.empty()) return;
  hash_ = hash_bytes(block_, hash_);
  sink_(block_);
  block_.clear();
}

void MemoryImageWriter::put_raw(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  while (size > 0) {
    const std::size_t taken = std::min(size, kMemoryImageBlock - block_.size());
    block_.insert(block_.end(), bytes, bytes + taken);
    bytes += taken, size -= taken;
    if (block_.size() == kMemoryImageBlock) flush();
  }
}

std::size_t MemoryImageReader::get_count(std::size_t entry_bytes) {
  const auto count = bytes_.get<std::uint64_t>();
  if (count <= bytes_.remaining() / entry_bytes) return static_cast<std::size_t>(count);
  is_valid_ = false;
  return 0;
}

std::string MemoryImageReader::get_text() {
  const ByteView view = bytes_.get_bytes(get_count(1));
  return {reinterpret_cast<const char*>(view.data()), view.size()};
}

std::vector<std::string> MemoryImageReader::get_texts() {
  std::vector<std::string> texts;
  for (std::size_t left = get_count(sizeof(std::uint64_t)); left > 0 && is_valid(); --left) texts.push_back(get_text());
  return texts;
}

}  // namespace farfield
