// SPDX-License-Identifier: Apache-2.0
#include "server/app/build_service.h"

#include <chrono>
#include <filesystem>

#include "server/app/walk_path.h"
#include "server/encode/tile_maker.h"
#include "server/schedule/scene_geometry.h"

namespace farfield {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::string default_name(const std::string& scene) {
  const bool is_generated = scene.find('/') == std::string::npos && scene.find(':') != std::string::npos;
  return is_generated ? scene : std::filesystem::path(scene).stem().string();
}

}  // namespace

Result<SceneArgument> parse_scene_argument(const std::string& text) {
  const std::size_t equals = text.find('=');
  // A '=' behind a slash belongs to a path.
  const bool has_name = equals != std::string::npos && text.substr(0, equals).find('/') == std::string::npos;
  SceneArgument argument;
  argument.scene = has_name ? text.substr(equals + 1) : text;
  argument.name = has_name ? text.substr(0, equals) : default_name(argument.scene);
  if (argument.name.empty() || argument.scene.empty()) {
    return fail(ErrorCode::kInvalidArgument, "--scene '{}': write SCENE or NAME=SCENE", text);
  }
  return argument;
}

std::shared_ptr<MeasuredCellService> service_for_scene(const std::string& name, std::shared_ptr<const Scene> scene,
                                                       const ServiceOptions& options) {
  ImpostorSettings settings = options.settings;
  settings.finest_side_m = finest_side_for(*scene, settings.finest_side_m);

  const Result<glm::dvec3> standing = standing_point(*scene, 1);
  if (!standing && options.log) options.log(name + ": warning: no place to stand was found, viewers start at the scene's centre");
  SceneDescription description = describe_scene(*scene, settings, standing ? *standing : scene->bounds().center());
  description.name = name;

  const ImpostorSources sources = make_impostor_sources(scene, settings);
  CellServiceParts parts;
  parts.scene = std::move(description);
  parts.geometry = scene_geometry(scene);
  parts.leaves = sources.leaves;
  parts.tiles = sources.tiles;
  parts.store = options.store;
  parts.pool = options.pool;
  parts.blobs = options.blobs, parts.lease = options.lease, parts.prompt_pool = options.prompt_pool;
  return make_cell_service(std::move(parts));
}

Result<std::shared_ptr<MeasuredCellService>> build_service(const SceneArgument& argument, const ServiceOptions& options) {
  const auto log = [&](const std::string& line) {
    if (options.log) options.log(argument.name + ": " + line);
  };
  const Clock::time_point start = Clock::now();
  Result<Model> model = load_model(argument.scene, options.load);
  if (!model) return tl::unexpected(model.error());
  for (const std::string& warning : model->warnings) log("warning: " + warning);
  log(fmt::format("loaded in {:.2f} s, {} triangles", seconds_since(start), model->drawn_triangles()));

  const Clock::time_point build_start = Clock::now();
  Result<std::shared_ptr<const Scene>> scene = Scene::build(std::move(*model));
  if (!scene) return fail_within(argument.scene, scene.error());
  std::shared_ptr<MeasuredCellService> service = service_for_scene(argument.name, *scene, options);
  log(fmt::format("ready in {:.2f} s, {} chunks, finest cells of {:g} m", seconds_since(build_start),
                  (*scene)->statistics().chunks, service->scene().settings.finest_side_m));
  return service;
}

}  // namespace farfield
