// SPDX-License-Identifier: Apache-2.0
// Vertex, index and uniform storage.
#pragma once

#include <cstddef>
#include <span>

#include "client/gl/gl_handle.h"

namespace farfield::client {

/// Uploads go through GL_COPY_WRITE_BUFFER, so no vertex array's bindings are disturbed.
class Buffer {
 public:
  Buffer() = default;
  /// Storage that keeps its contents until written. `is_streamed`: rewritten every frame.
  static Buffer make(std::size_t bytes, bool is_streamed = false);

  /// Requires: offset + data fits.
  void write(std::size_t offset, std::span<const std::byte> data);
  /// Discards the old contents (their memory may still be in use by the driver) and grows where needed.
  void rewrite(std::span<const std::byte> data);

  std::size_t size_bytes() const { return size_bytes_; }
  GlName name() const { return name_.name(); }

 private:
  BufferName name_;
  std::size_t size_bytes_ = 0;
  bool is_streamed_ = false;
};

}  // namespace farfield::client
