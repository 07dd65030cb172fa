// SPDX-License-Identifier: Apache-2.0
#include "server/model/assimp_materials.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/shading/shading.h"
#include "server/model/texture_cache.h"
#include "server/model/texture_file.h"

namespace farfield {
namespace {

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(255 * (std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : 1.0f)));
}

class MaterialReader {
 public:
  MaterialReader(const aiScene& scene, bool is_gltf, const std::filesystem::path& folder, Model& model)
      : scene_(scene), is_gltf_(is_gltf), model_(model), textures_(model, folder) {}

  void add(const aiMaterial& source) {
    Material material;
    aiString name;
    if (source.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) material.name = name.C_Str();
    uv_channels_.push_back(0);
    material.texture = texture_of(source, uv_channels_.back());
    material.base_colour = colour_of(source);
    read_alpha(source, material);
    model_.materials.push_back(std::move(material));
  }

  UvChannels finish() {
    if (model_.materials.empty()) {
      model_.materials.push_back({.name = "default", .base_colour = {200, 200, 200, 255}});
      uv_channels_.push_back(0);
    }
    if (blended_ > 0) {
      model_.warnings.push_back(
          fmt::format("blended materials, drawn opaque where alpha is at least 0.5 and left out below: {}", blended_));
    }
    return std::move(uv_channels_);
  }

 private:
  int texture_of(const aiMaterial& source, unsigned& uv_channel) {
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      aiString path;
      if (source.GetTexture(type, 0, &path) != AI_SUCCESS || path.length == 0) continue;
      int channel = 0;
      if (source.Get(AI_MATKEY_UVWSRC(type, 0), channel) == AI_SUCCESS && channel > 0) {
        uv_channel = static_cast<unsigned>(channel);
      }
      return texture_index(path.C_Str());
    }
    return -1;
  }

  int texture_index(const std::string& name) {
    const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str());
    if (!embedded) return textures_.index_of(name);
    if (const int known = textures_.known(name); known != -2) return known;
    Result<TextureImage> image = decode_embedded(*embedded);
    return image ? textures_.add(name, std::move(*image)) : textures_.reject(name, image.error().message);
  }

  /// Height 0 marks a compressed file of `mWidth` bytes; otherwise texels are given as they are.
  static Result<TextureImage> decode_embedded(const aiTexture& source) {
    if (source.mHeight == 0) {
      return decode_texture({reinterpret_cast<const std::uint8_t*>(source.pcData), source.mWidth});
    }
    if (source.mWidth == 0 || source.mWidth > kMaxTextureFileEdge || source.mHeight > kMaxTextureFileEdge) {
      return fail(ErrorCode::kLimitExceeded, "an edge beyond {} texels", kMaxTextureFileEdge);
    }
    TextureImage image{.width = static_cast<int>(source.mWidth), .height = static_cast<int>(source.mHeight)};
    const std::size_t texels = std::size_t{source.mWidth} * source.mHeight;
    image.rgba.reserve(4 * texels);
    for (std::size_t i = 0; i < texels; ++i) {
      const aiTexel& t = source.pcData[i];
      image.rgba.insert(image.rgba.end(), {t.r, t.g, t.b, t.a});
    }
    return image;
  }

  glm::u8vec4 colour_of(const aiMaterial& source) const {
    aiColor4D colour(1, 1, 1, 1);
    if (!is_gltf_ || source.Get(AI_MATKEY_BASE_COLOR, colour) != AI_SUCCESS) {
      if (source.Get(AI_MATKEY_COLOR_DIFFUSE, colour) != AI_SUCCESS) colour = aiColor4D(0.8f, 0.8f, 0.8f, 1);
    }
    const auto code = [&](float value) { return is_gltf_ ? linear_to_srgb(value) : to_byte(value); };
    return {code(colour.r), code(colour.g), code(colour.b), is_gltf_ ? to_byte(colour.a) : 255};
  }

  void read_alpha(const aiMaterial& source, Material& material) {
    aiString mode;
    if (source.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == AI_SUCCESS) {
      const std::string text = mode.C_Str();
      material.is_alpha_masked = text == "MASK" || text == "BLEND";
      if (text == "BLEND") ++blended_;
      float cutoff = 0.5f;
      if (text == "MASK" && source.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff) == AI_SUCCESS && std::isfinite(cutoff)) {
        material.alpha_cutoff = cutoff;
      }
      return;
    }
    float opacity = 1;
    if (source.Get(AI_MATKEY_OPACITY, opacity) == AI_SUCCESS) material.base_colour.a = to_byte(opacity);
    if (material.base_colour.a != 255) ++blended_;
    // These formats do not say whether a texture's alpha counts; where there is some, it is meant.
    material.is_alpha_masked = material.base_colour.a != 255 || material.texture >= 0;
  }

  const aiScene& scene_;
  bool is_gltf_;
  Model& model_;
  TextureCache textures_;
  UvChannels uv_channels_;
  std::size_t blended_ = 0;
};

}  // namespace

UvChannels add_assimp_materials(const aiScene& scene, bool is_gltf, const std::filesystem::path& folder, Model& model) {
  MaterialReader reader(scene, is_gltf, folder, model);
  for (unsigned m = 0; m < scene.mNumMaterials; ++m) reader.add(*scene.mMaterials[m]);
  return reader.finish();
}

}  // namespace farfield
