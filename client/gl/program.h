// SPDX-License-Identifier: Apache-2.0
// A linked shader program. Shader sources are string literals beside the renderer that uses them.
#pragma once

#include <string_view>

#include "client/gl/gl_handle.h"
#include "common/base/result.h"

namespace farfield::client {

class Program {
 public:
  Program() = default;
  /// Compiles and links two "#version 300 es" sources; `name` appears in errors.
  /// Errors: kInternal with the compiler's first complaint.
  static Result<Program> build(std::string_view name, std::string_view vertex, std::string_view fragment);

  void use() const;
  /// Returns: -1 for a uniform the linker removed; setting that is allowed and does nothing.
  int uniform(const char* name) const;
  GlName name() const { return name_.name(); }

 private:
  explicit Program(ProgramName name) : name_(std::move(name)) {}
  ProgramName name_;
};

}  // namespace farfield::client
