// SPDX-License-Identifier: Apache-2.0
// Owners of OpenGL object names. Movable, not copyable; destroyed on the thread whose context made them, while that
// context is current.
#pragma once

#include <cstdint>
#include <utility>

namespace farfield::client {

enum class GlKind { kBuffer, kVertexArray, kTexture, kRenderbuffer, kFramebuffer, kProgram, kShader };

/// OpenGL's name for an object: GLuint without its header.
using GlName = std::uint32_t;

void delete_gl_object(GlKind kind, GlName name);
/// Requires: not a program or shader.
GlName make_gl_object(GlKind kind);

template <GlKind kKind>
class GlHandle {
 public:
  GlHandle() = default;
  explicit GlHandle(GlName name) : name_(name) {}
  GlHandle(GlHandle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlHandle& operator=(GlHandle&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlHandle() {
    if (name_ != 0) delete_gl_object(kKind, name_);
  }
  static GlHandle make() { return GlHandle(make_gl_object(kKind)); }

  GlName name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  GlName name_ = 0;
};

using BufferName = GlHandle<GlKind::kBuffer>;
using VertexArrayName = GlHandle<GlKind::kVertexArray>;
using TextureName = GlHandle<GlKind::kTexture>;
using RenderbufferName = GlHandle<GlKind::kRenderbuffer>;
using FramebufferName = GlHandle<GlKind::kFramebuffer>;
using ProgramName = GlHandle<GlKind::kProgram>;
using ShaderName = GlHandle<GlKind::kShader>;

}  // namespace farfield::client
