// SPDX-License-Identifier: Apache-2.0
#include "client/gl/gl_context.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

#include "client/gl/program.h"

namespace farfield::client {
namespace {

TEST(GlContext, SurfacelessNeedsNoDisplayServer) {
  auto context = GlContext::create_surfaceless();
  ASSERT_TRUE(context) << context.error().message;
  EXPECT_FALSE((*context)->abilities().renderer.empty());
  EXPECT_GE((*context)->abilities().max_texture_layers, 256);  // what OpenGL ES 3.0 guarantees
}

TEST(GlContext, MovesToAnotherThread) {
  auto context = GlContext::create_surfaceless();
  ASSERT_TRUE(context) << context.error().message;
  (*context)->release_current();
  std::thread([&] {
    const Status moved = (*context)->make_current();
    EXPECT_TRUE(moved) << moved.error().message;
    EXPECT_NE(glGetString(GL_VERSION), nullptr);
    (*context)->release_current();
  }).join();
  EXPECT_TRUE((*context)->make_current());
}

TEST(GlContext, AdoptingWithoutAContextIsOneClearLine) {
  auto context = GlContext::adopt_current();
  ASSERT_FALSE(context);
  EXPECT_EQ(context.error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(context.error().message.find('\n'), std::string::npos);
}

TEST(GlContext, AdoptsWhatIsCurrent) {
  auto owner = GlContext::create_surfaceless();
  ASSERT_TRUE(owner) << owner.error().message;
  auto adopted = GlContext::adopt_current();
  ASSERT_TRUE(adopted) << adopted.error().message;
  EXPECT_EQ((*adopted)->abilities().version, (*owner)->abilities().version);
}

TEST(Program, NamesTheShaderAndTheFirstErrorInOneLine) {
  auto context = GlContext::create_surfaceless();
  ASSERT_TRUE(context) << context.error().message;
  const char* vertex = "#version 300 es\nvoid main() { gl_Position = vec4(0.0); }\n";
  auto program = Program::build("broken", vertex, "#version 300 es\nvoid main() { no_such_name = 1; }\n");
  ASSERT_FALSE(program);
  EXPECT_NE(program.error().message.find("broken fragment shader"), std::string::npos);
  EXPECT_NE(program.error().message.find("no_such_name"), std::string::npos);
  EXPECT_EQ(program.error().message.find('\n'), std::string::npos);
}

TEST(Program, UnmatchedInterfacesAreALinkError) {
  auto context = GlContext::create_surfaceless();
  ASSERT_TRUE(context) << context.error().message;
  const char* vertex = "#version 300 es\nout vec2 a;\nvoid main() { a = vec2(0.0); gl_Position = vec4(0.0); }\n";
  const char* fragment = "#version 300 es\nprecision highp float;\nin vec4 a;\nout vec4 c;\nvoid main() { c = a; }\n";
  auto program = Program::build("mismatched", vertex, fragment);
  ASSERT_FALSE(program);
  EXPECT_NE(program.error().message.find("mismatched shaders do not link"), std::string::npos);
}

}  // namespace
}  // namespace farfield::client
