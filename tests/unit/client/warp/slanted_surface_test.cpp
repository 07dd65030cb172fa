// SPDX-License-Identifier: Apache-2.0
// Splats of slanted surfaces: closed wherever the surface is connected, no larger than it at its border.
#include <gtest/gtest.h>

#include "client/warp/cpu_warper.h"
#include "tests/unit/client/warp/warp_scene.h"

namespace farfield::client {
namespace {

constexpr int kSamples = 256;  // of a face's edge
constexpr int kPatch = 96;     // samples of the patch, from sample kFirst on
constexpr int kFirst = 80;

/// A patch of the plane normal·x = -1 (metres), which a view at the origin sees on the face towards -z.
std::shared_ptr<DecodedTile> plane_patch(const glm::dvec3& normal, std::uint16_t border_reach = kReachToNothing) {
  auto tile = std::make_shared<DecodedTile>();
  tile->side_m = 1.0;
  Splats& s = tile->splats;
  s.face = kMinusZ;
  s.pitch = static_cast<float>(sample_pitch(kSamples));
  // On the face u is along x and v along y: the point (u, v, -1)/d, so d = -(normal·(u, v, -1)).
  const auto tangent = [](int k) { return sample_tangent(kSamples, kFirst + k); };
  for (int j = 0; j < kPatch; ++j) {
    s.runs.push_back({static_cast<float>(tangent(0)), static_cast<float>(tangent(j)),
                      static_cast<std::uint32_t>(s.disparity.size()), kPatch});
    for (int i = 0; i < kPatch; ++i) {
      s.disparity.push_back(static_cast<float>(normal.z - normal.x * tangent(i) - normal.y * tangent(j)));
      s.colour.push_back(0x406080u);
    }
  }
  connect_grid(s, kPatch, kPatch);
  for (auto& reach : s.reach) {
    for (int shift = 0; shift < 16; shift += 4) {
      if ((reach >> shift & 15) == kReachToNothing) reach = static_cast<std::uint16_t>((reach & ~(15 << shift)) | border_reach << shift);
    }
  }
  const auto [low, high] = std::minmax_element(s.disparity.begin(), s.disparity.end());
  s.min_disparity = *low, s.max_disparity = *high;
  s.u_min = s.v_min = static_cast<float>(tangent(0));
  s.u_max = s.v_max = static_cast<float>(tangent(kPatch - 1));
  s.blocks = find_blocks(s);
  return tile;
}

struct Covered {
  int inside = 0, holes = 0, outside = 0, closed = 0;
};

/// Compares coverage with the plane itself. `extent`: how far the surface reaches beyond its outermost samples, samples.
/// Pixels nearer than `slack` samples to the border count as neither inside nor outside.
Covered compare(const glm::dvec3& normal, const Pose& eye, const Display& display, const Frame& frame, double extent,
                double slack) {
  Covered result;
  for (int y = 0; y < display.height; ++y) {
    for (int x = 0; x < display.width; ++x) {
      const Coverage coverage = frame.coverage[static_cast<std::size_t>(y) * display.width + x];
      result.closed += coverage == Coverage::kCrackClosed;
      const glm::dvec3 ray = eye.world_from_camera * camera_direction(display, x + 0.5, y + 0.5);
      const double along = -(1.0 + glm::dot(normal, eye.position)) / glm::dot(normal, ray);
      const glm::dvec3 point = eye.position + along * ray;
      double beyond = 1e9;  // how far outside the border, samples
      if (along > 0 && point.z < 0) {
        const double i = sample_index(kSamples, -point.x / point.z) - kFirst;
        const double j = sample_index(kSamples, -point.y / point.z) - kFirst;
        beyond = std::max({-i, i - (kPatch - 1), -j, j - (kPatch - 1)}) - extent;
      }
      const bool is_covered = coverage == Coverage::kImpostor;
      if (beyond < -slack) {
        ++result.inside;
        result.holes += !is_covered;
      } else if (beyond > slack) {
        result.outside += is_covered;
      }
    }
  }
  return result;
}

Pose looking(const glm::dvec3& position, double yaw, double pitch, double roll) {
  return {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0)) *
                        glm::angleAxis(roll, glm::dvec3(0, 0, 1))};
}

/// Corners of the cell, from which surfaces at the border of the near region (disparity 0.4) are warped most.
std::vector<Pose> eyes() {
  std::vector<Pose> result;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 position(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
    for (const double roll : {0.0, 0.4, 0.785}) result.push_back(looking(position, -0.1, 0.05, roll));
  }
  return result;
}
const std::vector<glm::dvec3> kNormals = {{0, 0, 0.4}, {0.5, 0, 0.25}, {0.1, -0.55, 0.3}, {-0.4, 0.4, 0.35}};

TEST(SlantedSurface, AConnectedPlaneShowsNoUncoveredPixel) {
  for (const double magnified : {1.0, 2.0}) {
    const Display display = display_on_samples(static_cast<int>(kSamples * magnified), 200, 160);
    for (const glm::dvec3& normal : kNormals) {
      const auto tile = plane_patch(normal);
      int inside = 0;
      for (const Pose& eye : eyes()) {
        Frame frame;
        CpuWarper().draw(leaf_of({tile}), eye, display, nullptr, frame);
        const Covered covered = compare(normal, eye, display, frame, 0.0, 0.0);
        ASSERT_EQ(covered.holes, 0) << normal.x << " " << normal.y << " eye " << eye.position.x << " " << eye.position.y
                                    << " " << eye.position.z << " magnified " << magnified;
        inside += covered.inside;
      }
      EXPECT_GT(inside, 20000);
    }
  }
}

TEST(SlantedSurface, SilhouettesEndWhereTheSurfaceIsCut) {
  // 1, 8 and 15 sixteenths of a sample beyond the outermost samples; an eighth of a sample is allowed for the footprint
  // being affine where the warp is projective.
  const Display display = display_on_samples(2 * kSamples, 200, 160);
  for (const int reach : {1, 8, 15}) {
    for (const glm::dvec3& normal : kNormals) {
      const auto tile = plane_patch(normal, static_cast<std::uint16_t>(reach));
      for (const Pose& eye : eyes()) {
        Frame frame;
        CpuWarper().draw(leaf_of({tile}), eye, display, nullptr, frame);
        const Covered covered = compare(normal, eye, display, frame, reach / 16.0, 0.125);
        ASSERT_EQ(covered.outside, 0) << reach << " " << normal.x << " " << normal.y;
        ASSERT_EQ(covered.holes, 0) << reach << " " << normal.x << " " << normal.y;
      }
    }
  }
}

}  // namespace
}  // namespace farfield::client
