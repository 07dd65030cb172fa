// SPDX-License-Identifier: Apache-2.0
// The scene's near geometry and description for the schedule.
#pragma once

#include <memory>

#include "common/impostor/settings.h"
#include "server/scene/scene.h"
#include "server/schedule/geometry_source.h"

namespace farfield {

std::shared_ptr<const GeometrySource> scene_geometry(std::shared_ptr<const Scene> scene);

/// `start`: a viewpoint where a person can stand, scene frame.
SceneDescription describe_scene(const Scene& scene, const ImpostorSettings& settings, const glm::dvec3& start);

}  // namespace farfield
