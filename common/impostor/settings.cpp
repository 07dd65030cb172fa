// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/settings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/cells/sampling.h"

namespace farfield {

ContentHash ImpostorSettings::hash() const {
  const std::array<double, 16> values{finest_side_m,
                                      kappa,
                                      static_cast<double>(face_tiles),
                                      tau_px,
                                      static_cast<double>(display.width),
                                      static_cast<double>(display.height),
                                      display.fovy_rad,
                                      static_cast<double>(near_triangles),
                                      static_cast<double>(delta_views),
                                      void_target,
                                      static_cast<double>(colour_quality),
                                      targets.void_share,
                                      targets.coding_psnr_db,
                                      has_one_slope ? 1.0 : 0.0,
                                      rate.cell_bytes,
                                      rate.psnr_db};
  return hash_values(std::span<const double>(values));
}

int face_tiles_for(const Display& display, double kappa, double rate) {
  const double tiles = rate * edge_samples_for(display, kappa) / kTileStride;
  return std::clamp(static_cast<int>(std::lround(tiles)), 1, 64);
}

}  // namespace farfield
