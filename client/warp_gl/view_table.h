// SPDX-License-Identifier: Apache-2.0
// Where each view's face goes on the screen this frame: one row of a small float texture per (view position, cell
// side, face), read by the vertex shader, so that tiles of many views share a draw call.
//
// A sample at (u, v) of a face with disparity d = side/z of a view at p lies at p + (side/d)·direction(u, v). From an
// eye at e, in camera axes and times d/side, which no projection notices:
//     q = R·direction(u, v) + d·R·(p - e)/side
// It is affine in (u, v, d), finite at infinity (d = 0), and every term is of order 1 whatever the scene's size.
// Row: three columns of the 3×3 matrix that takes (u, v, 1) to R·direction, then R·(p - e)/side in the w components.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "client/gl/gl_handle.h"
#include "client/gl/view_transform.h"

namespace farfield::client {

/// q = face·(u, v, 1) + disparity·shift.
struct ViewProjection {
  glm::dmat3 face{1};
  glm::dvec3 shift{0};

  static ViewProjection of(const ViewTransform& eye, const glm::dvec3& view_position, double side_m, int face);
};

class ViewTable {
 public:
  static constexpr int kCapacity = 2048;

  ViewTable();
  /// Returns: the row of a view's face, shared by all tiles that name the same; nothing if all rows are taken.
  std::optional<std::uint16_t> acquire(const glm::dvec3& view_position, double side_m, int face);
  void release(std::uint16_t row);

  /// Projects all rows in use and uploads them.
  void update(const ViewTransform& eye);
  /// Of the last update. Requires: `row` is in use.
  const ViewProjection& projection(std::uint16_t row) const { return rows_[row].projection; }
  GlName texture() const { return texture_.name(); }

 private:
  using Key = std::tuple<double, double, double, double, int>;
  struct Row {
    Key key{};
    int users = 0;
    ViewProjection projection;
  };
  std::vector<Row> rows_;
  std::vector<std::uint16_t> free_;
  std::map<Key, std::uint16_t> row_of_;
  std::vector<glm::vec4> upload_;
  TextureName texture_;
};

}  // namespace farfield::client
