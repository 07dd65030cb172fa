// SPDX-License-Identifier: Apache-2.0
// The six faces of a cube map, and the grid of samples on one.
//
// Face f = 2·axis + (negative ? 1 : 0). Its tangent coordinates (u, v) name the direction
//     direction(u, v) = sign·e_axis + u·e_(axis+1) + v·e_(axis+2)      (indices modulo 3),
// so that eye-z along the face's axis is 1 and disparity d = 1/z, z = the distance along that axis.
//
// An N-sample edge puts sample i at u_i = -1 - h/2 + i·h with h = 2/(N - 2): the grid reaches half a sample past the
// cube's edge on either side, so meshes over the samples of adjacent faces overlap instead of leaving a crack.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace farfield {

inline constexpr int kCubeFaces = 6;

struct CubeFace {
  int axis = 0;
  double sign = 1;

  static CubeFace of(int face) { return {face >> 1, (face & 1) ? -1.0 : 1.0}; }
  int u_axis() const { return (axis + 1) % 3; }
  int v_axis() const { return (axis + 2) % 3; }
  template <class T>
  glm::vec<3, T> direction(T u, T v) const {
    glm::vec<3, T> d;
    d[axis] = static_cast<T>(sign);
    d[u_axis()] = u;
    d[v_axis()] = v;
    return d;
  }
};

/// The face whose axis dominates `direction`. Requires: not zero.
inline int dominant_face(const glm::dvec3& direction) {
  const glm::dvec3 a = glm::abs(direction);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
  return 2 * axis + (direction[axis] < 0 ? 1 : 0);
}

/// Sample spacing in tangent units on a face with `edge_samples` samples along an edge.
inline double sample_pitch(int edge_samples) { return 2.0 / (edge_samples - 2); }
inline double sample_tangent(int edge_samples, double index) {
  return -1.0 + (index - 0.5) * sample_pitch(edge_samples);
}
/// Inverse of sample_tangent: the (fractional) sample index at tangent coordinate u.
inline double sample_index(int edge_samples, double u) { return (u + 1.0) / sample_pitch(edge_samples) + 0.5; }

}  // namespace farfield
