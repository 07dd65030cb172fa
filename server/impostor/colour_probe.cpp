// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/colour_probe.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/impostor/tile_neighbours.h"
#include "common/shading/shading.h"
#include "server/model/random_stream.h"

namespace farfield {
namespace {

std::vector<int> covered_samples(const Tile& tile) {
  std::vector<int> covered;
  for (std::size_t at = 0; at < tile.samples(); ++at)
    if (tile.coverage[at]) covered.push_back(static_cast<int>(at));
  return covered;
}

// Place of a sample on its face.
glm::dvec2 place_of(const Tile& tile, int at) {
  const int x = at % tile.width, y = at / tile.width;
  if (!tile.is_packed()) return {tile.id.x * kTileStride + x, tile.id.y * kTileStride + y};
  const BlockPlace& block = tile.blocks[static_cast<std::size_t>(y / kBlockSamples * kPackedColumns + x / kBlockSamples)];
  return {block.x * kBlockSamples + x % kBlockSamples, block.y * kBlockSamples + y % kBlockSamples};
}

// The sample `steps` beside another, if the tile holds it.
int sample_beside(const Tile& tile, const TileNeighbours& neighbours, int at, const glm::ivec2& steps) {
  for (int x = steps.x; at >= 0 && x != 0; x += x > 0 ? -1 : 1) at = x > 0 ? neighbours.right(at) : neighbours.left(at);
  for (int y = steps.y; at >= 0 && y != 0; y += y > 0 ? -1 : 1) at = y > 0 ? neighbours.down(at) : neighbours.up(at);
  return at >= 0 && tile.coverage[static_cast<std::size_t>(at)] ? at : -1;
}

glm::vec3 linear_colour(const std::vector<std::uint8_t>& colours, int at) {
  const std::uint8_t* rgb = &colours[3 * static_cast<std::size_t>(at)];
  return {srgb_to_linear(rgb[0]), srgb_to_linear(rgb[1]), srgb_to_linear(rgb[2])};
}

double squared_difference(const std::uint8_t* truth, const std::uint8_t* shown) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += (truth[c] - shown[c]) * (truth[c] - shown[c]);
  return sum / 3;
}

// The 99th percentile of how far covered samples' disparities moved. Sorting all of them would take longer than probing: only those
// of the bin that holds it are.
float p99_of_change(const Tile& exact, const std::vector<float>& decoded) {
  constexpr int kBins = 256;
  std::vector<float> moved(exact.samples());
  float most = 0;
  for (std::size_t at = 0; at < moved.size(); ++at) {
    moved[at] = exact.coverage[at] ? std::abs(decoded[at] - exact.disparity[at]) : -1.0f;
    most = std::max(most, moved[at]);
  }
  if (!(most > 0)) return 0;
  const float scale = kBins / most;
  const auto bin_of = [&](float value) { return std::min(static_cast<int>(value * scale), kBins - 1); };  // never falls as values grow
  std::array<std::size_t, kBins> counts{};
  std::size_t covered = 0;
  for (const float value : moved)
    if (value >= 0) ++counts[static_cast<std::size_t>(bin_of(value))], ++covered;
  std::size_t rank = (covered - 1) * 99 / 100;
  std::size_t bin = 0;
  while (rank >= counts[bin]) rank -= counts[bin++];
  std::vector<float> inside;
  for (const float value : moved)
    if (value >= 0 && bin_of(value) == static_cast<int>(bin)) inside.push_back(value);
  const auto p99 = inside.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(inside.begin(), p99, inside.end());
  return *p99;
}

struct Mean {
  double sum = 0, sum_of_squares = 0;
  int count = 0;
  void add(double value) { sum += value, sum_of_squares += value * value, ++count; }
  double value() const { return sum / count; }
  /// Standard error; of a single value nothing is known but itself.
  double error() const {
    if (count < 2) return value();
    return std::sqrt(std::max(0.0, sum_of_squares - sum * sum / count) / (count - 1) / count);
  }
};

}  // namespace

