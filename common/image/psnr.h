// SPDX-License-Identifier: Apache-2.0
// Peak signal-to-noise ratio of 8-bit sRGB images, over red, green and blue.
#pragma once

#include <span>

#include "common/image/image.h"

namespace farfield {

/// What equal images get, and nothing more than that.
inline constexpr double kMaxPsnrDb = 100.0;

/// 10·log10(255² / mean squared error) in dB, capped. Alpha is ignored. `mask`: one byte per pixel, only those not 0
/// count; empty: all do; with none to count, kMaxPsnrDb.
/// Requires: same size, at least 3 channels each; mask empty or of one byte per pixel.
double psnr_db(const Image8& a, const Image8& b, std::span<const std::uint8_t> mask = {});

}  // namespace farfield
