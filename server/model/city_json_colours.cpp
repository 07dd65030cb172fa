// SPDX-License-Identifier: Apache-2.0
#include "server/model/city_json_colours.h"

#include <optional>

namespace farfield {
namespace {

struct NamedColour {
  std::string_view type;
  glm::u8vec4 colour;
};

constexpr glm::u8vec4 kUnknown{190, 190, 190, 255};

constexpr NamedColour kSurfaceColours[] = {
    {"RoofSurface", {176, 84, 66, 255}},
    {"WallSurface", {214, 196, 168, 255}},
    {"GroundSurface", {140, 134, 124, 255}},
    {"OuterCeilingSurface", {170, 162, 150, 255}},
    {"OuterFloorSurface", {150, 144, 134, 255}},
    {"ClosureSurface", {190, 186, 178, 255}},
    {"Window", {104, 132, 152, 255}},
    {"Door", {112, 80, 54, 255}},
    {"InteriorWallSurface", {226, 220, 208, 255}},
    {"CeilingSurface", {236, 234, 228, 255}},
    {"FloorSurface", {168, 146, 120, 255}},
    {"WaterSurface", {92, 136, 172, 255}},
    {"WaterGroundSurface", {110, 112, 96, 255}},
    {"WaterClosureSurface", {92, 136, 172, 255}},
    {"TrafficArea", {120, 120, 124, 255}},
    {"AuxiliaryTrafficArea", {146, 142, 132, 255}},
};

constexpr NamedColour kObjectColours[] = {
    {"Building", {208, 178, 150, 255}},
    {"BuildingPart", {208, 178, 150, 255}},
    {"BuildingInstallation", {184, 166, 148, 255}},
    {"Bridge", {164, 158, 150, 255}},
    {"BridgePart", {164, 158, 150, 255}},
    {"Tunnel", {140, 136, 130, 255}},
    {"Road", {122, 122, 126, 255}},
    {"Railway", {128, 112, 100, 255}},
    {"TransportSquare", {150, 146, 142, 255}},
    {"WaterBody", {92, 136, 172, 255}},
    {"PlantCover", {108, 146, 84, 255}},
    {"SolitaryVegetationObject", {86, 128, 70, 255}},
    {"LandUse", {158, 166, 120, 255}},
    {"TINRelief", {150, 158, 122, 255}},
    {"CityFurniture", {130, 132, 140, 255}},
    {"GenericCityObject", {186, 182, 174, 255}},
    {"OtherConstruction", {176, 170, 162, 255}},
};

template <std::size_t N>
std::optional<glm::u8vec4> find(const NamedColour (&table)[N], std::string_view type) {
  for (const NamedColour& entry : table) {
    if (entry.type == type) return entry.colour;
  }
  return std::nullopt;
}

}  // namespace

glm::u8vec4 city_colour(std::string_view object_type, std::string_view surface_type) {
  if (const auto colour = find(kSurfaceColours, surface_type)) return *colour;
  return find(kObjectColours, object_type).value_or(kUnknown);
}

}  // namespace farfield
