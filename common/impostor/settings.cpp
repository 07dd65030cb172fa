// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/settings.h"

#include <array>

namespace farfield {

ContentHash ImpostorSettings::hash() const {
  const std::array<double, 11> values{finest_side_m,
                                      kappa,
                                      static_cast<double>(face_tiles),
                                      tau_px,
                                      static_cast<double>(display.width),
                                      static_cast<double>(display.height),
                                      display.fovy_rad,
                                      static_cast<double>(near_triangles),
                                      static_cast<double>(delta_views),
                                      void_target,
                                      static_cast<double>(jpeg_quality)};
  return hash_values(std::span<const double>(values));
}

}  // namespace farfield