ColourProbes::ColourProbes(const Scene& scene, const CellSpace& space, const glm::dvec3& view, const Tile& tile, const Display& display) {
  const std::vector<int> covered = covered_samples(tile);
  if (covered.empty()) return;
  const ViewFrame frame = ViewFrame::of(space, view, tile.id.face, tile.edge_samples);
  const TileNeighbours neighbours(tile);
  const glm::u8vec3 sky8 = scene.background();
  const glm::vec3 sky(srgb_to_linear(sky8.r), srgb_to_linear(sky8.g), srgb_to_linear(sky8.b));
  const CellId& cell = tile.id.cell;
  RandomStream random(0x636f6c6f, cell.level, cell.x, cell.y, cell.z, tile.id.view, tile.id.face, tile.id.x, tile.id.y);
  const int count = std::min<int>(kProbes, static_cast<int>(covered.size()));
  for (int k = 0; k < count; ++k) {
    // Stratified: one in each of as many equal parts of what is covered.
    const int own = covered[static_cast<std::size_t>((k + random.unit()) / count * static_cast<double>(covered.size()))];
    const glm::dvec2 offset(random.unit() - 0.5, random.unit() - 0.5), centre = place_of(tile, own) + offset;
    // A pixel's angle there, as tangents of the face: its solid angle is the display's whatever the direction.
    const double u = frame.u(centre.x), v = frame.u(centre.y);
    const double pixel = display.pixel_pitch() * std::pow(1 + u * u + v * v, 0.75), pixel_samples = pixel / frame.pitch;
    RayPacket rays;
    HitPacket hits;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const glm::dvec2 at = centre + glm::dvec2((lane % 4 - 1.5) / 4, (lane / 4 - 1.5) / 4) * pixel_samples;
      set_ray(rays, lane, view, frame.direction(at.x, at.y), RayClip{.inside = space.shell.inside});
    }
    scene.intersect(rays, hits);
    float rgb[3 * kPacketSize];
    scene.shade(rays, hits, static_cast<float>(display.pixel_pitch() / 4), rgb);
    Probe probe{.truth = {}, .sample = own, .quarters = {}};
    glm::vec3 sum(0);
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const bool is_hit = hits.part[lane] != kNoHit;
      const glm::vec3 colour = is_hit ? glm::vec3(rgb[3 * lane], rgb[3 * lane + 1], rgb[3 * lane + 2]) : sky;
      sum += colour;
      if (is_hit && space.contains(hit_point(rays, hits, lane))) continue;
      Quarter& quarter = probe.quarters[lane % 4 / 2 + lane / 8 * 2];
      quarter.beside += colour, ++quarter.rays_beside;
    }
    for (int q = 0; q < 4; ++q) {
      const glm::dvec2 at = offset + glm::dvec2((q % 2 - 0.5) / 2, (q / 2 - 0.5) / 2) * pixel_samples;
      probe.quarters[q].sample = sample_beside(tile, neighbours, own, glm::ivec2(glm::round(at)));
    }
    for (int c = 0; c < 3; ++c) probe.truth[c] = linear_to_srgb(sum[c] / kPacketSize);
    probes_.push_back(probe);
  }
}

void ColourProbes::measure(const Tile& exact, const CodedSamples& decoded, Certificate& certificate) const {
  if (probes_.empty()) return;
  Mean means[2];
  for (const Probe& probe : probes_) {
    means[0].add(squared_difference(probe.truth, &decoded.rgb[3 * static_cast<std::size_t>(probe.sample)]));
    glm::vec3 sum(0);
    for (const Quarter& quarter : probe.quarters) {
      const bool is_other = quarter.sample < 0 && quarter.rays_beside > 0;
      sum += is_other ? quarter.beside / static_cast<float>(quarter.rays_beside) : linear_colour(decoded.rgb, quarter.sample < 0 ? probe.sample : quarter.sample);
    }
    std::uint8_t shown[3];
    for (int c = 0; c < 3; ++c) shown[c] = linear_to_srgb(sum[c] / 4);
    means[1].add(squared_difference(probe.truth, shown));
  }
  for (int k = 0; k < 2; ++k) {
    certificate.colour_mse[k] = static_cast<float>(means[k].value());
    certificate.colour_mse_error[k] = static_cast<float>(means[k].error());
  }
  certificate.disparity_p99 = p99_of_change(exact, decoded.disparity);
}

}  // namespace farfield
