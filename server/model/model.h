// SPDX-License-Identifier: Apache-2.0
// What a file (or a generator) holds: meshes, materials, textures and instances. The way into the scene.
//
// Positions are floats relative to their mesh; the instance transform, in double, carries them to the world, so that
// georeferenced models lose nothing: importers subtract an offset in double before they store a float.
// World: right-handed, +Y up, metres (after --up and --units).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/math/box.h"

namespace farfield {

/// 8-bit sRGB colour with alpha, rows top to bottom, 4 bytes per texel. v = 0 is the first row (glTF's convention).
struct TextureImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  std::string name;
};

struct Material {
  std::string name;
  glm::u8vec4 base_colour{255};  // sRGB, multiplied with vertex colour and texture
  int texture = -1;              // index into Model::textures, -1 for none
  bool is_alpha_masked = false;  // texels with alpha < alpha_cutoff are holes
  float alpha_cutoff = 0.5f;
};

struct Mesh {
  std::string name;
  int material = 0;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;    // unit, per vertex; empty: flat shading by triangle
  std::vector<glm::vec2> uvs;        // empty: zero
  std::vector<glm::u8vec4> colours;  // sRGB; empty: white
  std::vector<std::uint32_t> indices;  // three per triangle, each < positions.size()
};

struct MeshInstance {
  int mesh = 0;
  glm::dmat4 world_from_mesh{1};
};

struct Model {
  std::string name;
  std::vector<TextureImage> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<MeshInstance> instances;
  std::vector<std::string> warnings;  // what was dropped or assumed at import, one line each
  // Files that were read, and names at which none was found, in the order they were asked for, perhaps repeatedly. While none of them
  // changes, nor appears, the same arguments give the same model. Empty for a generated one.
  std::vector<std::string> sources;

  /// Triangles drawn: every instance counted.
  std::size_t drawn_triangles() const;
  /// World bounds over all instances, exact in double over the float vertices.
  Box bounds() const;
};

}  // namespace farfield
