// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/connectivity.h"

#include <algorithm>
#include <cmath>

namespace farfield {
namespace {

// A connection to place: from sample `first` one step along i or j to `second`.
struct Edge {
  int first, second;
  bool is_down;
  std::uint64_t square;  // of the face, in raster order
};

std::uint64_t square_of(int i, int j) {
  constexpr int kSquare = 8;
  return static_cast<std::uint64_t>(j / kSquare) << 32 | static_cast<std::uint32_t>(i / kSquare);
}

// Edges of a sample to the right and downwards.
constexpr std::uint8_t kRight = 1, kDown = 2, kBoth = kRight | kDown;

// Edges that need no further question, as most: both ends lie on each other's planes, or neither is covered. `step`: from a
// sample to the next in the tile's arrays; sets `edge` in settled[first sample].
void settle(const SampleArrays& samples, const std::vector<float>& gradient, const std::vector<std::uint8_t>& coverage, std::size_t step,
            float one_sample, std::uint8_t edge, std::vector<std::uint8_t>& settled) {
  constexpr std::size_t kTogether = 16;
  const auto settle_some = [&](std::size_t first, std::size_t count) {
    const float *a = &samples.disparity[first], *b = a + step, *ga = &gradient[first], *gb = ga + step;
    const std::uint8_t *covered_a = &coverage[first], *covered_b = covered_a + step;
    std::int32_t is_settled[kTogether];
    for (std::size_t k = 0; k < count; ++k) {
      const int is_flat = (std::abs(a[k] + ga[k] - b[k]) <= one_sample) & (std::abs(b[k] - gb[k] - a[k]) <= one_sample);
      is_settled[k] = (covered_a[k] & covered_b[k] & is_flat) | ((covered_a[k] | covered_b[k]) ^ 1);
    }
    for (std::size_t k = 0; k < count; ++k) settled[first + k] |= static_cast<std::uint8_t>(is_settled[k] * edge);
  };
  const std::size_t end = settled.size() > step ? settled.size() - step : 0;
  std::size_t first = 0;
  for (; first + kTogether <= end; first += kTogether) settle_some(first, kTogether);
  if (first < end) settle_some(first, end - first);
}

// What lies beyond the last column or row of a dense tile or of a packed block is not the next in the tile's arrays.
void open_borders(const Tile& tile, std::vector<std::uint8_t>& settled) {
  const int size = tile.is_packed() ? kBlockSamples : 0;
  for (int y = 0; y < tile.height; ++y) {
    std::uint8_t* row = &settled[static_cast<std::size_t>(y) * tile.width];
    for (int x = size - 1; size > 0 && x < tile.width; x += size) row[x] &= static_cast<std::uint8_t>(~kRight);
    if (size > 0 && (y + 1) % size == 0)
      for (int x = 0; x < tile.width; ++x) row[x] &= static_cast<std::uint8_t>(~kDown);
    if (size == 0) row[tile.width - 1] |= kRight;
    if (size == 0 && y + 1 == tile.height)
      for (int x = 0; x < tile.width; ++x) row[x] |= kDown;
  }
}

// The disparities that stand for the two ends of an edge, `at` of the way along it: each one's plane there, and, as curved
// surfaces leave their planes near a silhouette, its own.
struct Ends {
  float first_low, first_high, second_low, second_high;

