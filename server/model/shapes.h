// SPDX-License-Identifier: Apache-2.0
// Building blocks of generated scenes: boxes, round shapes, pipes. Outward normals, counter-clockwise from outside.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "server/model/model_builder.h"

namespace farfield {

/// A place to build at: module metres from local metres, rigid.
struct Frame {
  glm::vec3 origin{0};
  glm::mat3 axes{1};  // columns: local x, y, z in module axes

  static Frame at(const glm::vec3& origin, float yaw_rad = 0);
  /// The frame whose y axis is the given direction (unit length).
  static Frame along(const glm::vec3& origin, const glm::vec3& y_axis);
  Frame moved(const glm::vec3& local_offset, float yaw_rad = 0) const;
  glm::vec3 point(const glm::vec3& local) const { return origin + axes * local; }
};

enum BoxFaces : unsigned {
  kFaceRight = 1, kFaceLeft = 2, kFaceTop = 4, kFaceBottom = 8, kFaceFront = 16, kFaceBack = 32,  // +x -x +y -y +z -z
  kAllFaces = 63,
  kNoEnds = kAllFaces & ~(kFaceTop | kFaceBottom),
};

/// A flat quadrilateral, corners counter-clockwise; texture coordinates from metres along its first and last edge.
void add_quad(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& a, const glm::vec3& b,
              const glm::vec3& c, const glm::vec3& d);
/// The same with given texture coordinates at a and c; b and d follow.
void add_quad(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& a, const glm::vec3& b,
              const glm::vec3& c, const glm::vec3& d, const glm::vec2& uv_a, const glm::vec2& uv_c);
void add_triangle(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& a,
                  const glm::vec3& b, const glm::vec3& c);

/// 2 triangles for each of `faces`.
void add_box(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& low,
             const glm::vec3& high, unsigned faces = kAllFaces);
/// 44 triangles: edges and corners cut off by `chamfer_m` and shaded round.
void add_chamfered_box(ModelBuilder& builder, const Paint& paint, const Frame& frame, const glm::vec3& low,
                       const glm::vec3& high, float chamfer_m);

/// Turns a profile of (radius, height) points, bottom to top, about the frame's y axis. Smooth where the profile
/// bends by less than 40 degrees, creased elsewhere. A radius of zero closes the shape.
void add_lathe(ModelBuilder& builder, const Paint& paint, const Frame& frame, std::span<const glm::vec2> profile,
               int sides);
/// An open tube, 2·sides triangles.
void add_tube(ModelBuilder& builder, const Paint& paint, const glm::vec3& from, const glm::vec3& to, float radius_m,
              int sides, float end_radius_m = -1);
/// A quarter (or any other) turn of a pipe from direction `incoming` to `outgoing` about the corner they would meet in.
void add_bend(ModelBuilder& builder, const Paint& paint, const glm::vec3& corner, const glm::vec3& incoming,
              const glm::vec3& outgoing, float bend_radius_m, float radius_m, int sides, int segments);
/// A ring of round section about the frame's y axis.
void add_torus(ModelBuilder& builder, const Paint& paint, const Frame& frame, float ring_radius_m, float radius_m,
               int segments, int sides);

}  // namespace farfield
