// SPDX-License-Identifier: Apache-2.0
#include "client/gl/buffer.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace farfield::client {

Buffer Buffer::make(std::size_t bytes, bool is_streamed) {
  Buffer buffer;
  buffer.name_ = BufferName::make();
  buffer.size_bytes_ = bytes;
  buffer.is_streamed_ = is_streamed;
  glBindBuffer(GL_COPY_WRITE_BUFFER, buffer.name());
  glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr,
               is_streamed ? GL_STREAM_DRAW : GL_STATIC_DRAW);
  return buffer;
}

void Buffer::write(std::size_t offset, std::span<const std::byte> data) {
  glBindBuffer(GL_COPY_WRITE_BUFFER, name());
  glBufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(data.size()),
                  data.data());
}

void Buffer::rewrite(std::span<const std::byte> data) {
  size_bytes_ = std::max(size_bytes_, data.size());
  glBindBuffer(GL_COPY_WRITE_BUFFER, name());
  glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(size_bytes_), nullptr,
               is_streamed_ ? GL_STREAM_DRAW : GL_STATIC_DRAW);
  glBufferSubData(GL_COPY_WRITE_BUFFER, 0, static_cast<GLsizeiptr>(data.size()), data.data());
}

}  // namespace farfield::client
