// SPDX-License-Identifier: Apache-2.0
// The geometry nouns of CityJSON: nested boundary lists, semantics beside them, and surfaces made of rings.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "server/model/double_mesh.h"

namespace farfield {

/// Arrays between a geometry's boundaries and its surfaces: 0 for MultiSurface, 1 for Solid (shells), 2 for MultiSolid;
/// -1 for kinds without surfaces.
int nesting_above_surfaces(const std::string& geometry_type);

/// Calls `visit(surface, semantic value)` for every surface below `depth` arrays; the value is null where the
/// semantics are missing or shorter than the boundaries. Shapes that do not match are skipped.
void for_each_surface(const nlohmann::json& boundaries, int depth, const nlohmann::json& values,
                      const std::function<void(const nlohmann::json&, const nlohmann::json&)>& visit);

/// The "semantics" member of a geometry. Refers to it: the geometry must outlive this.
class SemanticTypes {
 public:
  explicit SemanticTypes(const nlohmann::json& geometry);
  const nlohmann::json& values() const { return *values_; }
  /// The type an entry of values() stands for; empty for null and for anything out of range.
  std::string type_of(const nlohmann::json& value) const;

 private:
  const nlohmann::json* surfaces_;
  const nlohmann::json* values_;
};

/// Collects surfaces of one colour into one mesh.
struct SurfaceGatherer {
  DoubleMesh mesh;

  /// Adds a surface: a list of rings of vertex numbers, the first ring outside. Returns: false if it was dropped.
  bool add(const nlohmann::json& surface, std::span<const glm::dvec3> vertices);
};

}  // namespace farfield
