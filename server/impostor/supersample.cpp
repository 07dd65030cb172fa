// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/supersample.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "common/shading/shading.h"

namespace farfield {
namespace {

// At the centres of a sample's quarters. Farther out, as in a rotated grid, rooms lose 0.5 dB: the warp interpolates between
// samples, which smooths them once more.
constexpr int kRays = 4;
constexpr double kAcross[kRays] = {-0.25, 0.25, -0.25, 0.25}, kDown[kRays] = {-0.25, -0.25, 0.25, 0.25};
constexpr int kTogether = kPacketSize / kRays;

// Of 256 levels: colours closer than this count as the same. Half as much gains 0.02 dB in a plant.
constexpr int kSameColour = 12;

// Marks covered samples that end towards the next, or differ from it: `step` further in the tile's arrays, beyond the `cuts`.
void mark_unlike(const SampleArrays& samples, const std::vector<std::uint8_t>& cuts, std::size_t step, std::vector<std::uint8_t>& marks) {
  constexpr std::size_t kAtOnce = 32;  // side by side in registers: results that nothing read can overlap with
  const auto mark_some = [&](std::size_t first, std::size_t count) {
    const std::uint8_t *rgb = &samples.rgb[3 * first], *covered = &samples.covered[first], *cut = &cuts[first];
    std::array<std::uint8_t, 3 * kAtOnce> differs;
    std::array<std::uint8_t, kAtOnce> is_unlike;
    for (std::size_t c = 0; c < 3 * count; ++c) {
      const std::uint8_t a = rgb[c], b = rgb[c + 3 * step];
      differs[c] = static_cast<std::uint8_t>((a > b ? a - b : b - a) > kSameColour);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const int differs_at_all = differs[3 * k] | differs[3 * k + 1] | differs[3 * k + 2];
      is_unlike[k] = static_cast<std::uint8_t>(covered[k] & (differs_at_all | (covered[k] ^ covered[k + step]) | (cut[k] != kConnected)));
    }
    for (std::size_t k = 0; k < count; ++k) marks[first + k] |= is_unlike[k];
  };
  const std::size_t end = marks.size() > step ? marks.size() - step : 0;
  std::size_t first = 0;
  for (; first + kAtOnce <= end; first += kAtOnce) mark_some(first, kAtOnce);
  if (first < end) mark_some(first, end - first);
}

class Supersampler {
 public:
  Supersampler(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const ConnectionLimits& limits,
               const TileNeighbours& neighbours, const std::vector<int>& sample_i, const std::vector<int>& sample_j,
               const Tile& tile, SampleArrays& samples)
      : scene_(scene), space_(space), frame_(frame), limits_(limits), neighbours_(neighbours), sample_i_(sample_i),
        sample_j_(sample_j), tile_(tile), samples_(samples), is_queued_(tile.samples(), 0), rgb_(samples.rgb) {}

  void run() {
    std::vector<int> wanted = disagreeing();
    while (!wanted.empty()) {
      for (const int at : wanted) samples_.refined[at] = 1;
      // In packets of neighbours; the order among equals does not change what a sample gets.
      std::sort(wanted.begin(), wanted.end(), [&](int a, int b) { return std::pair(square_of(a), a) < std::pair(square_of(b), b); });
      next_.clear();
      for (std::size_t first = 0; first < wanted.size(); first += kTogether)
        refine(&wanted[first], static_cast<int>(std::min<std::size_t>(kTogether, wanted.size() - first)));
      wanted.swap(next_);
    }
    samples_.rgb.swap(rgb_);
  }

