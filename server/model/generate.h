// SPDX-License-Identifier: Apache-2.0
// Generated scenes for scale: deterministic by seed, at constant density, so the extent grows with the count.
#pragma once

#include <cstdint>
#include <string_view>

#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

/// kind: "pipes" (a dense plant: racks, ducts, vessels, platforms on several floors), "city" (streets, textured
/// façades, roofs, trees), "statues" (a park of scanned-like meshes, instanced), "house" (rooms, doors, furniture).
/// The drawn triangle count is within 2 % of `triangles` (at least 1,000; up to 50 million).
/// Walkable: the ground (or a floor) is near y = 0 and a person at eye height 1.7 m can stand in most of it.
Result<Model> generate_model(std::string_view kind, std::size_t triangles, std::uint64_t seed);

}  // namespace farfield
