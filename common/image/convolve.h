// SPDX-License-Identifier: Apache-2.0
// Separable convolution of one-channel float images; beyond the border the nearest pixel repeats.
#pragma once

#include <span>

#include "common/image/image.h"

namespace farfield {

/// out(x, y) = Σ kernel[k]·in(x + k - radius, y); kernels have 2·radius + 1 taps.
ImageF convolve_rows(const ImageF& in, std::span<const float> kernel);
/// The same along columns.
ImageF convolve_columns(const ImageF& in, std::span<const float> kernel);

}  // namespace farfield