 private:
  std::uint64_t square_of(int at) const {
    return static_cast<std::uint64_t>(sample_j_[at] / 4) << 32 | static_cast<std::uint32_t>(sample_i_[at] / 4);
  }
  bool looks_different(int a, int b) const {
    for (int c = 0; c < 3; ++c)
      if (std::abs(int{samples_.rgb[3 * static_cast<std::size_t>(a) + c]} - int{samples_.rgb[3 * static_cast<std::size_t>(b) + c]}) > kSameColour) return true;
    return false;
  }
  // Look-ups in a texture are filtered by the sample's footprint (view_frame.h): more rays would find the same.
  bool is_filtered(int a, int b) const { return samples_.part[a] == samples_.part[b] && scene_.is_textured(samples_.part[a]); }
  void queue(int at, std::vector<int>& list) {
    if (at < 0 || !tile_.coverage[at] || is_queued_[at]) return;
    is_queued_[at] = 1;
    list.push_back(at);
  }
  // Whether something ends between two neighbours, `cut` being what find_cuts() recorded.
  bool is_end(int at, int other, std::uint8_t cut) const {
    const bool here = samples_.covered[at], there = samples_.covered[other];
    return here != there || (here && cut != kConnected);
  }
  // Samples that may end towards the right or below or differ from what is there; the others, which are most, need no question.
  std::vector<std::uint8_t> unlike() const {
    std::vector<std::uint8_t> marks(tile_.samples(), 0);
    mark_unlike(samples_, tile_.cut_right, 1, marks);
    mark_unlike(samples_, tile_.cut_down, static_cast<std::size_t>(tile_.width), marks);
    if (!tile_.is_packed()) return marks;
    // Beyond the last column or row of a packed block stands another than the next in the tile's arrays.
    for (int y = 0; y < tile_.height; ++y)
      for (int x = 0; x < tile_.width; ++x)
        if ((x + 1) % kBlockSamples == 0 || (y + 1) % kBlockSamples == 0) marks[static_cast<std::size_t>(y) * tile_.width + x] = 1;
    return marks;
  }
  std::vector<int> disagreeing() {
    std::vector<int> list;
    const std::vector<std::uint8_t> marks = unlike();
    for (int at = 0; at < static_cast<int>(tile_.samples()); ++at) {
      if (!marks[at] || sample_i_[at] < 0 || !samples_.covered[at]) continue;
      const int right = neighbours_.right(at), down = neighbours_.down(at), left = neighbours_.left(at), up = neighbours_.up(at);
      const bool ends_right = right >= 0 && is_end(at, right, tile_.cut_right[at]);
      const bool ends_down = down >= 0 && is_end(at, down, tile_.cut_down[at]);
      const bool ends_left = left >= 0 && is_end(left, at, tile_.cut_right[left]);
      const bool ends_up = up >= 0 && is_end(up, at, tile_.cut_down[up]);
      // A plain outline is exact by its cuts. What ends on both sides is thin, or shows between thin things.
      if ((ends_right && ends_left) || (ends_up && ends_down))
        for (const int one : {at, left, right, up, down}) queue(one, list);
      const auto compare = [&](int other, bool ends) {
        if (other >= 0 && !ends && looks_different(at, other) && !is_filtered(at, other)) queue(at, list), queue(other, list);
      };
      compare(right, ends_right), compare(down, ends_down);
    }
    return list;
  }
  // Whether a hit (disparity d, slopes gi, gj) at (dx, dy) samples from sample `at` continues its surface.
  bool continues(int at, double dx, double dy, const SurfacePlane& hit) const {
    const float ga = static_cast<float>(samples_.gradient_i[at] * dx + samples_.gradient_j[at] * dy);
    const float gb = static_cast<float>(hit.gradient_i * dx + hit.gradient_j * dy);
    return is_connected(samples_.disparity[at], ga, hit.disparity, gb, limits_, static_cast<float>(frame_.pitch));
  }
  // Whether the tile ends the sample's surface before `distance` of the way to its neighbour, along i or j, before or after.
  bool ends_before(double distance, int at, bool is_down, bool is_after) const {
    const int other = is_down ? (is_after ? neighbours_.down(at) : neighbours_.up(at)) : (is_after ? neighbours_.right(at) : neighbours_.left(at));
    if (other < 0) return false;
    const int cut = (is_down ? tile_.cut_down : tile_.cut_right)[is_after ? at : other];
    if (cut == kConnected) return false;
    const double end = (std::min(cut, 8) - 0.5) / 8;
    return (is_after ? end : 1 - end) < distance;
  }
  bool is_shown_by_neighbour(int at, int ray) const {
    return ends_before(std::abs(kAcross[ray]), at, false, kAcross[ray] > 0) || ends_before(std::abs(kDown[ray]), at, true, kDown[ray] > 0);
  }

