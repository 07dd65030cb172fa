// SPDX-License-Identifier: Apache-2.0
#include "tests/stability/stress.h"

namespace farfield::stability {

const std::vector<Stress>& all_stresses() {
  static const std::vector<Stress> stresses{
      {"shift", "scenes moved by 10^3 to 10^8 m", stress_shift},
      {"scale", "scenes from 10^-3 to 10^5 of their size", stress_scale},
      {"distances", "near and far at a ratio of 10^8, grazing rays", stress_distances},
      {"broken", "degenerate, duplicate and coplanar triangles", stress_broken_models},
      {"leaks", "rays through edges and vertices of closed meshes", stress_leaks},
      {"borders", "eyes on the borders of cells and on surfaces", stress_borders},
      {"projections", "fields of view of 1 to 170 degrees, pitch of 90 degrees, disparity 0, denormals", stress_projections},
      {"codec", "disparity of any size at any tolerance", stress_codec},
      {"float-modes", "what threads do with denormals and NaN", stress_float_modes},
      {"opengl", "OpenGL's depths, and its driver's habits", stress_opengl},
      {"threads", "one thread and two", stress_threads},
      {"kernels", "scalar and vector code", stress_kernels},
  };
  return stresses;
}

}  // namespace farfield::stability
