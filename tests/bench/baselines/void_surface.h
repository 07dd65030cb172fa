// SPDX-License-Identifier: Apache-2.0
// How much of what is seen from a viewpoint no sample knows: the solid angle of the global void surface.
//
// Based on: Wilson & Manocha 2003, sections 3.3.3 to 3.3.5. A pixel belongs to the void if skins of every sample lie before all
// valid surfaces there. Differs: drawn in software by a homogeneous rasteriser (Olano & Greer 1997), which takes skins
// that end at infinity or pass behind the viewpoint as they are, instead of by the stencil buffer.
#pragma once

#include <array>

#include "tests/bench/baselines/skins.h"

namespace farfield::bench {

/// The skins of a view: its six faces' connections.
using ViewAdjacency = std::vector<Adjacency>;
ViewAdjacency connect_view(const FarView& view, std::span<const FarView* const> others);

/// The picture of the void from one viewpoint; samples are added as they are taken. Not thread-safe.
class VoidMeter {
 public:
  /// `edge`: pixels along a face of the picture.
  VoidMeter(const glm::dvec3& viewpoint, double side_m, int edge);

  void add(const FarView& sample, const ViewAdjacency& adjacency);
  /// Steradians of the pixels in the global void; it never grows by adding a sample.
  double solid_angle() const;
  const glm::dvec3& viewpoint() const { return viewpoint_; }

 private:
  struct Corner {  // of a triangle: position = viewpoint + q·side/disparity; disparity 0: infinitely far
    glm::dvec3 q;
    double disparity = 0;
    int face = 0;        // of the picture …
    float x = 0, y = 0;  // … and where on it, in pixels whose centres are whole numbers
  };
  Corner corner_of(const FarFace& face, int i, int j, const glm::dvec3& shift) const;
  bool is_between_pixels(const Corner& a, const Corner& b, const Corner& c, const Corner& d) const;
  using Picture = std::vector<float>;  // [face][row][column]: the nearest disparity, 1/side
  void draw(const Corner& a, const Corner& b, const Corner& c, Picture& picture) const;
  void draw_on(int face, const Corner& a, const Corner& b, const Corner& c, Picture& picture) const;

  glm::dvec3 viewpoint_;
  double side_m_;
  int edge_;
  Picture surface_;       // of all samples
  Picture nearest_skin_;  // the farthest of the samples' nearest skins
  bool is_first_ = true;
};

}  // namespace farfield::bench