  void refine(const int* list, int count) {
    RayPacket rays;
    HitPacket hits;
    rays.active = count == kTogether ? 0xffffu : (1u << (kRays * count)) - 1;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const int at = list[std::min(lane / kRays, count - 1)];
      set_ray(rays, lane, frame_.position, frame_.direction(sample_i_[at] + kAcross[lane % kRays], sample_j_[at] + kDown[lane % kRays]), space_.shell);
    }
    scene_.intersect(rays, hits);
    float rgb[3 * kPacketSize];
    scene_.shade(rays, hits, 0.5f * frame_.sample_angle(sample_i_[list[0]], sample_j_[list[0]]), rgb);
    for (int k = 0; k < count; ++k) recolour(list[k], rays, hits, k * kRays, rgb);
  }
  // From the hits and radiances of lanes [first, first + kRays), those of sample `at`.
  void recolour(int at, const RayPacket& rays, const HitPacket& hits, int first, const float* rgb) {
    glm::vec3 sum(0);
    int counted = 0;
    bool is_followed = false;
    for (int lane = first; lane < first + kRays; ++lane) {
      if (hits.part[lane] == kNoHit) continue;
      const SurfacePlane plane = plane_at(frame_, rays, hits, lane);
      const bool is_own = continues(at, kAcross[lane % kRays], kDown[lane % kRays], plane);
      if (!is_own && is_shown_by_neighbour(at, lane % kRays)) continue;
      const glm::vec3 radiance(rgb[3 * lane], rgb[3 * lane + 1], rgb[3 * lane + 2]);
      sum += radiance;
      ++counted;
      is_followed = is_followed || (!is_own && plane.disparity > samples_.disparity[at]) || (!scene_.is_textured(hits.part[lane]) && differs_from(at, radiance));
    }
    if (counted > 0)
      for (int c = 0; c < 3; ++c) rgb_[3 * static_cast<std::size_t>(at) + c] = linear_to_srgb(sum[c] / static_cast<float>(counted));
    if (!is_followed) return;
    for (const int beside : {neighbours_.left(at), neighbours_.right(at), neighbours_.up(at), neighbours_.down(at)}) queue(beside, next_);
  }
  bool differs_from(int at, const glm::vec3& radiance) const {
    for (int c = 0; c < 3; ++c)
      if (std::abs(int{linear_to_srgb(radiance[c])} - int{samples_.rgb[3 * static_cast<std::size_t>(at) + c]}) > kSameColour) return true;
    return false;
  }

  const Scene& scene_;
  const CellSpace& space_;
  const ViewFrame& frame_;
  const ConnectionLimits& limits_;
  const TileNeighbours& neighbours_;
  const std::vector<int>& sample_i_;
  const std::vector<int>& sample_j_;
  const Tile& tile_;
  SampleArrays& samples_;
  std::vector<std::uint8_t> is_queued_;
  std::vector<std::uint8_t> rgb_;  // the new colours: what looks different is asked of the old ones
  std::vector<int> next_;
};

}  // namespace

void supersample_colours(const Scene& scene, const CellSpace& space, const ViewFrame& frame,
                         const ConnectionLimits& limits, const TileNeighbours& neighbours,
                         const std::vector<int>& sample_i, const std::vector<int>& sample_j, const Tile& tile,
                         SampleArrays& samples) {
  Supersampler(scene, space, frame, limits, neighbours, sample_i, sample_j, tile, samples).run();
}

}  // namespace farfield
