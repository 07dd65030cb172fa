// SPDX-License-Identifier: Apache-2.0
#include "server/model/obj_reader.h"

#include <cmath>
#include <limits>
#include <unordered_map>

#include "server/model/double_mesh.h"
#include "server/model/file_bytes.h"
#include "server/model/mtl_reader.h"
#include "server/model/polygon.h"
#include "server/model/text_lines.h"

namespace farfield {
namespace {

constexpr std::int64_t kAbsent = -1;

/// One corner of a face: places in the file's lists, kAbsent where not given.
struct Corner {
  std::int64_t position = kAbsent, uv = kAbsent, normal = kAbsent;
  bool operator==(const Corner&) const = default;
};

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::uint64_t h = static_cast<std::uint64_t>(c.position) * 0x9e3779b97f4a7c15ull;
    h = (h ^ static_cast<std::uint64_t>(c.uv)) * 0xbf58476d1ce4e5b9ull;
    h = (h ^ static_cast<std::uint64_t>(c.normal)) * 0x94d049bb133111ebull;
    return h ^ (h >> 29);
  }
};

class ObjReader {
 public:
  explicit ObjReader(const std::filesystem::path& path) : path_(path), textures_(model_, path.parent_path()) {
    model_.name = path.stem().string();
    model_.materials.push_back({.name = "default", .base_colour = {200, 200, 200, 255}});
  }

  Model read(std::string_view text) {
    std::string joined;
    std::string_view line;
    while (next_line(text, line)) {
      ++line_number_;
      if (const std::string_view t = trimmed(line); !t.empty() && t.back() == '\\') {
        joined.append(t.substr(0, t.size() - 1)).push_back(' ');
        continue;
      }
      if (joined.empty()) {
        statement(line);
      } else {
        statement(joined.append(line));
        joined.clear();
      }
    }
    finish();
    return std::move(model_);
  }

 private:
  void statement(std::string_view line) {
    if (const std::size_t comment = line.find('#'); comment != std::string_view::npos) line = line.substr(0, comment);
    const std::string_view key = next_word(line);
    if (key == "v") return vertex(line);
    if (key == "vt") return texture_coordinate(line);
    if (key == "vn") return normal(line);
    if (key == "f" || key == "fo") return face(line);
    if (key == "l" || key == "p") return void(++loose_);
    if (key == "usemtl") return use_material(std::string(trimmed(line)));
    if (key == "o" || key == "g") return begin_group(std::string(trimmed(line)));
    if (key == "mtllib") return material_library(std::string(trimmed(line)));
  }

  double number(std::string_view& line) {
    const std::optional<double> value = parse_number<double>(next_word(line));
    if (!value) ++bad_numbers_;
    return value.value_or(std::numeric_limits<double>::quiet_NaN());
  }

  void vertex(std::string_view line) {
    glm::dvec3 p(0);
    for (int a = 0; a < 3; ++a) p[a] = number(line);
    positions_.push_back(p);
    double rest[4];
    int count = 0;
    for (std::string_view word = next_word(line); !word.empty() && count < 4; word = next_word(line)) {
      rest[count++] = parse_number<double>(word).value_or(1.0);
    }
    if (count != 3 && !has_colours_) return;  // a fourth number alone is a weight
    has_colours_ = true;
    colours_.resize(positions_.size(), glm::u8vec4(255));
    if (count != 3) return;
    for (int c = 0; c < 3; ++c) {
      const double value = std::isfinite(rest[c]) ? std::clamp(rest[c], 0.0, 1.0) : 1.0;
      colours_.back()[c] = static_cast<std::uint8_t>(std::lround(255 * value));
    }
  }

  void texture_coordinate(std::string_view line) {
    const double u = number(line);
    const double v = parse_number<double>(next_word(line)).value_or(0.0);
    uvs_.emplace_back(static_cast<float>(u), static_cast<float>(1 - v));  // OBJ counts v from the last row
  }

  void normal(std::string_view line) {
    glm::vec3 n(0);
    for (int a = 0; a < 3; ++a) n[a] = static_cast<float>(number(line));
    normals_.push_back(n);
  }

  /// Resolves a 1-based or negative reference. Returns: kAbsent if it points nowhere.
  static std::int64_t resolve(std::int64_t reference, std::size_t count) {
    const std::int64_t index = reference < 0 ? static_cast<std::int64_t>(count) + reference : reference - 1;
    return reference != 0 && index >= 0 && index < static_cast<std::int64_t>(count) ? index : kAbsent;
  }

  /// "7", "7/3", "7//2" or "7/3/2".
  std::optional<Corner> corner(std::string_view word) const {
    std::optional<std::int64_t> parts[3];
    for (auto& part : parts) {
      const std::size_t slash = word.find('/');
      part = parse_number<std::int64_t>(word.substr(0, slash));
      if (slash == std::string_view::npos) break;
      word.remove_prefix(slash + 1);
    }
    if (!parts[0]) return std::nullopt;
    Corner c{.position = resolve(*parts[0], positions_.size())};
    if (c.position == kAbsent) return std::nullopt;
    if (parts[1]) c.uv = resolve(*parts[1], uvs_.size());
    if (parts[2]) c.normal = resolve(*parts[2], normals_.size());
    return c;
  }

