// SPDX-License-Identifier: Apache-2.0
#include "server/app/build_service.h"

#include <filesystem>

#include "server/encode/tile_maker.h"
#include "server/schedule/scene_geometry.h"

namespace farfield {
namespace {

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

std::shared_ptr<MeasuredCellService> service_for_scene(const std::string& name, const PreparedScene& prepared, const ServiceOptions& options) {
  const std::shared_ptr<const Scene>& scene = prepared.scene;
  ImpostorSettings settings = options.settings;
  settings.finest_side_m = finest_side_for(*scene, settings.finest_side_m);

  if (!prepared.standing && options.log) options.log(name + ": warning: no place to stand was found, viewers start at the scene's centre");
  SceneDescription description = describe_scene(*scene, settings, prepared.standing.value_or(scene->bounds().center()));
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
  const auto log = [name = argument.name, log = options.log](const std::string& line) {
    if (log) log(name + ": " + line);
  };
  Result<PreparedScene> prepared =
      options.prepared ? options.prepared->open(argument.scene, options.load, log) : prepare_scene(argument.scene, options.load, log);
  if (!prepared) return tl::unexpected(prepared.error());
  std::shared_ptr<MeasuredCellService> service = service_for_scene(argument.name, *prepared, options);
  log(fmt::format("finest cells of {:g} m", service->scene().settings.finest_side_m));
  return service;
}

}  // namespace farfield
