// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/reference_methods.h"

#include <epoxy/gl.h>

#include <chrono>
#include <iostream>
#include <unordered_map>

#include "client/gl/framebuffer.h"
#include "client/near/full_geometry.h"
#include "common/shading/shading.h"
#include "tests/bench/distribution.h"
#include "tests/bench/judge.h"

namespace farfield::bench {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

void set_frame_times(MethodResult& result, const std::vector<double>& times) {
  result.frame_p50 = percentile(times, 0.50), result.frame_p95 = percentile(times, 0.95), result.frame_p99 = percentile(times, 0.99);
}

std::shared_ptr<const client::DecodedTexture> full_texture(const Scene& scene, std::size_t index) {
  auto texture = std::make_shared<client::DecodedTexture>();
  const Scene::TextureInfo& info = scene.textures()[index];
  texture->hash = info.hash;
  texture->serial = index + 1;
  for (int level = info.level_count - 1; level >= 0; --level)
    texture->levels.push_back(scene.texture_level(static_cast<std::uint32_t>(index), level));
  return texture;
}

}  // namespace

Result<MethodResult> run_rays(const World& world) {
  MethodResult result;
  result.name = "rays";
  ErrorAverage errors(world.options.display);
  std::vector<double> times;
  for (std::size_t k = 0; k < world.poses.size(); ++k) {
    const Clock::time_point start = Clock::now();
    const ReferenceImage image = render_reference(*world.scene, world.poses[k], world.options.display, 1);
    times.push_back(ms_since(start));
    JudgedFrame frame;
    frame.rgb = image.rgb;
    errors.add(frame, world.truth[k]);
    result.pictures.push_back(image.rgb);
  }
  set_frame_times(result, times);
  result.error = errors.figures();
  return result;
}

Result<std::vector<MethodResult>> run_geometry(const World& world, bool wants_full, bool wants_culled) {
  const Scene& scene = *world.scene;
  auto context = client::GlContext::create_surfaceless();
  if (!context) return tl::unexpected(context.error());
  const client::GlAbilities& abilities = (*context)->abilities();
  std::unordered_map<ContentHash, std::shared_ptr<const client::DecodedTexture>> textures;
  for (std::size_t i = 0; i < scene.textures().size(); ++i) textures[scene.textures()[i].hash] = full_texture(scene, i);
  std::cerr << "geometry: uploading " << scene.statistics().drawn_triangles << " triangles\n";
  auto renderer = client::FullGeometryRenderer::create(abilities, scene.bounds().center(), scene.chunks().size(), [&](std::size_t index) {
    client::FullGeometryChunk chunk{scene.chunk_geometry(static_cast<std::uint32_t>(index)), scene.chunks()[index].scene_from_chunk, nullptr};
    if (const auto found = textures.find(chunk.chunk.texture); found != textures.end()) chunk.texture = found->second;
    return chunk;
  });
  if (!renderer) return tl::unexpected(renderer.error());
  const Display& display = world.options.display;
  auto target = client::Framebuffer::create(abilities, display.width, display.height, 1);
  if (!target) return tl::unexpected(target.error());

  std::vector<MethodResult> results;
  for (const bool is_culled : {false, true}) {
    if (is_culled ? !wants_culled : !wants_full) continue;
    MethodResult result;
    result.name = is_culled ? "geometry-culled" : "geometry";
    ErrorAverage errors(display);
    std::vector<double> times, triangles;
    std::vector<std::uint8_t> rgba(std::size_t{4} * display.width * display.height);
    for (std::size_t k = 0; k < world.poses.size(); ++k) {
      // A near plane as near as the client's: a thousandth of a walker's reach.
      const client::ViewTransform view = client::ViewTransform::of(display, world.poses[k], 0.01);
      const auto draw = [&] {
        target->begin();
        const client::FullGeometryStatistics drawn = (*renderer)->draw(view, is_culled);
        target->resolve();
        glFinish();
        target->read_colour(rgba);
        return drawn;
      };
      if (k == 0) draw();  // the first use compiles shaders and moves buffers
      const Clock::time_point start = Clock::now();
      const client::FullGeometryStatistics drawn = draw();
      times.push_back(ms_since(start));
      triangles.push_back(static_cast<double>(drawn.triangles));
      JudgedFrame frame;
      for (std::size_t p = 0; p < rgba.size(); p += 4) {
        const glm::u8vec3 sky = scene.background();
        const bool is_covered = rgba[p + 3] != 0;
        for (int c = 0; c < 3; ++c) frame.rgb.push_back(is_covered ? rgba[p + c] : sky[c]);
      }
      errors.add(frame, world.truth[k]);
      result.pictures.push_back(frame.rgb);
    }
    set_frame_times(result, times);
    result.triangles = mean(triangles);
    result.error = errors.figures();
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace farfield::bench