  void face(std::string_view line) {
    corners_.clear();
    bool is_bad = false;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
      if (const std::optional<Corner> c = corner(word)) {
        corners_.push_back(*c);
      } else {
        is_bad = true;
      }
    }
    if (is_bad) {
      if (bad_faces_++ == 0) first_bad_line_ = line_number_;
      return;
    }
    if (corners_.size() < 3) return void(++loose_);
    points_.clear();
    for (const Corner& c : corners_) points_.push_back(positions_[static_cast<std::size_t>(c.position)]);
    triangles_.clear();
    triangulate_polygon(points_, triangles_);
    if (triangles_.empty()) ++flat_polygons_;
    for (const std::uint32_t t : triangles_) add_corner(corners_[t]);
  }

  void add_corner(const Corner& c) {
    DoubleMesh& mesh = current_mesh();
    const auto [place, is_new] = vertex_of_corner_.try_emplace(c, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) {
      mesh.positions.push_back(positions_[static_cast<std::size_t>(c.position)]);
      has_all_normals_ = has_all_normals_ && c.normal != kAbsent;
      has_any_uv_ = has_any_uv_ || c.uv != kAbsent;
      mesh.normals.push_back(c.normal == kAbsent ? glm::vec3(0) : normals_[static_cast<std::size_t>(c.normal)]);
      mesh.uvs.push_back(c.uv == kAbsent ? glm::vec2(0) : uvs_[static_cast<std::size_t>(c.uv)]);
      if (has_colours_) {
        colours_.resize(positions_.size(), glm::u8vec4(255));
        mesh.colours.resize(mesh.positions.size(), glm::u8vec4(255));
        mesh.colours.back() = colours_[static_cast<std::size_t>(c.position)];
      }
    }
    mesh.indices.push_back(place->second);
  }

  DoubleMesh& current_mesh() {
    if (!is_mesh_open_) {
      meshes_.push_back({.name = group_, .material = material_});
      is_mesh_open_ = has_all_normals_ = true;
      has_any_uv_ = false;
      vertex_of_corner_ = {};  // clear() costs as much as the largest mesh so far
    }
    return meshes_.back();
  }

  void close_mesh() {
    if (!is_mesh_open_) return;
    is_mesh_open_ = false;
    DoubleMesh& mesh = meshes_.back();
    if (!has_all_normals_) mesh.normals.clear();
    if (!has_any_uv_) mesh.uvs.clear();
    if (!mesh.colours.empty()) mesh.colours.resize(mesh.positions.size(), glm::u8vec4(255));
  }

  void begin_group(std::string name) {
    if (name == group_) return;
    close_mesh();
    group_ = std::move(name);
  }

  void use_material(const std::string& name) {
    auto found = material_by_name_.find(name);
    if (found == material_by_name_.end()) {
      model_.warnings.push_back(fmt::format("material '{}' is not in any material library; drawn grey", name));
      found = material_by_name_.emplace(name, 0).first;
    }
    if (found->second == material_) return;
    close_mesh();
    material_ = found->second;
  }

  void material_library(const std::string& name) {
    const std::filesystem::path library = path_.parent_path() / name;
    model_.sources.push_back(library.string());
    const Result<Bytes> bytes = read_file_bytes(library);
    if (!bytes) {
      model_.warnings.push_back(fmt::format("material library {}: not readable beside the model", name));
      return;
    }
    read_mtl(to_text(*bytes), model_, textures_, material_by_name_);
  }

  void finish() {
    close_mesh();
    const auto warn = [&](std::size_t count, const std::string& what) {
      if (count > 0) model_.warnings.push_back(fmt::format("{}: {}", what, count));
    };
    warn(loose_, "dropped lines, points and faces with fewer than three corners");
    warn(bad_faces_, fmt::format("dropped faces that name missing vertices (the first in line {})", first_bad_line_));
    warn(flat_polygons_, "dropped polygons without area");
    warn(bad_numbers_, "coordinates that are not numbers");
    store_double_meshes(std::move(meshes_), model_);
  }

  std::filesystem::path path_;
  Model model_;
  TextureCache textures_;
  std::map<std::string, int> material_by_name_;

  // ── the file's lists ──
  std::vector<glm::dvec3> positions_;
  std::vector<glm::u8vec4> colours_;
  std::vector<glm::vec2> uvs_;
  std::vector<glm::vec3> normals_;
  bool has_colours_ = false;

  // ── the mesh being filled ──
  std::vector<DoubleMesh> meshes_;
  bool is_mesh_open_ = false, has_all_normals_ = true, has_any_uv_ = false;
  std::unordered_map<Corner, std::uint32_t, CornerHash> vertex_of_corner_;
  std::string group_;
  int material_ = 0;

  // ── one face ──
  std::vector<Corner> corners_;
  std::vector<glm::dvec3> points_;
  std::vector<std::uint32_t> triangles_;

  std::size_t line_number_ = 0, first_bad_line_ = 0;
  std::size_t loose_ = 0, bad_faces_ = 0, flat_polygons_ = 0, bad_numbers_ = 0;
};

}  // namespace

Result<Model> read_obj(const std::filesystem::path& path) {
  const Result<Bytes> bytes = read_file_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return ObjReader(path).read(to_text(*bytes));
}

}  // namespace farfield
