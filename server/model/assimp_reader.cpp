// SPDX-License-Identifier: Apache-2.0
#include "server/model/assimp_reader.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <vector>

#include "common/shading/shading.h"
#include "server/model/assimp_materials.h"
#include "server/model/clean_model.h"

namespace farfield {
namespace {

glm::dmat4 to_double(const aiMatrix4x4& m) {  // Assimp stores rows, glm columns
  return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(255 * (std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 1.0f)));
}

glm::u8vec4 to_colour(const aiColor4D& c, bool is_linear) {
  if (is_linear) return {linear_to_srgb(c.r), linear_to_srgb(c.g), linear_to_srgb(c.b), to_byte(c.a)};
  return {to_byte(c.r), to_byte(c.g), to_byte(c.b), to_byte(c.a)};
}

class SceneConverter {
 public:
  SceneConverter(const aiScene& scene, bool is_gltf, UvChannels uv_channels, Model& model)
      : scene_(scene), is_gltf_(is_gltf), uv_channels_(std::move(uv_channels)), model_(model) {}

  void convert() {
    model_.meshes.reserve(scene_.mNumMeshes);
    for (unsigned m = 0; m < scene_.mNumMeshes; ++m) model_.meshes.push_back(convert_mesh(*scene_.mMeshes[m]));
    if (scene_.mRootNode) place_nodes();
    if (loose_ > 0) model_.warnings.push_back(fmt::format("dropped lines and points: {}", loose_));
  }

 private:
  Mesh convert_mesh(const aiMesh& source) {
    Mesh mesh;
    mesh.name = source.mName.C_Str();
    mesh.material = static_cast<int>(std::min<std::size_t>(source.mMaterialIndex, model_.materials.size() - 1));
    const std::size_t count = source.mNumVertices;
    if (source.mVertices) {
      const auto* positions = reinterpret_cast<const glm::vec3*>(source.mVertices);
      mesh.positions.assign(positions, positions + count);
    }
    if (source.mNormals) {
      const auto* normals = reinterpret_cast<const glm::vec3*>(source.mNormals);
      mesh.normals.assign(normals, normals + count);
    }
    unsigned channel = uv_channels_[static_cast<std::size_t>(mesh.material)];
    if (channel >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !source.mTextureCoords[channel]) channel = 0;
    if (const aiVector3D* uvs = source.mTextureCoords[channel]) {
      mesh.uvs.reserve(count);
      for (std::size_t i = 0; i < count; ++i) mesh.uvs.emplace_back(uvs[i].x, 1 - uvs[i].y);  // Assimp's v points up
    }
    if (const aiColor4D* colours = source.mColors[0]) {
      mesh.colours.reserve(count);
      for (std::size_t i = 0; i < count; ++i) mesh.colours.push_back(to_colour(colours[i], is_gltf_));
    }
    mesh.indices.reserve(std::size_t{3} * source.mNumFaces);
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
      const aiFace& face = source.mFaces[f];
      if (face.mNumIndices == 3) {
        mesh.indices.insert(mesh.indices.end(), face.mIndices, face.mIndices + 3);
      } else {
        ++loose_;
      }
    }
    // Formats that repeat every vertex per face come with about three vertices per triangle.
    if (2 * mesh.positions.size() > mesh.indices.size()) weld_vertices(mesh);
    return mesh;
  }

  void place_nodes() {
    struct Pending {
      const aiNode* node;
      glm::dmat4 world_from_parent;
    };
    std::vector<Pending> pending{{scene_.mRootNode, glm::dmat4(1)}};
    while (!pending.empty()) {
      const auto [node, world_from_parent] = pending.back();
      pending.pop_back();
      const glm::dmat4 world_from_node = world_from_parent * to_double(node->mTransformation);
      for (unsigned m = 0; m < node->mNumMeshes; ++m) {
        if (node->mMeshes[m] >= model_.meshes.size()) continue;
        model_.instances.push_back({static_cast<int>(node->mMeshes[m]), world_from_node});
      }
      // Reversed, so that instances keep the file's order.
      for (unsigned c = node->mNumChildren; c-- > 0;) pending.push_back({node->mChildren[c], world_from_node});
    }
  }

  const aiScene& scene_;
  bool is_gltf_;
  UvChannels uv_channels_;
  Model& model_;
  std::size_t loose_ = 0;
};

/// The files that Assimp itself opens or looks for: buffers of glTF, libraries of materials.
class NotedFiles final : public Assimp::DefaultIOSystem {
 public:
  explicit NotedFiles(std::vector<std::string>& names) : names_(names) {}
  bool Exists(const char* file) const override {
    names_.emplace_back(file);
    return DefaultIOSystem::Exists(file);
  }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    names_.emplace_back(file);
    return DefaultIOSystem::Open(file, mode);
  }

 private:
  std::vector<std::string>& names_;
};

static_assert(sizeof(aiVector3D) == sizeof(glm::vec3), "Assimp is expected to be built with single precision");

}  // namespace

Result<Model> read_with_assimp(const std::filesystem::path& path, ModelFormat format) {
  Model model;
  Assimp::Importer importer;
  importer.SetIOHandler(new NotedFiles(model.sources));  // which the importer deletes
  const bool is_gltf = format == ModelFormat::kGlb || format == ModelFormat::kGltf;
  const unsigned steps = aiProcess_Triangulate | aiProcess_TransformUVCoords;
  const aiScene* scene = importer.ReadFile(path.string(), steps);
  if (!scene) {
    std::string reason = importer.GetErrorString();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    if (reason.find("bad_alloc") != reason.npos) {
      return fail(ErrorCode::kLimitExceeded, "it needs more memory than the import process may use");
    }
    return fail(ErrorCode::kBadData, "the {} importer says: {}", model_format_name(format), reason);
  }
  model.name = path.stem().string();
  UvChannels uv_channels = add_assimp_materials(*scene, is_gltf, path.parent_path(), model);
  SceneConverter(*scene, is_gltf, std::move(uv_channels), model).convert();
  return model;
}

}  // namespace farfield
