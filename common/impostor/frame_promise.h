// SPDX-License-Identifier: Apache-2.0
// From the certificates of the tiles before an eye to one promise for its frame: how much of it is void, how its impostor
// pixels compare with truth, and how far they are displaced.
//
// Tiles are strata: what is promised is an upper bound of their weighted mean, with kConfidence.
//   voids   The shells' counts are independent, each nearly Poisson, since voids are rare: the bound adds to the sum of shares
//           what Garwood 1936 ("Fiducial limits for the Poisson distribution") adds to the sum of counts, over the fewest rays.
//   colour  mean + z·error, the error being that of a stratified sample (Cochran 1977, "Sampling Techniques", eq. 5.6): every
//           tile was measured, so how they differ from each other adds nothing to it. What no view holds is in no tile: its share
//           of the directions that show impostors is filled in or seen through, as wrong as another colour of the scene would be.
//   warp    No tile's 99th percentile is exceeded, so neither is it by all of them together; each moved as far as the
//           eye's place in the cell lets an error of its disparity move it (sampling.h). Of tiles not measured the bound
//           that coding guarantees stands for the percentile.
// What validation does not see, frames that show more than their share of voids and the warp among it, is allowed for by the slack
// below, measured with farfield-calibration (tests/bench).
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <vector>

#include "common/impostor/certificate.h"
#include "common/impostor/tile_id.h"
#include "common/math/camera.h"

namespace farfield {

/// NaN where nothing was certified.
struct FramePromise {
  double void_share = std::numeric_limits<double>::quiet_NaN();  // of the frame's pixels, at most
  double psnr_db = std::numeric_limits<double>::quiet_NaN();     // of pixels that show impostors, at least
  double warp_px = std::numeric_limits<double>::quiet_NaN();     // 99th percentile over these, at most

  // What validation found, without confidence and slack: what to expect rather than what is promised.
  double expected_void_share = std::numeric_limits<double>::quiet_NaN();
  double expected_psnr_db = std::numeric_limits<double>::quiet_NaN();
};

struct PromiseSlack {
  /// A frame looks at a ninth of the sphere, and voids lie together: along the rim of one near thing.
  double void_factor = 6;
  /// Share added for what no view of a shell is asked about: samples missing along rims, seams and in tiles too small to be worth
  /// sending. They are pixels wide, so their share goes with the pixel's pitch, here in its tangent units: 4e-4 at 720p.
  double void_per_pitch = 0.25;
  /// The worst frame of plants, houses and streets was 3.1 dB below what its certificates expected; of 110 frames of 17 scenes
  /// that had no part in setting this, 2 dB. Of tiles alone: voids have the factor above.
  double colour_db = 3.5;
  /// Levels² between truth and what is shown where no view holds anything: two colours of a scene that have nothing to do with each
  /// other. Twice the variance of colours was 600 to 3,800 in 80 shells of plants, cities and statues.
  double void_mse = 4000;
  /// A frame that shows a part of a tile may show the part that moved most: the worst of 110 frames of 17 scenes exceeded its tiles'
  /// percentiles by 7 %.
  double warp_factor = 1.25;
};

/// How a client shows impostors.
struct PromisedView {
  Pose eye;  // scene frame
  Display display;
  int samples_per_pixel = 1;
  bool is_mesh = false;  // simplified: disparities may be off by the tolerance once more
  double kappa = 2;
};

/// What of a tile matters here.
struct CertifiedTile {
  TileId id;
  glm::dvec3 view_position{0};  // scene frame
  double side_m = 1;
  int edge_samples = 0;
  std::uint32_t covered_samples = 0;
  float tolerance = 0;
  Certificate certificate;
};

class PromiseSum {
 public:
  static constexpr double kConfidence = 0.99;

  explicit PromiseSum(const PromisedView& view, const PromiseSlack& slack = {});
  void add(const CertifiedTile& tile);
  FramePromise promise() const;

 private:
  const PromisedView view_;
  const PromiseSlack slack_;
  glm::dmat3 camera_from_world_;
  struct MeasuredColour {
    double weight, mse, error;
  };
  std::vector<MeasuredColour> colours_;  // of tiles in the frame
  double warp_px_ = -1;
  std::map<CellId, Certificate> shells_;
};

/// The largest mean that makes `count` or fewer events no less likely than 1 - confidence.
double poisson_upper_bound(double count, double confidence);

}  // namespace farfield
