// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/methods.h"

#include "tests/bench/baselines/geometry.h"
#include "tests/bench/baselines/rays.h"
#include "tests/bench/farfield_method.h"

namespace farfield::bench {

std::vector<Method> all_methods(const BenchOptions& options) {
  return {rays_method(), geometry_method(), geometry_culled_method(), farfield_method("cpu", options), farfield_method("gl", options)};
}

}  // namespace farfield::bench
