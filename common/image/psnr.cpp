// SPDX-License-Identifier: Apache-2.0
#include "common/image/psnr.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace farfield {

double psnr_db(const Image8& a, const Image8& b, std::span<const std::uint8_t> mask) {
  assert(a.same_size(b) && a.channels >= 3 && b.channels >= 3);
  assert(mask.empty() || mask.size() == a.pixels());
  std::uint64_t squares = 0, values = 0;
  const std::uint8_t *p = a.values.data(), *q = b.values.data();
  for (std::size_t i = 0; i < a.pixels(); ++i, p += a.channels, q += b.channels) {
    if (!mask.empty() && !mask[i]) continue;
    for (int c = 0; c < 3; ++c) {
      const int difference = p[c] - q[c];
      squares += static_cast<std::uint64_t>(difference * difference);
    }
    values += 3;
  }
  if (squares == 0) return kMaxPsnrDb;
  const double mean = static_cast<double>(squares) / static_cast<double>(values);
  return std::min(kMaxPsnrDb, 10.0 * std::log10(255.0 * 255.0 / mean));
}

}  // namespace farfield
