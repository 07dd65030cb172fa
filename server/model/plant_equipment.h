// SPDX-License-Identifier: Apache-2.0
// What stands and hangs in the generated plant. Frames: y up, standing on y = 0; sizes in metres.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "server/model/model_builder.h"
#include "server/model/random_stream.h"
#include "server/model/shapes.h"

namespace farfield {

struct PlantPaints {
  Paint steel, concrete, plate, grating;  // steel: coloured per object; the others textured
  Paint coloured(const glm::u8vec4& colour) const { return {steel.material, colour, 0}; }
};

/// The colour a pipe carries by what flows in it, as plants code them.
glm::u8vec4 pipe_colour(RandomStream& random);

/// A pipe along `points` with bends at the inner ones, flanges at both ends and at every other joint.
void add_pipe_route(ModelBuilder& builder, const Paint& paint, const std::vector<glm::vec3>& points, float radius_m,
                    bool has_flanges);
void add_flange(ModelBuilder& builder, const Paint& paint, const glm::vec3& center, const glm::vec3& axis,
                float radius_m);
/// A gate valve on a pipe along `axis`: body, bonnet, stem and hand wheel pointing up.
void add_valve(ModelBuilder& builder, const PlantPaints& paints, const glm::vec3& center, const glm::vec3& axis,
               float radius_m);

void add_vertical_vessel(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float radius_m,
                         float height_m, RandomStream& random);
void add_drum(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float radius_m, float length_m,
              RandomStream& random);
void add_pump(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, RandomStream& random);
void add_exchanger(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float length_m,
                   RandomStream& random);
void add_cabinet(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, RandomStream& random);
/// A rectangular air duct along local x at y = 0 (its lower side), with stiffening frames.
void add_duct(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float length_m, glm::vec2 section_m);

/// An I-section along local x, its upper face at y = 0.
void add_beam(ModelBuilder& builder, const Paint& paint, const Frame& frame, float length_m, float height_m);
/// An H-section column standing on y = 0.
void add_column(ModelBuilder& builder, const Paint& paint, const Frame& frame, float height_m, float width_m);
/// A guard rail along local x: posts, two rails and a toe board.
void add_railing(ModelBuilder& builder, const Paint& paint, const Frame& frame, float length_m);
/// A vertical ladder with a safety cage, climbing along local y at the origin, rungs across local x.
void add_ladder(ModelBuilder& builder, const Paint& paint, const Frame& frame, float height_m);

}  // namespace farfield