  // Requires: both are covered.
  Ends(const Edge& edge, const SampleArrays& s, float at) {
    const std::vector<float>& gradient = edge.is_down ? s.gradient_j : s.gradient_i;
    const float first = s.disparity[edge.first], on_first = first + gradient[edge.first] * at;
    const float second = s.disparity[edge.second], on_second = second - gradient[edge.second] * (1 - at);
    first_low = std::min(first, on_first), first_high = std::max(first, on_first);
    second_low = std::min(second, on_second), second_high = std::max(second, on_second);
  }
  // Below which disparity everything belongs to the farther end, 0 if the two are not apart.
  float farther_below() const {
    if (first_low > second_high) return 0.5f * (first_low + second_high);
    return second_low > first_high ? 0.5f * (second_low + first_high) : 0.0f;
  }
  bool is_first_closer_to(float disparity) const {
    const float from_first = std::min(std::abs(first_low - disparity), std::abs(first_high - disparity));
    const float from_second = std::min(std::abs(second_low - disparity), std::abs(second_high - disparity));
    return from_first <= from_second;
  }
};

// Which end a ray between the two samples saw: that whose surface is closer to the hit, or the covered end if only one is.
bool sees_first(const Edge& edge, const SampleArrays& s, float at, bool hit, float disparity) {
  const bool first = s.covered[edge.first], second = s.covered[edge.second];
  if (!first || !second) return hit == first;
  if (!hit) return s.disparity[edge.first] < s.disparity[edge.second];  // past the nearer one: the farther, if it has not ended
  return Ends(edge, s, at).is_first_closer_to(disparity);
}

// A strip between two surfaces that opens to no more samples than this at the cell's worst viewpoint is bridged. Wider ones
// are left to another view, which may hold them as they are.
constexpr float kWidestBridge = 4.0f;

// Whether what a ray met `at` of the way is a surface that both ends border on, a sill or a step seen so obliquely that no
// sample meets it: its plane cuts the first's before, and the second's after. `gradient` of that plane along the edge.
// Requires: both are covered.
bool bridges(const Edge& edge, const SampleArrays& s, float disparity, float gradient, float at, const ConnectionLimits& limits) {
  const std::vector<float>& gradients = edge.is_down ? s.gradient_j : s.gradient_i;
  const float first = s.disparity[edge.first], second = s.disparity[edge.second];
  if (std::abs(first - second) > kWidestBridge * limits.one_sample) return false;
  const float at_start = disparity - gradient * at, second_at_start = second - gradients[edge.second];
  const float begins = (first - at_start) / (gradient - gradients[edge.first]);
  const float ends = (second_at_start - at_start) / (gradient - gradients[edge.second]);
  return begins >= 0 && begins <= at && ends >= at && ends <= 1;  // false for planes that do not meet: not a number, or infinite
}

// How much further a surface is drawn where it runs on beyond the shell's border, in eighths of a sample: outlines are
// placed to half an eighth and simplified by up to kOutlineSamples, and nothing may show between two shells.
constexpr int kBorderOverlap = 2;

// Whether the surface at one end of an edge runs on beyond the shell's border: its plane, `at` of the way, is outside.
bool crosses_border(const RayClip& shell, const ViewFrame& frame, const SampleArrays& s, const Edge& edge, bool is_first,
                    double at, int i, int j) {
  const int end = is_first ? edge.first : edge.second;
  if (!s.covered[end]) return false;
  const double gradient = (edge.is_down ? s.gradient_j : s.gradient_i)[end];
  const double disparity = s.disparity[end] + gradient * (is_first ? at : at - 1);
  if (!(disparity > 0)) return false;
  const glm::dvec3 direction = frame.direction(i + (edge.is_down ? 0 : at), j + (edge.is_down ? at : 0));
  const glm::dvec3 point = frame.position + direction * (frame.side_m / disparity);
  return !shell.outside.contains(point) || (!shell.inside.is_empty() && shell.inside.contains(point));
}

// Three rays per edge halve the interval three times: the eighth in which the first surface ends. Where one of them meets
// a bridge, the edge stays connected.
void bisect(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const SampleArrays& samples,
            const ConnectionLimits& limits, const std::vector<Edge>& edges, const std::vector<int>& sample_i, const std::vector<int>& sample_j, Tile& tile) {
  RayPacket rays;
  HitPacket hits;
  for (std::size_t base = 0; base < edges.size(); base += kPacketSize) {
    const int count = static_cast<int>(std::min<std::size_t>(kPacketSize, edges.size() - base));
    int low[kPacketSize] = {};
    bool is_bridged[kPacketSize] = {};
    for (int step = 4; step >= 1; step /= 2) {
      rays.active = count == kPacketSize ? 0xffffu : (1u << count) - 1;
      for (int lane = 0; lane < count; ++lane) {
        const Edge& edge = edges[base + lane];
        const double at = (low[lane] + step) / 8.0;
        set_ray(rays, lane, frame.position,
                frame.direction(sample_i[edge.first] + (edge.is_down ? 0 : at), sample_j[edge.first] + (edge.is_down ? at : 0)),
                space.shell);
        if (!samples.covered[edge.first] || !samples.covered[edge.second]) continue;
        // What lies too deep to change the answer need not be found.
        const float farther_below = Ends(edge, samples, static_cast<float>(at)).farther_below();
        if (farther_below > 0) rays.far[lane] = std::min(rays.far[lane], static_cast<float>(frame.side_m) / farther_below);
      }
      scene.intersect(rays, hits);
      for (int lane = 0; lane < count; ++lane) {
        const bool hit = hits.part[lane] != kNoHit;
        const float disparity = hit ? static_cast<float>(frame.side_m / hits.distance[lane]) : 0.0f;
        const float at = static_cast<float>(low[lane] + step) / 8.0f;
        const Edge& edge = edges[base + lane];
        if (hit && samples.covered[edge.first] && samples.covered[edge.second]) {
          const SurfacePlane plane = plane_at(frame, rays, hits, lane);
          is_bridged[lane] |= bridges(edge, samples, disparity, edge.is_down ? plane.gradient_j : plane.gradient_i, at, limits);
        }
        if (sees_first(edge, samples, at, hit, disparity)) low[lane] += step;
      }
    }
    for (int lane = 0; lane < count; ++lane) {
      if (is_bridged[lane]) continue;
      const Edge& edge = edges[base + lane];
      int cut = low[lane] + 1;
      const auto crosses = [&](bool is_first, int eighth) {
        return crosses_border(space.shell, frame, samples, edge, is_first, eighth / 8.0, sample_i[edge.first],
                              sample_j[edge.first]);
      };
      const int overlap = (crosses(true, low[lane] + 1) ? kBorderOverlap : 0) - (crosses(false, low[lane]) ? kBorderOverlap : 0);
      cut = std::clamp(cut + overlap, 1, 8);
      (edge.is_down ? tile.cut_down : tile.cut_right)[edge.first] = static_cast<std::uint8_t>(cut);
    }
  }
}

}  // namespace

ConnectionLimits connection_limits(const ViewFrame& frame, double warp_gain) {
  // Wilson & Manocha's threshold angle: 25 degrees between a connection and the line of sight.
  constexpr double kCotangent = 2.14;
  return {static_cast<float>(frame.pitch / warp_gain), static_cast<float>(kCotangent)};
}

bool is_connected(float a, float ga, float b, float gb, const ConnectionLimits& limits, float pitch) {
  const float error_at_b = a + ga - b, error_at_a = b - gb - a;
  if (std::abs(error_at_b) <= limits.one_sample && std::abs(error_at_a) <= limits.one_sample) return true;
  // Planes a + ga·s and b - gb·(1 - s) meet at s.
  const float slope = ga - gb, s = (b - gb - a) / slope;
  if (std::isfinite(s) && s >= 0 && s <= 1) return true;
  // Test 2: z = 1/d; |Δz| against the footprint z·pitch: |a - b|/min(a, b) against pitch.
  return std::abs(a - b) <= limits.angle_slope * pitch * std::min(a, b);
}

void find_cuts(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const SampleArrays& samples,
               const ConnectionLimits& limits, const TileNeighbours& neighbours, const std::vector<int>& sample_i,
               const std::vector<int>& sample_j, Tile& tile) {
  std::vector<Edge> edges;
  const float pitch = static_cast<float>(frame.pitch);
  tile.cut_right.assign(tile.samples(), kConnected), tile.cut_down.assign(tile.samples(), kConnected);
  const auto classify = [&](int first, int second, bool is_down) {
    std::vector<std::uint8_t>& cuts = is_down ? tile.cut_down : tile.cut_right;
    if (second < 0 || (!tile.coverage[first] && !tile.coverage[second])) return;
    const std::vector<float>& gradient = is_down ? samples.gradient_j : samples.gradient_i;
    const bool connected = samples.covered[first] && samples.covered[second] &&
                           is_connected(samples.disparity[first], gradient[first], samples.disparity[second], gradient[second], limits, pitch);
    if (!samples.known[first] || !samples.known[second]) {
      cuts[first] = tile.coverage[first] ? 8 : 1;  // the other end was left out because nobody can see it
    } else if (!connected) {
      edges.push_back({first, second, is_down, square_of(sample_i[first], sample_j[first])});
    } else if (!tile.coverage[first] || !tile.coverage[second]) {
      cuts[first] = tile.coverage[first] ? 8 : 1;  // the other end is held by another view
    }
  };
  std::vector<std::uint8_t> settled(tile.samples(), 0);
  settle(samples, samples.gradient_i, tile.coverage, 1, limits.one_sample, kRight, settled);
  settle(samples, samples.gradient_j, tile.coverage, static_cast<std::size_t>(tile.width), limits.one_sample, kDown, settled);
  open_borders(tile, settled);
  const auto is_open = [](std::uint8_t edges_settled) { return edges_settled != kBoth; };
  for (auto at = std::find_if(settled.begin(), settled.end(), is_open); at != settled.end(); at = std::find_if(at + 1, settled.end(), is_open)) {
    const int index = static_cast<int>(at - settled.begin());
    if (sample_i[index] < 0) continue;
    if (!(*at & kRight)) classify(index, neighbours.right(index), false);
    if (!(*at & kDown)) classify(index, neighbours.down(index), true);
  }
  // In packets of neighbours: rays row by row would be 16 samples apart.
  std::stable_sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return a.square < b.square; });
  bisect(scene, space, frame, samples, limits, edges, sample_i, sample_j, tile);
}

}  // namespace farfield
