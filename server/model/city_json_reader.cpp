// SPDX-License-Identifier: Apache-2.0
#include "server/model/city_json_reader.h"

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "server/model/city_json_colours.h"
#include "server/model/city_json_geometry.h"
#include "server/model/double_mesh.h"
#include "server/model/file_bytes.h"
#include "server/model/text_lines.h"

namespace farfield {
namespace {

using Json = nlohmann::json;

struct Transform {
  glm::dvec3 scale{1}, translate{0};
};

/// Three finite numbers under `key`, or nothing.
std::optional<glm::dvec3> read_vector(const Json& json) {
  if (!json.is_array() || json.size() < 3) return std::nullopt;
  glm::dvec3 v;
  for (int a = 0; a < 3; ++a) {
    if (!json[static_cast<std::size_t>(a)].is_number()) return std::nullopt;
    v[a] = json[static_cast<std::size_t>(a)].get<double>();
  }
  return v;
}

std::string text_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// A level of detail is a number in 1.0 and text ("2.2") since 1.1.
double detail_of(const Json& geometry) {
  const auto found = geometry.find("lod");
  if (found == geometry.end()) return 0;
  if (found->is_number()) return found->get<double>();
  return found->is_string() ? std::strtod(found->get_ref<const std::string&>().c_str(), nullptr) : 0;
}

class CityJsonReader {
 public:
  /// One CityJSON object or one feature of a sequence. Returns: an error line, empty if all is well.
  std::string read_root(const Json& root) {
    if (!root.is_object()) return "is not a JSON object";
    const std::string type = text_of(root, "type");
    if (type != "CityJSON" && type != "CityJSONFeature") return "is JSON but not CityJSON (its type is '" + type + "')";
    if (const auto t = root.find("transform"); t != root.end() && t->is_object()) {
      const auto scale = read_vector(t->value("scale", Json()));
      const auto translate = read_vector(t->value("translate", Json()));
      if (!scale || !translate) return "has a transform without three scales and translations";
      transform_ = {*scale, *translate};
    }
    vertices_.clear();
    if (const auto vertices = root.find("vertices"); vertices != root.end() && vertices->is_array()) {
      vertices_.reserve(vertices->size());
      for (const Json& vertex : *vertices) {
        const auto v = read_vector(vertex);
        vertices_.push_back(v ? *v * transform_.scale + transform_.translate
                              : glm::dvec3(std::numeric_limits<double>::quiet_NaN()));
      }
    }
    const auto objects = root.find("CityObjects");
    if (objects == root.end() || !objects->is_object()) return "has no CityObjects";
    for (const auto& object : *objects) read_object(object, *objects);
    return {};
  }

  Model finish(const std::string& name) {
    Model model;
    model.name = name;
    std::vector<DoubleMesh> meshes;
    for (auto& [type, gatherer] : surfaces_) {
      const std::string label = type.second.empty() ? type.first : type.first + " " + type.second;
      gatherer.mesh.name = label;
      gatherer.mesh.material = static_cast<int>(model.materials.size());
      model.materials.push_back({.name = label, .base_colour = city_colour(type.first, type.second)});
      meshes.push_back(std::move(gatherer.mesh));
    }
    const auto warn = [&](std::size_t count, const char* what) {
      if (count > 0) model.warnings.push_back(fmt::format("{}: {}", what, count));
    };
    warn(lost_surfaces_, "dropped surfaces without area or that name missing vertices");
    warn(unread_geometries_, "dropped geometries of kinds that are not read (templates, points, lines)");
    warn(textured_geometries_, "textured geometries, drawn in the colour of their type");
    store_double_meshes(std::move(meshes), model);
    return model;
  }

 private:
  static const Json* finest_geometry(const Json& object) {
    const auto geometries = object.find("geometry");
    if (geometries == object.end() || !geometries->is_array()) return nullptr;
    const Json* finest = nullptr;
    for (const Json& geometry : *geometries) {
      if (geometry.is_object() && (!finest || detail_of(geometry) > detail_of(*finest))) finest = &geometry;
    }
    return finest;
  }

  static bool has_finer_parts(const Json& object, double detail, const Json& objects) {
    const auto children = object.find("children");
    if (children == object.end() || !children->is_array()) return false;
    for (const Json& child : *children) {
      if (!child.is_string()) continue;
      const auto found = objects.find(child.get_ref<const std::string&>());
      if (found == objects.end() || !found->is_object()) continue;
      if (const Json* geometry = finest_geometry(*found); geometry && detail_of(*geometry) > detail) return true;
    }
    return false;
  }

  void read_object(const Json& object, const Json& objects) {
    if (!object.is_object()) return;
    const Json* geometry = finest_geometry(object);
    if (!geometry || has_finer_parts(object, detail_of(*geometry), objects)) return;
    const std::string object_type = text_of(object, "type");
    const auto boundaries = geometry->find("boundaries");
    const int depth = nesting_above_surfaces(text_of(*geometry, "type"));
    if (depth < 0 || boundaries == geometry->end()) return void(++unread_geometries_);
    if (geometry->contains("texture")) ++textured_geometries_;
    const SemanticTypes semantics(*geometry);
    for_each_surface(*boundaries, depth, semantics.values(), [&](const Json& surface, const Json& semantic) {
      SurfaceGatherer& gatherer = surfaces_[{object_type, semantics.type_of(semantic)}];
      if (!gatherer.add(surface, vertices_)) ++lost_surfaces_;
    });
  }

  Transform transform_;
  std::vector<glm::dvec3> vertices_;
  std::map<std::pair<std::string, std::string>, SurfaceGatherer> surfaces_;  // by object type, surface type
  std::size_t lost_surfaces_ = 0, unread_geometries_ = 0, textured_geometries_ = 0;
};

}  // namespace

Result<Model> read_city_json(const std::filesystem::path& path) {
  const Result<Bytes> bytes = read_file_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  CityJsonReader reader;
  const std::string whole = to_text(*bytes);

  // A sequence is one JSON text per line; a plain file is one JSON text, on however many lines.
  const Json single = Json::parse(whole, nullptr, false);
  if (!single.is_discarded()) {
    if (const std::string error = reader.read_root(single); !error.empty()) {
      return fail(ErrorCode::kBadData, "{}: {}; export it as CityJSON again", path.string(), error);
    }
    return reader.finish(path.stem().string());
  }
  std::string_view rest = whole, line;
  for (std::size_t number = 1; next_line(rest, line); ++number) {
    if (trimmed(line).empty()) continue;
    const Json root = Json::parse(line, nullptr, false);
    const std::string error = root.is_discarded() ? "is damaged JSON" : reader.read_root(root);
    if (!error.empty()) {
      return fail(ErrorCode::kBadData, "{}: line {} {}; export it as CityJSON again", path.string(), number, error);
    }
  }
  return reader.finish(path.stem().string());
}

}  // namespace farfield
