// SPDX-License-Identifier: Apache-2.0
// Prepared scenes: read from a folder that somebody else may have written to.
#include "server/scene/scene.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  farfield::MemoryImageReader in({data, size});
  const auto scene = farfield::Scene::restore(in);
  if (!scene) return 0;
  for (const std::uint32_t chunk : (*scene)->chunks_in((*scene)->bounds())) {
    farfield::fuzz::require(!(*scene)->chunk_geometry(chunk).indices.empty(), "chunks have triangles");
  }
  farfield::RayPacket rays{};
  rays.active = 1;
  const glm::vec3 from((*scene)->bounds().max + 1.0), towards((*scene)->bounds().center() - glm::dvec3(from));
  rays.origin_x[0] = from.x, rays.origin_y[0] = from.y, rays.origin_z[0] = from.z;
  rays.direction_x[0] = towards.x, rays.direction_y[0] = towards.y, rays.direction_z[0] = towards.z;
  rays.far[0] = 10;
  farfield::HitPacket hits;
  (*scene)->intersect(rays, hits);
  float colours[3 * farfield::kPacketSize];
  (*scene)->shade(rays, hits, 0.001f, colours);
  return 0;
}
