// SPDX-License-Identifier: Apache-2.0
// What a fuzz target asserts beyond "it does not crash": ends the process with one line when a promise is broken.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace farfield::fuzz {

/// In every build type, unlike assert().
inline void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

}  // namespace farfield::fuzz
