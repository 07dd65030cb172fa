// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/far_view.h"

#include <tbb/parallel_for.h>

namespace farfield::bench {

std::optional<FacePlace> place_on(const ViewFrame& frame, const glm::dvec3& point) {
  const glm::dvec3 relative = point - frame.position;
  const double z = frame.face.sign * relative[frame.face.axis];
  if (!(z > 0)) return std::nullopt;
  const FacePlace place{sample_index(frame.edge_samples, relative[frame.face.u_axis()] / z),
                        sample_index(frame.edge_samples, relative[frame.face.v_axis()] / z), frame.side_m / z};
  const double last = frame.edge_samples - 0.5;
  if (!(place.i >= -0.5 && place.j >= -0.5 && place.i < last && place.j < last)) return std::nullopt;
  return place;
}

CellSpace far_space(const NestedShells& shells, const CellId& leaf) {
  // A cell that is its own root has a shell without end.
  CellSpace space = CellSpace::of_shell(shells, leaf, leaf);
  space.shell.inside = space.shell.inside.grown(-kOverlapSides * space.side_m);
  return space;
}

FarFace cast_far_face(const Scene& scene, const CellSpace& space, const glm::dvec3& position, int face, int edge) {
  FarFace result;
  result.face = face;
  result.frame = ViewFrame::of(space, position, face, edge);
  SampleArrays samples(static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge));
  tbb::parallel_for(0, (edge + 3) / 4, [&](int block_row) {
    std::vector<UnevenPacket> uneven;
    for (int x = 0; x < edge; x += 4) {
      int i[kPacketSize], j[kPacketSize], index[kPacketSize];
      for (int lane = 0; lane < kPacketSize; ++lane) {
        i[lane] = x + lane % 4, j[lane] = 4 * block_row + lane / 4;
        index[lane] = result.holds(i[lane], j[lane]) ? static_cast<int>(result.at(i[lane], j[lane])) : -1;
      }
      cast_samples(scene, space, result.frame, i, j, index, samples, uneven);
    }
    shade_uneven(scene, result.frame, uneven, samples.covered, samples);
  });
  result.covered = std::move(samples.covered);
  result.disparity = std::move(samples.disparity);
  result.rgb = std::move(samples.rgb);
  const glm::u8vec3 sky = scene.background();
  for (std::size_t k = 0; k < result.covered.size(); ++k)
    if (!result.covered[k])
      for (int c = 0; c < 3; ++c) result.rgb[3 * k + static_cast<std::size_t>(c)] = sky[c];
  return result;
}

FarView cast_far_view(const Scene& scene, const CellSpace& space, const glm::dvec3& position, int edge) {
  FarView view;
  view.position = position;
  for (int face = 0; face < kCubeFaces; ++face) view.faces[static_cast<std::size_t>(face)] = cast_far_face(scene, space, position, face, edge);
  return view;
}

}  // namespace farfield::bench
