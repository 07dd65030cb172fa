// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/geometry.h"

#include <epoxy/gl.h>

#include <iostream>

#include "client/gl/framebuffer.h"
#include "client/near/full_geometry.h"
#include "common/shading/shading.h"
#include "tests/bench/measure_frames.h"

namespace farfield::bench {
namespace {

std::shared_ptr<const client::DecodedTexture> full_texture(const Scene& scene, std::size_t index) {
  auto texture = std::make_shared<client::DecodedTexture>();
  const Scene::TextureInfo& info = scene.textures()[index];
  texture->hash = info.hash;
  texture->serial = index + 1;
  for (int level = info.level_count - 1; level >= 0; --level)
    texture->levels.push_back(scene.texture_level(static_cast<std::uint32_t>(index), level));
  return texture;
}

Result<MethodResult> run_geometry(const World& world, const KnobValues& knobs, bool is_culled) {
  const Scene& scene = *world.scene;
  auto context = client::GlContext::create_surfaceless();
  if (!context) return tl::unexpected(context.error());
  const client::GlAbilities& abilities = (*context)->abilities();
  const auto textures = full_textures(scene);
  std::cerr << "uploading " << scene.statistics().drawn_triangles << " triangles\n";
  auto renderer = client::FullGeometryRenderer::create(abilities, scene.bounds().center(), scene.chunks().size(), [&](std::size_t index) {
    client::FullGeometryChunk chunk{scene.chunk_geometry(static_cast<std::uint32_t>(index)), scene.chunks()[index].scene_from_chunk, nullptr};
    if (const auto found = textures.find(chunk.chunk.texture); found != textures.end()) chunk.texture = found->second;
    return chunk;
  });
  if (!renderer) return tl::unexpected(renderer.error());
  const Display& display = world.options.display;
  auto target = client::Framebuffer::create(abilities, display.width, display.height, knobs.whole("samples"));
  if (!target) return tl::unexpected(target.error());
  std::vector<std::uint8_t> rgba(std::size_t{4} * display.width * display.height);
  const auto draw = [&](const Pose& eye) -> Result<DrawnFrame> {
    const BenchClock::time_point start = BenchClock::now();
    target->begin();
    const client::FullGeometryStatistics drawn = (*renderer)->draw(client::ViewTransform::of(display, eye, kNearPlaneM), is_culled);
    target->resolve();
    glFinish();
    target->read_colour(rgba);
    DrawnFrame frame;
    frame.ms = ms_since(start);
    frame.triangles = static_cast<double>(drawn.triangles);
    frame.seen.rgb = over_background(scene, rgba);
    return frame;
  };
  MethodResult result;
  if (Status status = measure_frames(world, draw, result); !status) return tl::unexpected(status.error());
  return result;
}

Method method(const char* name, const char* summary, bool is_culled) {
  return {name, summary, {{.name = "samples", .default_value = 1, .description = "multisamples per pixel", .choices = {1, 4}}},
          [is_culled](const World& world, const KnobValues& knobs) { return run_geometry(world, knobs, is_culled); }};
}

}  // namespace

Method geometry_method() { return method("geometry", "the full model, drawn through OpenGL (Chuang 2002, A)", false); }
Method geometry_culled_method() { return method("geometry-culled", "the same without chunks outside the view (Chuang 2002, B)", true); }

TexturesByHash full_textures(const Scene& scene) {
  TexturesByHash textures;
  for (std::size_t i = 0; i < scene.textures().size(); ++i) textures[scene.textures()[i].hash] = full_texture(scene, i);
  return textures;
}

std::vector<std::uint8_t> over_background(const Scene& scene, const std::vector<std::uint8_t>& rgba) {
  const glm::u8vec3 sky = scene.background();
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t p = 0; p < rgba.size(); p += 4)
    for (int c = 0; c < 3; ++c) {
      const std::uint8_t alpha = rgba[p + 3];
      // What of a pixel nothing covers is black, and already in the average.
      const auto mixed = [&] { return linear_to_srgb(srgb_to_linear(rgba[p + c]) + (1 - alpha / 255.0f) * srgb_to_linear(sky[c])); };
      rgb.push_back(alpha == 255 ? rgba[p + c] : alpha == 0 ? sky[c] : mixed());
    }
  return rgb;
}

}  // namespace farfield::bench
