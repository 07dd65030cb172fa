// SPDX-License-Identifier: Apache-2.0
// Names of the nodes of the cell octree, and where they lie.
//
// Scene frame: metres relative to the scene's origin, double. Level 0 is the finest; a level-L cell has side
// finest_side·2^L. Indices count from a fixed corner far below the origin, kGridOffset finest cells away on each axis.
// kGridOffset = 0b0101…01 makes ancestors of the origin's cell grow alternately towards both sides, so that some
// ancestor holds any given viewer: a grid whose corner were at the origin could never grow across it.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>

#include "common/math/box.h"

namespace farfield {

inline constexpr std::int64_t kGridOffset = 0x15555555;
inline constexpr int kMaxCellLevel = 28;

struct CellId {
  std::uint8_t level = 0;
  std::int32_t x = 0, y = 0, z = 0;

  auto operator<=>(const CellId&) const = default;
  CellId parent() const { return {static_cast<std::uint8_t>(level + 1), x >> 1, y >> 1, z >> 1}; }
  /// The ancestor at `ancestor_level`. Requires: ancestor_level >= level.
  CellId ancestor(int ancestor_level) const {
    const int up = ancestor_level - level;
    return {static_cast<std::uint8_t>(ancestor_level), x >> up, y >> up, z >> up};
  }
  bool is_within(const CellId& other) const { return level <= other.level && ancestor(other.level) == other; }
};

/// The grid: everything that turns a CellId into a box. `finest_side_m` is the side of a level-0 cell.
struct CellGrid {
  double finest_side_m = 0.5;

  double side_m(int level) const { return std::ldexp(finest_side_m, level); }
  /// Exact for the power-of-two sides in use: adjacent cells share bit-identical borders.
  Box box(const CellId& id) const {
    const auto corner = [&](std::int64_t index) {
      return static_cast<double>((index << id.level) - kGridOffset) * finest_side_m;
    };
    return {{corner(id.x), corner(id.y), corner(id.z)},
            {corner(std::int64_t{id.x} + 1), corner(std::int64_t{id.y} + 1), corner(std::int64_t{id.z} + 1)}};
  }
  /// The cell of `level` that holds `point` (half-open boxes). Points beyond the grid are clamped to its last cell.
  CellId cell_at(const glm::dvec3& point, int level) const;
  /// The smallest cell, at `level` or above, that holds the whole box.
  CellId enclosing(const Box& box, int level = 0) const;
};

}  // namespace farfield

template <>
struct std::hash<farfield::CellId> {
  std::size_t operator()(const farfield::CellId& c) const {
    std::uint64_t h = c.level;
    for (const std::int32_t v : {c.x, c.y, c.z}) h = (h ^ static_cast<std::uint32_t>(v)) * 0x9e3779b97f4a7c15ull;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
};
