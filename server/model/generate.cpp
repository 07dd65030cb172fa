// SPDX-License-Identifier: Apache-2.0
#include "server/model/generate.h"

#include <algorithm>
#include <cmath>

#include "server/model/generators.h"
#include "server/model/random_stream.h"

namespace farfield {
namespace {

constexpr std::size_t kLeastTriangles = 1'000;
constexpr std::size_t kMostTriangles = 50'000'000;

}  // namespace

void fill_with_boxes(ModelBuilder& builder, const Paint& paint, const glm::vec3& low, const glm::vec3& high,
                     std::uint64_t seed) {
  constexpr std::size_t kChamferedTriangles = 44, kPlainTriangles = 12;
  RandomStream random(seed, 99);
  // On a grid, so that boxes never overlap, however many are needed.
  const std::size_t count = builder.remaining() / kChamferedTriangles + 4;
  const glm::vec3 extent = high - low;
  const float area_each = extent.x * extent.z / static_cast<float>(count);
  const float pitch = 0.9f * std::sqrt(area_each);
  const int columns = std::max(1, static_cast<int>(extent.x / pitch));
  for (int k = 0; builder.remaining() >= kPlainTriangles; ++k) {
    const float half = 0.5f * std::min(0.5f, pitch) * random.between(0.5f, 0.9f);
    const glm::vec3 at = low + glm::vec3((0.5f + static_cast<float>(k % columns)) * pitch, 0,
                                         (0.5f + static_cast<float>(k / columns)) * pitch);
    const Frame frame = Frame::at(at, random.between(-0.3f, 0.3f));
    if (builder.remaining() >= kChamferedTriangles) {
      add_chamfered_box(builder, paint, frame, {-half, 0, -half}, {half, 1.6f * half, half}, 0.08f * half);
    } else {
      add_box(builder, paint, frame, {-half, 0, -half}, {half, 1.6f * half, half});
    }
  }
}

Result<Model> generate_model(std::string_view kind, std::size_t triangles, std::uint64_t seed) {
  if (kind != "pipes" && kind != "city" && kind != "statues" && kind != "house") {
    return fail(ErrorCode::kInvalidArgument, "unknown kind of generated scene \"{}\": use pipes, city, statues or house",
                kind);
  }
  if (triangles < kLeastTriangles || triangles > kMostTriangles) {
    return fail(ErrorCode::kInvalidArgument, "generated scene of {} triangles: ask for {} to {}", triangles,
                kLeastTriangles, kMostTriangles);
  }
  if (kind == "pipes") return generate_pipes(triangles, seed);
  if (kind == "city") return generate_city(triangles, seed);
  if (kind == "statues") return generate_statues(triangles, seed);
  return generate_house(triangles, seed);
}

}  // namespace farfield
