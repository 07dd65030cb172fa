// SPDX-License-Identifier: Apache-2.0
// The image a frame is drawn into: sRGB-coded 8-bit RGBA (the hardware encodes what shaders write in linear light,
// and averages multisamples in linear light) and a 32-bit float depth buffer (depth_convention.h).
#pragma once

#include <cstdint>
#include <span>

#include "client/gl/gl_context.h"
#include "client/gl/gl_handle.h"
#include "client/gl/program.h"
#include "common/base/result.h"

namespace farfield::client {

class Framebuffer {
 public:
  Framebuffer() = default;
  /// `samples`: 1, or the multisamples per pixel. Errors: kLimitExceeded: larger or more samples than the context can.
  static Result<Framebuffer> create(const GlAbilities& abilities, int width, int height, int samples);

  /// Makes it the target, sets the viewport, clears colour and depth to 0: nothing there, infinitely far.
  void begin();
  /// Averages multisamples; call once between the last draw and reading back. Depth becomes one of the samples'.
  void resolve();
  /// Rows top to bottom, R, G, B, A. Requires: out.size() == 4·width·height. Waits for drawing to end.
  void read_colour(std::span<std::uint8_t> out);
  /// near_plane / z, rows top to bottom, 0 where nothing was drawn. Requires: out.size() == width·height.
  void read_depth(std::span<float> out);

  int width() const { return width_; }
  int height() const { return height_; }
  int samples() const { return samples_; }
  /// The resolved colour image, for showing it. Rows bottom to top, as OpenGL has them.
  GlName colour_texture() const { return colour_.name(); }
  GlName depth_texture() const { return depth_.name(); }

 private:
  Status create_depth_reader();

  int width_ = 0, height_ = 0, samples_ = 1;
  bool can_read_depth_ = false;
  TextureName colour_, depth_;
  FramebufferName target_;
  RenderbufferName multisampled_colour_, multisampled_depth_;
  FramebufferName multisampled_;
  // For contexts that cannot read depth back: it is copied bit by bit into an integer image, which they can read.
  Program depth_reader_;
  TextureName depth_bits_;
  FramebufferName depth_bits_target_;
  VertexArrayName no_attributes_;
};

}  // namespace farfield::client
