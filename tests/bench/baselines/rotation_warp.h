// SPDX-License-Identifier: Apache-2.0
// What a video client can do about a picture that is a little late: turn it to where the viewer looks now.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/camera.h"

namespace farfield::bench {

/// Each pixel of `shown` takes the colour of its direction in the picture (bilinear), or of the picture's nearest edge.
/// Both are sRGB rows top to bottom. The eye's position does not count: the picture holds no depth.
std::vector<std::uint8_t> warp_by_rotation(std::span<const std::uint8_t> picture, const Display& picture_display,
                                           const glm::dquat& world_from_picture, const Display& shown, const glm::dquat& world_from_shown);

}  // namespace farfield::bench
