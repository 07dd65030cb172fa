// SPDX-License-Identifier: Apache-2.0
// What the parts of a city look like when its file gives meanings but no colours.
#pragma once

#include <glm/glm.hpp>
#include <string_view>

namespace farfield {

/// sRGB colour of a CityJSON surface: by its semantic type ("RoofSurface") where it has one that says more than its
/// object's type ("Building"), else by that type; grey for unknown ones.
glm::u8vec4 city_colour(std::string_view object_type, std::string_view surface_type);

}  // namespace farfield
