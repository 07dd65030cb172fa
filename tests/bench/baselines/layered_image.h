// SPDX-License-Identifier: Apache-2.0
// Layered depth images: several samples a pixel, front to back, all seen in the directions of one central view.
//
// Based on: Aliaga 1998, section 4.3 and figure 4-6. Of two samples of a pixel at similar depth the earlier stays; the
// alternative, to store both where their colours differ, makes the image larger and its surfaces no more complete.
#pragma once

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "tests/bench/baselines/far_view.h"

namespace farfield::bench {

struct LayeredSample {
  float disparity = 0;  // 1/side, along the face's axis
  std::uint8_t r = 0, g = 0, b = 0, unused = 0;
};

/// Pixel k holds samples [first[k], first[k + 1]), of falling disparity.
struct LayeredFace {
  ViewFrame frame;
  std::vector<std::uint32_t> first;
  std::vector<LayeredSample> samples;

  std::size_t pixels() const { return first.empty() ? 0 : first.size() - 1; }
};
using LayeredCell = std::array<LayeredFace, kCubeFaces>;

/// Builds one face. Views are added in the order of their worth.
class LayeredFaceBuilder {
 public:
  /// `tolerance`: disparities (1/side) that are similar.
  LayeredFaceBuilder(const ViewFrame& central, double tolerance);

  /// Warps every sample of `face` to the central view. O(samples · layers).
  void add(const FarFace& face);
  LayeredFace finish() const;

 private:
  struct Node {
    LayeredSample sample;
    std::uint32_t next = 0;
  };
  void install(std::size_t pixel, const LayeredSample& sample);

  ViewFrame central_;
  float tolerance_;
  std::vector<std::uint32_t> head_;  // 0: none
  std::vector<Node> nodes_;          // the first is not used
};

/// Where Aliaga's figure 4-7 places an image's views around a central one: at the middle of the vectors from there to the
/// midpoints of the image quadrilateral's edges, and four more behind. The quadrilateral stands on the border of the
/// viewpoints' region, as his image A does: here on the cell's face. The central position first.
std::array<glm::dvec3, 9> construction_positions(const Box& cell, const CubeFace& face);

struct LayeredCellSamples {
  LayeredCell cell;
  double intra_seconds = 0;  // casting the central images alone
};
/// The six images of a cell's far field, each from its nine views.
LayeredCellSamples make_layered_cell(const Scene& scene, const CellSpace& space, int edge);

struct LayeredEncoding {
  int jpeg_quality = 76;
  double disparity_step = 1e-3;  // 1/side
};
struct EncodedLayers {
  Bytes depth, colour;
  std::size_t size() const { return depth.size() + colour.size(); }
};
/// Layer counts and disparities losslessly but for the step, the front layer's colours as an image, deeper ones packed.
/// Requires: at most 255 samples a pixel (more are left out, the farthest first). Errors: kInternal.
Result<EncodedLayers> encode_layers(const LayeredFace& face, const LayeredEncoding& encoding);
/// Errors: kBadData.
Result<LayeredFace> decode_layers(const ViewFrame& frame, const EncodedLayers& bytes, const LayeredEncoding& encoding);

}  // namespace farfield::bench
