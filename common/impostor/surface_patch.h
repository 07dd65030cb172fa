// SPDX-License-Identifier: Apache-2.0
// A rectangular window of samples with their cuts: what meshing works on. A dense tile is one patch; each block of a
// packed tile is one, with a border of one sample taken from its neighbours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace farfield {

/// A view of samples held elsewhere; arrays are [row][column], `width` apart.
struct SurfacePatch {
  int width = 0, height = 0;  // in samples
  const std::uint8_t* coverage = nullptr;
  const float* disparity = nullptr;
  const std::uint8_t* cut_right = nullptr;
  const std::uint8_t* cut_down = nullptr;

  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
  bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  bool is_covered(int x, int y) const { return holds(x, y) && coverage[at(x, y)] != 0; }

  /// One surface reaches from (x, y) to its neighbour one step along x (axis 0) or y (axis 1).
  bool is_connected(int x, int y, int axis) const {
    return is_covered(x, y) && is_covered(x + (axis == 0), y + (axis == 1)) &&
           (axis == 0 ? cut_right : cut_down)[at(x, y)] == 0;
  }
};

/// How the square between (x, y) and (x+1, y+1) is to be drawn.
enum class QuadKind : std::uint8_t {
  kNone,   // no surface at any corner, or drawn by a neighbouring patch
  kCut,    // cut, or some corners not covered
  kPlain,  // four corners of one surface: may be merged with its neighbours
};

/// The kind of each of the (width-1)·(height-1) quads, [row][column].
void classify_quads(const SurfacePatch& patch, std::vector<QuadKind>& kinds);

/// The change of disparity per sample of the surface at (x, y), going outwards along `axis` in direction `sign`
/// (±1), where the surface ends before the next sample: taken from the connected neighbour behind, else from
/// parallel neighbours of the same surface, else 0. It depends on the sample and the direction only, so that the
/// cells on both sides of a cut edge agree.
float outward_slope(const SurfacePatch& patch, int x, int y, int axis, int sign);

}  // namespace farfield
