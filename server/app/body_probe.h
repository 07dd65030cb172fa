// SPDX-License-Identifier: Apache-2.0
// Asks a scene, by rays, where a body has room. Scene frame, metres. Immutable; safe from any thread.
//
// Lengths of a body (eye height 1.7 m, clearance 0.3 m …) are multiplied by `body_scale`, so that a scene of a
// millimetre is walked through by a visitor of fitting size.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "server/scene/scene.h"

namespace farfield {

class BodyProbe {
 public:
  BodyProbe(const Scene& scene, double body_scale) : scene_(scene), scale_(body_scale) {}
  /// 1 for scenes of 10 m and more, in proportion below.
  static double scale_for(const Scene& scene);

  double scale() const { return scale_; }
  const Scene& scene() const { return scene_; }
  double eye_height_m() const { return 1.7 * scale_; }
  double clearance_m() const { return 0.35 * scale_; }  // 0.3 m is promised; the rest covers what passes between rays

  /// Distance along `direction` (unit length) to the first surface, at most `reach_m`.
  double free_distance(const glm::dvec3& from, const glm::dvec3& direction, double reach_m) const;
  /// Height (y) of the walkable surface, at most 45 degrees steep, that a ray down from `from` meets within `reach_m`.
  std::optional<double> floor_below(const glm::dvec3& from, double reach_m) const;
  /// True if a person standing on `floor_point` touches nothing: rings of rays at knee, waist, chest and eye, tilted
  /// ones about the head, chords that catch thin posts, and head room.
  bool has_room_to_stand(const glm::dvec3& floor_point) const;
  /// True if a sphere of `radius_m` about `center` is free, as far as 48 rays can tell.
  bool has_room_to_float(const glm::dvec3& center, double radius_m) const;
  /// True if what surrounds the point shows its back to it: the inside of a closed solid.
  bool is_inside_solid(const glm::dvec3& eye) const;

  /// What rays in all directions from a point meet.
  struct Outlook {
    double hit_share = 0;         // of the rays meet something
    double near_share = 0;        // … within half a body scale
    double back_share = 0;        // of the hits show a back side
    double level_hit_share = 0;   // of the rays near the horizon meet something between 1 and 60 m
    double median_level_m = 0;    // distance to it, unlimited ones counted as 60 m (all times body scale)
  };
  Outlook look_around(const glm::dvec3& eye) const;

 private:
  const Scene& scene_;
  double scale_;
};

}  // namespace farfield
