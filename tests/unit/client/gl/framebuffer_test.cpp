// SPDX-License-Identifier: Apache-2.0
#include "client/gl/framebuffer.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "client/gl/depth_convention.h"

namespace farfield::client {
namespace {

constexpr const char* kVertex = R"(#version 300 es
uniform vec2 depth_scale_bias;
uniform float z;
void main() {
  vec2 corner = vec2(float((gl_VertexID & 1) * 4 - 1), float((gl_VertexID & 2) * 2 - 1));
  gl_Position = vec4(corner * z, depth_scale_bias.x * 0.01 - depth_scale_bias.y * z, z);
}
)";
// Column x shows x/width in linear light; the lower half of the image stays empty.
constexpr const char* kRamp = R"(#version 300 es
precision highp float;
uniform float width;
layout(location = 0) out vec4 colour;
void main() {
  if (gl_FragCoord.y < 4.0) discard;
  colour = vec4(vec3(gl_FragCoord.x / width), 1.0);
}
)";

class FramebufferTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = GlContext::create_surfaceless();
    ASSERT_TRUE(context) << context.error().message;
    context_ = std::move(*context);
  }
  // Draws the ramp at distance z and reads everything back.
  void draw(const GlAbilities& abilities, int samples, float z) {
    auto frame = Framebuffer::create(abilities, kWidth, kHeight, samples);
    ASSERT_TRUE(frame) << frame.error().message;
    auto program = Program::build("ramp", kVertex, kRamp);
    ASSERT_TRUE(program) << program.error().message;
    frame->begin();
    begin_scene_drawing(abilities);
    program->use();
    const auto depth = DepthConvention::of(abilities);
    glUniform2f(program->uniform("depth_scale_bias"), depth.scale, depth.bias);
    glUniform1f(program->uniform("z"), z);
    glUniform1f(program->uniform("width"), kWidth);
    const VertexArrayName none = VertexArrayName::make();
    glBindVertexArray(none.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    frame->resolve();
    colour_.resize(4 * kWidth * kHeight);
    depth_.resize(kWidth * kHeight);
    frame->read_colour(colour_);
    frame->read_depth(depth_);
  }
  static constexpr int kWidth = 1024, kHeight = 8;
  std::unique_ptr<GlContext> context_;
  std::vector<std::uint8_t> colour_;
  std::vector<float> depth_;
};

TEST_F(FramebufferTest, EncodesLinearLightToWithinOneCode) {
  draw(context_->abilities(), 1, 1.0f);
  int off_by_one = 0;
  for (int x = 0; x < kWidth; ++x) {
    const double linear = (x + 0.5) / kWidth;
    const double coded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    const int expected = static_cast<int>(std::lround(coded * 255));
    const int difference = std::abs(expected - colour_[4 * x]);
    EXPECT_LE(difference, 1) << "column " << x;
    off_by_one += difference;
  }
  // OpenGL allows an encoder 0.6 of a code, so a tenth of the values may round the other way (7 % with llvmpipe):
  // a mean squared error of 0.1, 58 dB, far below what sampling costs.
  EXPECT_LE(off_by_one, kWidth / 10);
}

TEST_F(FramebufferTest, RowsComeTopFirstAndEmptyPixelsAreZero) {
  draw(context_->abilities(), 1, 1.0f);
  EXPECT_EQ(colour_[4 * 500 + 3], 255);                           // top row
  EXPECT_EQ(colour_[4 * ((kHeight - 1) * kWidth + 500) + 3], 0);  // bottom row
  EXPECT_EQ(depth_[(kHeight - 1) * kWidth + 500], 0.0f);
}

TEST_F(FramebufferTest, DepthIsNearOverZAtAnyDistance) {
  for (const float z : {0.02f, 1.0f, 1e3f, 1e6f}) {
    draw(context_->abilities(), 1, z);
    const float tolerance = context_->abilities().has_clip_control ? 1e-6f * 0.01f / z : 1.2e-7f;
    EXPECT_NEAR(depth_[500], 0.01f / z, tolerance);
  }
}

TEST_F(FramebufferTest, ContextsWithoutTheExtensionsGiveTheSameDepth) {
  GlAbilities plain = context_->abilities();
  plain.can_read_depth = false;
  draw(plain, 1, 4.0f);
  EXPECT_NEAR(depth_[500], 0.01f / 4, 1e-9);
  EXPECT_EQ(depth_[(kHeight - 1) * kWidth + 500], 0.0f);
}

TEST_F(FramebufferTest, WithoutClipControlTheSameWindowDepth) {
  GlAbilities plain = context_->abilities();
  plain.has_clip_control = false;
  draw(plain, 1, 4.0f);
  EXPECT_NEAR(depth_[500], 0.01f / 4, 1.2e-7);
}

TEST_F(FramebufferTest, MultisamplesResolve) {
  draw(context_->abilities(), 4, 1.0f);
  EXPECT_EQ(colour_[4 * 500 + 3], 255);
  EXPECT_NEAR(depth_[500], 0.01f, 1e-8);
}

TEST_F(FramebufferTest, MultisamplesAverageInLinearLight) {
  auto frame = Framebuffer::create(context_->abilities(), 64, 64, 4);
  ASSERT_TRUE(frame) << frame.error().message;
  auto program = Program::build("edge", R"(#version 300 es
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 0.9 : -0.8, gl_VertexID == 2 ? 0.95 : -0.9);
  gl_Position = vec4(corner, 0.5, 1.0);
}
)",
                                R"(#version 300 es
precision highp float;
layout(location = 0) out vec4 colour;
void main() { colour = vec4(1.0); }
)");
  ASSERT_TRUE(program) << program.error().message;
  frame->begin();
  begin_scene_drawing(context_->abilities());
  program->use();
  const VertexArrayName none = VertexArrayName::make();
  glBindVertexArray(none.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  frame->resolve();
  std::vector<std::uint8_t> colour(4 * 64 * 64);
  frame->read_colour(colour);
  int partial = 0;
  for (std::size_t p = 0; p < 64 * 64; ++p) {
    const double share = colour[4 * p + 3] / 255.0;
    const double coded = share <= 0.0031308 ? 12.92 * share : 1.055 * std::pow(share, 1 / 2.4) - 0.055;
    EXPECT_NEAR(colour[4 * p], 255 * coded, 2);  // half covered is 188, not 128
    partial += colour[4 * p + 3] > 0 && colour[4 * p + 3] < 255;
  }
  EXPECT_GT(partial, 20);
}

TEST_F(FramebufferTest, ImpossibleSizesAreOneClearLine) {
  for (const auto& [width, samples] : {std::pair{0, 1}, std::pair{1 << 24, 1}, std::pair{16, 1000}}) {
    auto frame = Framebuffer::create(context_->abilities(), width, 16, samples);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, ErrorCode::kLimitExceeded);
    EXPECT_EQ(frame.error().message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace farfield::client
