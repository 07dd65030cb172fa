// SPDX-License-Identifier: Apache-2.0
#include "server/model/model_stream.h"

#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <functional>

#include "common/base/memory_image.h"
#include "server/model/texture_file.h"

namespace farfield {
namespace {

constexpr std::uint64_t kMagic = 0x324c45444f4d4646ull;  // "FFMODEL2"

/// Writes to an open file from its current place; after a failure nothing more.
class DescriptorSink {
 public:
  explicit DescriptorSink(int file_descriptor) : file_descriptor_(file_descriptor) {}

  void operator()(ByteView bytes) {
    while (!bytes.empty() && error_ == 0) {
      const ssize_t written = ::write(file_descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) {
        error_ = written < 0 ? errno : EIO;
        return;
      }
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }
  int error() const { return error_; }

 private:
  int file_descriptor_;
  int error_ = 0;
};

TextureImage read_texture(MemoryImageReader& in) {
  TextureImage texture;
  texture.name = in.get_text();
  texture.width = in.get<std::int32_t>();
  texture.height = in.get<std::int32_t>();
  texture.rgba = in.get_array<std::uint8_t>();
  const bool has_size = texture.width > 0 && texture.height > 0 && texture.width <= kMaxTextureFileEdge &&
                        texture.height <= kMaxTextureFileEdge;
  in.require(has_size);
  in.require(has_size && texture.rgba.size() == std::size_t{4} * static_cast<std::size_t>(texture.width) *
                                                    static_cast<std::size_t>(texture.height));
  return texture;
}

Material read_material(MemoryImageReader& in, std::size_t textures) {
  Material material;
  material.name = in.get_text();
  material.base_colour = in.get<glm::u8vec4>();
  material.texture = in.get<std::int32_t>();
  material.is_alpha_masked = in.get<std::uint8_t>() != 0;
  material.alpha_cutoff = in.get<float>();
  in.require(std::isfinite(material.alpha_cutoff));
  in.require(material.texture >= -1 && material.texture < static_cast<std::int64_t>(textures));
  return material;
}

Mesh read_mesh(MemoryImageReader& in, std::size_t materials) {
  Mesh mesh;
  mesh.name = in.get_text();
  mesh.material = in.get<std::int32_t>();
  mesh.positions = in.get_array<glm::vec3>();
  mesh.normals = in.get_array<glm::vec3>();
  mesh.uvs = in.get_array<glm::vec2>();
  mesh.colours = in.get_array<glm::u8vec4>();
  mesh.indices = in.get_array<std::uint32_t>();
  const std::size_t count = mesh.positions.size();
  in.require(mesh.material >= 0 && mesh.material < static_cast<std::int64_t>(materials));
  in.require(mesh.normals.empty() || mesh.normals.size() == count);
  in.require(mesh.uvs.empty() || mesh.uvs.size() == count);
  in.require(mesh.colours.empty() || mesh.colours.size() == count);
  in.require(mesh.indices.size() % 3 == 0);
  return mesh;
}

}  // namespace

Status write_model_stream(const Model& model, int file_descriptor) {
  DescriptorSink sink(file_descriptor);
  MemoryImageWriter out(std::ref(sink));
  out.put(kMagic);
  out.put_text(model.name);
  out.put_texts(model.warnings);
  out.put_texts(model.sources);
  out.put<std::uint64_t>(model.textures.size());
  for (const TextureImage& texture : model.textures) {
    out.put_text(texture.name);
    out.put<std::int32_t>(texture.width);
    out.put<std::int32_t>(texture.height);
    out.put_array(texture.rgba);
  }
  out.put<std::uint64_t>(model.materials.size());
  for (const Material& material : model.materials) {
    out.put_text(material.name);
    out.put(material.base_colour);
    out.put<std::int32_t>(material.texture);
    out.put<std::uint8_t>(material.is_alpha_masked);
    out.put(material.alpha_cutoff);
  }
  out.put<std::uint64_t>(model.meshes.size());
  for (const Mesh& mesh : model.meshes) {
    out.put_text(mesh.name);
    out.put<std::int32_t>(mesh.material);
    out.put_array(mesh.positions);
    out.put_array(mesh.normals);
    out.put_array(mesh.uvs);
    out.put_array(mesh.colours);
    out.put_array(mesh.indices);
  }
  out.put<std::uint64_t>(model.instances.size());
  for (const MeshInstance& instance : model.instances) {
    out.put<std::int32_t>(instance.mesh);
    out.put(instance.world_from_mesh);
  }
  out.flush();
  if (sink.error() != 0) return fail(ErrorCode::kIo, "the model cannot be handed over: {}", std::strerror(sink.error()));
  return {};
}

Result<Model> read_model_stream(ByteView bytes) {
  // Smallest encoded entry of each list: what a count is checked against.
  constexpr std::size_t kTexture = 24, kMaterial = 21, kMesh = 52, kInstance = 4 + sizeof(glm::dmat4);
  MemoryImageReader in(bytes);
  in.require(in.get<std::uint64_t>() == kMagic);
  Model model;
  model.name = in.get_text();
  model.warnings = in.get_texts();
  model.sources = in.get_texts();
  for (std::size_t left = in.get_count(kTexture); left > 0 && in.is_valid(); --left) {
    model.textures.push_back(read_texture(in));
  }
  for (std::size_t left = in.get_count(kMaterial); left > 0 && in.is_valid(); --left) {
    model.materials.push_back(read_material(in, model.textures.size()));
  }
  for (std::size_t left = in.get_count(kMesh); left > 0 && in.is_valid(); --left) {
    model.meshes.push_back(read_mesh(in, model.materials.size()));
  }
  for (std::size_t left = in.get_count(kInstance); left > 0 && in.is_valid(); --left) {
    MeshInstance& instance = model.instances.emplace_back();
    instance.mesh = in.get<std::int32_t>();
    instance.world_from_mesh = in.get<glm::dmat4>();
    in.require(instance.mesh >= 0 && instance.mesh < static_cast<std::int64_t>(model.meshes.size()));
  }
  if (!in.is_valid() || !in.is_at_end())
    return fail(ErrorCode::kBadData, "the import process handed over damaged data");
  return model;
}

}  // namespace farfield
