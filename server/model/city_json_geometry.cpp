// SPDX-License-Identifier: Apache-2.0
#include "server/model/city_json_geometry.h"

#include <nlohmann/json.hpp>

#include "server/model/polygon.h"

namespace farfield {
namespace {

using Json = nlohmann::json;

const Json kNull;

const Json& member(const Json& json, const char* key) {
  if (!json.is_object()) return kNull;
  const auto found = json.find(key);
  return found == json.end() ? kNull : *found;
}

const Json& element(const Json& json, std::size_t index) {
  return json.is_array() && index < json.size() ? json[index] : kNull;
}

}  // namespace

int nesting_above_surfaces(const std::string& type) {
  if (type == "MultiSurface" || type == "CompositeSurface") return 0;
  if (type == "Solid") return 1;
  if (type == "MultiSolid" || type == "CompositeSolid") return 2;
  return -1;
}

void for_each_surface(const Json& boundaries, int depth, const Json& values,
                      const std::function<void(const Json&, const Json&)>& visit) {
  if (!boundaries.is_array()) return;
  for (std::size_t i = 0; i < boundaries.size(); ++i) {
    if (depth == 0) {
      visit(boundaries[i], element(values, i));
    } else {
      for_each_surface(boundaries[i], depth - 1, element(values, i), visit);
    }
  }
}

SemanticTypes::SemanticTypes(const Json& geometry)
    : surfaces_(&member(member(geometry, "semantics"), "surfaces")),
      values_(&member(member(geometry, "semantics"), "values")) {}

std::string SemanticTypes::type_of(const Json& value) const {
  if (!value.is_number_unsigned()) return {};
  const Json& type = member(element(*surfaces_, value.get<std::size_t>()), "type");
  return type.is_string() ? type.get<std::string>() : std::string();
}

bool SurfaceGatherer::add(const Json& surface, std::span<const glm::dvec3> vertices) {
  if (!surface.is_array()) return false;
  std::vector<glm::dvec3> points;
  std::vector<std::vector<std::uint32_t>> rings;
  for (const Json& ring : surface) {
    if (!ring.is_array()) return false;
    std::vector<std::uint32_t>& indices = rings.emplace_back();
    for (const Json& vertex : ring) {
      if (!vertex.is_number_unsigned() || vertex.get<std::size_t>() >= vertices.size()) return false;
      indices.push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back(vertices[vertex.get<std::size_t>()]);
    }
    // The standard forbids repeating the first vertex at the end; some writers do so all the same.
    if (ring.size() > 3 && ring.front() == ring.back()) indices.pop_back();
  }
  std::vector<std::uint32_t> triangles;
  triangulate_polygon_with_holes(points, rings, triangles);
  if (triangles.empty()) return false;
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), points.begin(), points.end());
  for (const std::uint32_t t : triangles) mesh.indices.push_back(base + t);
  return true;
}

}  // namespace farfield
