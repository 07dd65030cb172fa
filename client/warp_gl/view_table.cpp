// SPDX-License-Identifier: Apache-2.0
#include "client/warp_gl/view_table.h"

#include <epoxy/gl.h>

#include "common/math/cube_face.h"

namespace farfield::client {

ViewProjection ViewProjection::of(const ViewTransform& eye, const glm::dvec3& view_position, double side_m, int face) {
  const CubeFace cube_face = CubeFace::of(face);
  const glm::dmat3& r = eye.camera_from_scene;
  ViewProjection result;
  result.face = {r[cube_face.u_axis()], r[cube_face.v_axis()], cube_face.sign * r[cube_face.axis]};
  result.shift = r * ((view_position - eye.eye) / side_m);
  return result;
}

ViewTable::ViewTable() : texture_(TextureName::make()) {
  glBindTexture(GL_TEXTURE_2D, texture_.name());
  glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA32F, 3, kCapacity);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

std::optional<std::uint16_t> ViewTable::acquire(const glm::dvec3& view_position, double side_m, int face) {
  const Key key{view_position.x, view_position.y, view_position.z, side_m, face};
  if (const auto found = row_of_.find(key); found != row_of_.end()) {
    ++rows_[found->second].users;
    return found->second;
  }
  std::uint16_t row = 0;
  if (!free_.empty()) {
    row = free_.back();
    free_.pop_back();
  } else if (rows_.size() < kCapacity) {
    row = static_cast<std::uint16_t>(rows_.size());
    rows_.emplace_back();
  } else {
    return std::nullopt;
  }
  rows_[row] = {key, 1, {}};
  row_of_.emplace(key, row);
  return row;
}

void ViewTable::release(std::uint16_t row) {
  if (--rows_[row].users > 0) return;
  row_of_.erase(rows_[row].key);
  free_.push_back(row);
}

void ViewTable::update(const ViewTransform& eye) {
  upload_.resize(3 * rows_.size());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[i];
    if (row.users == 0) continue;
    const auto& [x, y, z, side_m, face] = row.key;
    row.projection = ViewProjection::of(eye, {x, y, z}, side_m, face);
    for (int c = 0; c < 3; ++c) {
      upload_[3 * i + static_cast<std::size_t>(c)] = {glm::vec3(row.projection.face[c]),
                                                      static_cast<float>(row.projection.shift[c])};
    }
  }
  if (rows_.empty()) return;
  glBindTexture(GL_TEXTURE_2D, texture_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 3, static_cast<GLsizei>(rows_.size()), GL_RGBA, GL_FLOAT, upload_.data());
}

}  // namespace farfield::client
