// SPDX-License-Identifier: Apache-2.0
#include "client/gl/framebuffer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstring>
#include <vector>

namespace farfield::client {
namespace {

constexpr const char* kFullScreenVertex = R"(#version 300 es
void main() {
  // One triangle that covers the screen.
  vec2 corner = vec2(float((gl_VertexID & 1) * 4 - 1), float((gl_VertexID & 2) * 2 - 1));
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";
constexpr const char* kDepthBitsFragment = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D depth_image;
layout(location = 0) out highp uvec4 bits;
void main() { bits = uvec4(floatBitsToUint(texelFetch(depth_image, ivec2(gl_FragCoord.xy), 0).r), 0u, 0u, 0u); }
)";

TextureName make_image(GLenum format, int width, int height) {
  TextureName texture = TextureName::make();
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexStorage2D(GL_TEXTURE_2D, 1, format, width, height);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

RenderbufferName make_multisampled(GLenum format, int width, int height, int samples) {
  RenderbufferName buffer = RenderbufferName::make();
  glBindRenderbuffer(GL_RENDERBUFFER, buffer.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  return buffer;
}

Status check_complete(const char* what) {
  const GLenum state = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (state == GL_FRAMEBUFFER_COMPLETE) return {};
  return fail(ErrorCode::kUnavailable, "OpenGL: the driver cannot draw into the {} image (status {:#x})", what, state);
}

/// OpenGL has the bottom row first.
template <class T>
void flip_rows(std::span<T> image, int height) {
  const std::size_t stride = image.size() / static_cast<std::size_t>(height);
  for (int low = 0, high = height - 1; low < high; ++low, --high) {
    std::swap_ranges(image.begin() + static_cast<std::ptrdiff_t>(low * stride),
                     image.begin() + static_cast<std::ptrdiff_t>((low + 1) * stride),
                     image.begin() + static_cast<std::ptrdiff_t>(high * stride));
  }
}

}  // namespace

Result<Framebuffer> Framebuffer::create(const GlAbilities& abilities, int width, int height, int samples) {
  if (width < 1 || height < 1 || std::max(width, height) > abilities.max_texture_edge) {
    return fail(ErrorCode::kLimitExceeded, "frame of {} x {} pixels: {} draws 1 to {} along an edge", width, height,
                abilities.renderer, abilities.max_texture_edge);
  }
  if (samples < 1 || samples > std::max(1, abilities.max_samples)) {
    return fail(ErrorCode::kLimitExceeded, "{} samples per pixel: {} offers at most {}", samples, abilities.renderer,
                std::max(1, abilities.max_samples));
  }
  Framebuffer result;
  result.width_ = width, result.height_ = height, result.samples_ = samples;
  result.can_read_depth_ = abilities.can_read_depth;
  result.colour_ = make_image(GL_SRGB8_ALPHA8, width, height);
  result.depth_ = make_image(GL_DEPTH_COMPONENT32F, width, height);
  result.target_ = FramebufferName::make();
  glBindFramebuffer(GL_FRAMEBUFFER, result.target_.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, result.colour_.name(), 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, result.depth_.name(), 0);
  if (Status ok = check_complete("frame's"); !ok) return tl::unexpected<Error>(ok.error());
  if (samples > 1) {
    result.multisampled_colour_ = make_multisampled(GL_SRGB8_ALPHA8, width, height, samples);
    result.multisampled_depth_ = make_multisampled(GL_DEPTH_COMPONENT32F, width, height, samples);
    result.multisampled_ = FramebufferName::make();
    glBindFramebuffer(GL_FRAMEBUFFER, result.multisampled_.name());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                              result.multisampled_colour_.name());
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, result.multisampled_depth_.name());
    if (Status ok = check_complete("multisampled"); !ok) return tl::unexpected<Error>(ok.error());
  }
  if (!result.can_read_depth_) {
    if (Status ok = result.create_depth_reader(); !ok) return tl::unexpected<Error>(ok.error());
  }
  return result;
}

Status Framebuffer::create_depth_reader() {
  Result<Program> program = Program::build("depth read-back", kFullScreenVertex, kDepthBitsFragment);
  if (!program) return tl::unexpected<Error>(program.error());
  depth_reader_ = std::move(*program);
  no_attributes_ = VertexArrayName::make();
  depth_bits_ = make_image(GL_R32UI, width_, height_);
  depth_bits_target_ = FramebufferName::make();
  glBindFramebuffer(GL_FRAMEBUFFER, depth_bits_target_.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, depth_bits_.name(), 0);
  return check_complete("depth read-back");
}

void Framebuffer::begin() {
  glBindFramebuffer(GL_FRAMEBUFFER, samples_ > 1 ? multisampled_.name() : target_.name());
  glViewport(0, 0, width_, height_);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glDisable(GL_SCISSOR_TEST);
  glClearColor(0, 0, 0, 0);
  glClearDepthf(0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void Framebuffer::resolve() {
  if (samples_ <= 1) return;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, multisampled_.name());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target_.name());
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
}

void Framebuffer::read_colour(std::span<std::uint8_t> out) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, out.data());
  flip_rows(out, height_);
}

void Framebuffer::read_depth(std::span<float> out) {
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  if (can_read_depth_) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.name());
    glReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, out.data());
  } else {
    glBindFramebuffer(GL_FRAMEBUFFER, depth_bits_target_.name());
    glViewport(0, 0, width_, height_);
    glDisable(GL_DEPTH_TEST);
    depth_reader_.use();
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, depth_.name());
    glBindVertexArray(no_attributes_.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    // Four integers per pixel is the one integer format every context must read.
    std::vector<std::uint32_t> bits(4 * out.size());
    glReadPixels(0, 0, width_, height_, GL_RGBA_INTEGER, GL_UNSIGNED_INT, bits.data());
    for (std::size_t i = 0; i < out.size(); ++i) std::memcpy(&out[i], &bits[4 * i], sizeof(float));
  }
  flip_rows(out, height_);
}

}  // namespace farfield::client
