// SPDX-License-Identifier: Apache-2.0
// The full model drawn as triangles through OpenGL: as it is (Chuang 2002's configuration A), and without the chunks
// outside the view (his B).
#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "client/store/leaf_view.h"
#include "tests/bench/method.h"

namespace farfield::bench {

/// Knob of both: samples per pixel. Errors of both: no OpenGL.
Method geometry_method();
Method geometry_culled_method();

/// As near as the client's: a thousandth of a walker's reach.
inline constexpr double kNearPlaneM = 0.01;
/// Textures of the scene with all their mip levels.
using TexturesByHash = std::unordered_map<ContentHash, std::shared_ptr<const client::DecodedTexture>>;
TexturesByHash full_textures(const Scene& scene);
/// The resolved image over the scene's background. Pixels that are covered in part are mixed in linear light.
std::vector<std::uint8_t> over_background(const Scene& scene, const std::vector<std::uint8_t>& rgba);

}  // namespace farfield::bench
