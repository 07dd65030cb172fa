// SPDX-License-Identifier: Apache-2.0
// What a shell's tiles would cost and how wrong they would be for one slope or another, told from some of them.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/encode/colour_trial.h"
#include "server/impostor/cell_needs.h"

namespace farfield {

/// Of a shell's tiles those that are looked at, and how many each speaks for.
struct SampledTile {
  std::size_t index = 0;  // into the needs
  double count = 1;       // tiles like it that a leaf needs: not whole
};
/// From each view in proportion, at least a few: so that what a view costs is known. Tiles that show more are likelier to be chosen.
/// All, if they are few. Deterministic: depends on the needs, which must be in the order of their names, and on the cell.
std::vector<SampledTile> sample_tiles(std::span<const CellNeed> needs);

/// How much an error of a tile's colours counts: what delta views hold is seen at the rims of nearer things and for moments.
double colour_weight(const TileId& id);

/// Not thread-safe.
class RateModel {
 public:
  /// `tile`: covers something; `count`: of its sample.
  void add(Tile tile, double count);

  /// Of the tiles of the first so many views that a leaf needs.
  struct Outcome {
    double bytes = 0;
    double saved_by_coarse_depth = 0;  // of these: less, with twice the tolerance of disparity
    double error = 0, weighted_error = 0;  // levels²·sr; weighted with colour_weight()
    double solid_angle = 0;
    double mean_square() const { return solid_angle > 0 ? error / solid_angle : 0; }
  };
  /// [k]: of view k alone; every tile at its best quality for the slope.
  std::vector<Outcome> of_views(double slope);
  /// Mean square of what a direction shows that holds nothing and is filled with its surroundings: twice the variance of colours.
  double void_mean_square() const;

 private:
  struct Known {
    std::unique_ptr<const Tile> tile;
    std::unique_ptr<ColourTrial> trial;
    double count = 1;
    double other_bytes = 0, saved_by_coarse_depth = 0;
  };
  std::vector<Known> tiles_;
};

}  // namespace farfield
