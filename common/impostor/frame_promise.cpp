// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/frame_promise.h"

#include <algorithm>
#include <cmath>

#include "common/impostor/simplify_mesh.h"
#include "common/math/cube_face.h"

namespace farfield {
namespace {

constexpr double kStandardNormal99 = 2.3263478740408408;  // its 99th percentile, of kConfidence

double psnr_of(double mse) { return mse > 0 ? std::min(100.0, 10 * std::log10(255.0 * 255.0 / mse)) : 100.0; }

// Places on a tile that stand for all of it.
constexpr int kPlaces = 4;

}  // namespace

double poisson_upper_bound(double count, double confidence) {
  // P(N <= count; mean) falls with the mean: bisect.
  const auto chance = [count](double mean) {
    double term = std::exp(-mean), sum = term;
    for (int k = 1; k <= count; ++k) sum += term *= mean / k;
    return sum;
  };
  // Beyond some hundreds exp(-mean) leaves the range of doubles, and the normal approximation is exact to three digits.
  if (count > 300) return count + 1 + kStandardNormal99 * std::sqrt(count + 1);
  double low = count, high = count + 10 + 6 * std::sqrt(count + 1);
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (chance(middle) > 1 - confidence ? low : high) = middle;
  }
  return high;
}

PromiseSum::PromiseSum(const PromisedView& view, const PromiseSlack& slack)
    : view_(view), slack_(slack), camera_from_world_(glm::transpose(glm::dmat3(glm::mat3_cast(view.eye.world_from_camera)))) {}

void PromiseSum::add(const CertifiedTile& tile) {
  const Certificate& c = tile.certificate;
  if (c.void_rays > 0) shells_.emplace(tile.id.cell, c);
  if (tile.edge_samples < 4) return;
  const int samples = tile.id.is_delta() ? kRegionSamples : kTileSamples, step = tile.id.is_delta() ? kRegionSamples : kTileStride;
  const double pixel = view_.display.pixel_pitch(), pitch = sample_pitch(tile.edge_samples);
  const glm::dvec2 reach = 0.5 * pixel * glm::dvec2(view_.display.width, view_.display.height);
  const glm::dvec3 moved = (view_.eye.position - tile.view_position) / tile.side_m;
  const double moved_p99 = (c.disparity_p99 < 0 ? tile.tolerance : c.disparity_p99) + (view_.is_mesh ? kWorstOverTolerance * tile.tolerance : 0);
  const auto is_inside = [&](const glm::dvec3& seen) {
    return seen.z < 0 && std::abs(seen.x) <= -seen.z * reach.x && std::abs(seen.y) <= -seen.z * reach.y;
  };
  double weight = 0;
  for (int k = 0; k < kPlaces * kPlaces; ++k) {
    const double u = sample_tangent(tile.edge_samples, tile.id.x * step + (k % kPlaces + 0.5) / kPlaces * samples);
    const double v = sample_tangent(tile.edge_samples, tile.id.y * step + (k / kPlaces + 0.5) / kPlaces * samples);
    const glm::dvec3 direction = CubeFace::of(tile.id.face).direction(u, v);
    if (const glm::dvec3 seen = camera_from_world_ * direction; is_inside(seen)) {
      // Samples here, in pixels of the frame: by solid angle, which shrinks with the cube of the cosine in both.
      const double length = glm::length(direction), cosine = -seen.z / length;
      weight += tile.covered_samples / double{kPlaces * kPlaces} * pitch * pitch / (length * length * length) / (pixel * pixel * cosine * cosine * cosine);
    }
    if (c.disparity_p99 < 0 && !(tile.tolerance > 0)) continue;
    // A sample of disparity d is seen in direction D = direction - moved·d and turns by |moved x direction|/|D|² radians per
    // unit of disparity (common/cells/sampling.h). Nothing of a shell is nearer than kappa sides.
    const double turn = moved_p99 * glm::length(glm::cross(moved, direction));
    for (const double disparity : {0.0, 0.5 / view_.kappa, 1 / view_.kappa}) {
      const glm::dvec3 seen = camera_from_world_ * (direction - moved * disparity);
      if (is_inside(seen)) warp_px_ = std::max(warp_px_, turn / (seen.z * seen.z) / pixel);  // |D|² times the cosine's square
    }
  }
  const int kind = view_.samples_per_pixel == 4 ? 1 : 0;
  if (c.colour_mse[kind] >= 0 && weight > 0) colours_.push_back({weight, c.colour_mse[kind], std::max(0.0f, c.colour_mse_error[kind])});
}

FramePromise PromiseSum::promise() const {
  FramePromise result;
  double share = 0, hits = 0, fewest_rays = std::numeric_limits<double>::infinity();
  for (const auto& [cell, c] : shells_) {
    share += c.void_share(), hits += c.void_hits;
    fewest_rays = std::min(fewest_rays, static_cast<double>(c.void_rays));
  }
  if (!shells_.empty()) {
    const double bound = share + (poisson_upper_bound(hits, kConfidence) - hits) / fewest_rays;
    result.expected_void_share = share;
    result.void_share = std::min(1.0, slack_.void_factor * bound + slack_.void_per_pitch * view_.display.pixel_pitch());
  }
  if (!colours_.empty()) {
    double weights = 0, mse = 0, variance = 0;
    for (const MeasuredColour& c : colours_) weights += c.weight, mse += c.weight * c.mse;
    mse /= weights;
    for (const MeasuredColour& c : colours_) variance += c.weight * c.weight / (weights * weights) * c.error * c.error;
    // Shares of voids are of all directions, and lie in the part of the frame that shows impostors.
    const double part = std::min(1.0, weights / (static_cast<double>(view_.display.width) * view_.display.height));
    const auto in_part = [part](double of_frame) { return std::min(1.0, of_frame / part); };
    result.expected_psnr_db = psnr_of(mse + in_part(share) * slack_.void_mse);
    // Counts are nearly Poisson: their variance is their mean. The two errors are independent.
    const double factor = std::pow(10.0, 0.1 * slack_.colour_db), void_error = slack_.void_factor * std::sqrt(hits) / fewest_rays;
    const double error = std::hypot(factor * std::sqrt(variance), in_part(void_error) * slack_.void_mse);
    result.psnr_db = psnr_of(factor * mse + in_part(slack_.void_factor * share) * slack_.void_mse + kStandardNormal99 * error);
  }
  if (warp_px_ >= 0) result.warp_px = slack_.warp_factor * warp_px_;
  return result;
}

}  // namespace farfield
