// SPDX-License-Identifier: Apache-2.0
// The one shading function of the system, used by impostors, truth and the client's near geometry alike.
//
//   radiance(hit) = texture(uv, footprint) × interpolate over the triangle( vertex_radiance(normal, colour) )
//
// Light is baked per vertex so that server and client interpolate the same numbers. It is view-independent and
// two-sided: it depends on squares of the normal's components only (design.md section 3), so a surface looks the
// same from both sides. Everything is linear light; images are 8-bit sRGB.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace farfield {

/// Diffuse light arriving at a surface with unit normal n, as a quadratic form: brighter from above (+Y), one fill
/// direction off the axes so that the sides of a box differ. Range about 0.45 … 1.
inline float vertex_light(const glm::vec3& n) {
  constexpr glm::vec3 kAxes{0.56f, 0.86f, 0.70f};
  constexpr glm::vec3 kFill{0.48f, 0.62f, 0.62f};  // unit length to three digits
  const float fill = glm::dot(n, kFill);
  return glm::dot(n * n, kAxes) + 0.14f * fill * fill;
}

float srgb_to_linear(std::uint8_t value);
/// Clamps to [0, 1] and rounds to the nearest 8-bit code.
std::uint8_t linear_to_srgb(float value);

/// Linear radiance of a vertex. `colour` is sRGB-coded 8-bit base colour.
inline glm::vec3 vertex_radiance(const glm::vec3& unit_normal, const glm::u8vec4& colour) {
  return vertex_light(unit_normal) *
         glm::vec3(srgb_to_linear(colour.r), srgb_to_linear(colour.g), srgb_to_linear(colour.b));
}

/// Mip level for a sample whose footprint covers `texel_area` texels of level 0: half the binary logarithm of the
/// area. The near renderer computes the area from screen derivatives (|det d(uv)/d(xy)|·W·H), rays from distance,
/// inclination and the triangle's texel density: the same number, since both are the Jacobian of the projection.
inline float mip_level(float texel_area) { return texel_area > 1.0f ? 0.5f * std::log2(texel_area) : 0.0f; }

/// Colour of what no surface covers, sRGB 8-bit: the background of every scene unless it brings its own.
inline constexpr glm::u8vec3 kDefaultBackground{176, 200, 224};

}  // namespace farfield
