// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/methods.h"

#include "tests/bench/baselines/geometry.h"
#include "tests/bench/baselines/geometry_lod.h"
#include "tests/bench/baselines/impostor_methods.h"
#include "tests/bench/baselines/rays.h"
#include "tests/bench/baselines/video.h"
#include "tests/bench/farfield_method.h"

namespace farfield::bench {

std::vector<Method> all_methods(const BenchOptions& options) {
  std::vector<Method> methods{rays_method(), geometry_method(), geometry_culled_method(), geometry_lod_method()};
  for (Method& method : impostor_methods(options)) methods.push_back(std::move(method));
#ifdef FARFIELD_HAS_VIDEO
  methods.push_back(video_method());
#endif
  methods.push_back(farfield_method("cpu", options));
  methods.push_back(farfield_method("gl", options));
  return methods;
}

}  // namespace farfield::bench
