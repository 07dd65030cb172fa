// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/layered_image.h"

#include <tbb/parallel_for.h>

#include <chrono>

#include "common/cells/sampling.h"

namespace farfield::bench {

LayeredFaceBuilder::LayeredFaceBuilder(const ViewFrame& central, double tolerance)
    : central_(central), tolerance_(static_cast<float>(tolerance)),
      head_(static_cast<std::size_t>(central.edge_samples) * static_cast<std::size_t>(central.edge_samples), 0), nodes_(1) {}

void LayeredFaceBuilder::add(const FarFace& face) {
  for (int j = 0; j < face.edge(); ++j)
    for (int i = 0; i < face.edge(); ++i) {
      const std::size_t at = face.at(i, j);
      if (!face.covered[at]) continue;
      const std::optional<FacePlace> place = place_on(central_, face.point(i, j));
      if (!place) continue;
      const auto column = static_cast<std::size_t>(std::lround(place->i)), row = static_cast<std::size_t>(std::lround(place->j));
      const auto edge = static_cast<std::size_t>(central_.edge_samples);
      if (column >= edge || row >= edge) continue;  // -0.5 rounds away from 0
      const std::uint8_t* rgb = &face.rgb[3 * at];
      install(row * edge + column, {static_cast<float>(place->disparity), rgb[0], rgb[1], rgb[2], 0});
    }
}

void LayeredFaceBuilder::install(std::size_t pixel, const LayeredSample& sample) {
  std::uint32_t before = 0, after = head_[pixel];
  for (; after != 0 && nodes_[after].sample.disparity > sample.disparity; after = nodes_[after].next) before = after;
  // Lists are sorted: only the two beside its place can be similar.
  if (before != 0 && nodes_[before].sample.disparity - sample.disparity <= tolerance_) return;
  if (after != 0 && sample.disparity - nodes_[after].sample.disparity <= tolerance_) return;
  const auto made = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({sample, after});
  (before != 0 ? nodes_[before].next : head_[pixel]) = made;
}

LayeredFace LayeredFaceBuilder::finish() const {
  LayeredFace face{central_, {}, {}};
  face.first.reserve(head_.size() + 1);
  face.samples.reserve(nodes_.size() - 1);
  for (const std::uint32_t head : head_) {
    face.first.push_back(static_cast<std::uint32_t>(face.samples.size()));
    for (std::uint32_t node = head; node != 0; node = nodes_[node].next) face.samples.push_back(nodes_[node].sample);
  }
  face.first.push_back(static_cast<std::uint32_t>(face.samples.size()));
  return face;
}

std::array<glm::dvec3, 9> construction_positions(const Box& cell, const CubeFace& face) {
  const glm::dvec3 centre = cell.center();
  std::array<glm::dvec3, 9> positions;
  positions.fill(centre);
  std::size_t at = 1;
  for (const double along : {1.0, -1.0})  // towards the image first, then behind
    for (const int across : {face.u_axis(), face.v_axis()})
      for (const double side : {-1.0, 1.0}) {
        glm::dvec3 edge_middle(0);
        edge_middle[face.axis] = along * face.sign, edge_middle[across] = side;
        positions[at++] += 0.5 * edge_middle * (0.5 * cell.extent());
      }
  return positions;
}

LayeredCellSamples make_layered_cell(const Scene& scene, const CellSpace& space, int edge) {
  LayeredCellSamples result;
  for (int f = 0; f < kCubeFaces; ++f) {
    const std::array<glm::dvec3, 9> positions = construction_positions(space.box, CubeFace::of(f));
    const auto start = std::chrono::steady_clock::now();
    std::array<FarFace, 9> images;
    images[0] = cast_far_face(scene, space, positions[0], f, edge);
    result.intra_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (std::size_t k = 1; k < positions.size(); ++k) images[k] = cast_far_face(scene, space, positions[k], f, edge);
    // Similar: what the warp moves by less than one sample anywhere in the cell, a third of a splat.
    const ViewFrame& central = images[0].frame;
    LayeredFaceBuilder builder(central, central.pitch / warp_gain(glm::dvec3(0), 2.0));
    for (const FarFace& image : images) builder.add(image);
    result.cell[static_cast<std::size_t>(f)] = builder.finish();
  }
  return result;
}

}  // namespace farfield::bench
