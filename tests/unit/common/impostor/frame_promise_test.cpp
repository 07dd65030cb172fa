// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/frame_promise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/math/cube_face.h"

namespace farfield {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Looks along +z of the scene, at the middle of face 4.
PromisedView ahead() { return {.eye = {{0.5, 0.5, 0.5}, glm::angleAxis(kPi, glm::dvec3(0, 1, 0))}}; }

CertifiedTile tile_ahead(int level = 0) {
  CertifiedTile tile;
  tile.id = {{static_cast<std::uint8_t>(level), 0, 0, 0}, kIntraView, 4, 4, 4};
  tile.view_position = {0.5, 0.5, 0.5};
  tile.edge_samples = face_samples(9);
  tile.covered_samples = kTileSamples * kTileSamples;
  tile.certificate = {.void_rays = 40000, .void_hits = 4, .void_worst_hits = 2, .void_worst_rays = 3456, .colour_mse = {40, 20},
                      .colour_mse_error = {4, 2}, .disparity_p99 = 1e-3f};
  return tile;
}

// Of which every direction is held.
CertifiedTile whole_ahead() {
  CertifiedTile tile = tile_ahead();
  tile.certificate.void_hits = tile.certificate.void_worst_hits = 0;
  return tile;
}

FramePromise promise_of(const PromisedView& view, std::initializer_list<CertifiedTile> tiles) {
  PromiseSum sum(view);
  for (const CertifiedTile& tile : tiles) sum.add(tile);
  return sum.promise();
}

double psnr_of(double mse) { return 10 * std::log10(255 * 255 / mse); }

TEST(PoissonUpperBound, AgreesWithTables) {
  // Half the 99th percentile of chi-squared with 2(n + 1) degrees of freedom (Garwood 1936).
  EXPECT_NEAR(poisson_upper_bound(0, 0.99), 4.6052, 1e-3);
  EXPECT_NEAR(poisson_upper_bound(1, 0.99), 6.6384, 1e-3);
  EXPECT_NEAR(poisson_upper_bound(10, 0.99), 20.1447, 1e-3);
  EXPECT_NEAR(poisson_upper_bound(301, 0.99), poisson_upper_bound(300, 0.99) + 1, 3) << "the approximation joins on";
}

TEST(FramePromise, PromisesNothingWithoutCertificates) {
  const FramePromise nothing = promise_of(ahead(), {});
  EXPECT_TRUE(std::isnan(nothing.void_share) && std::isnan(nothing.psnr_db) && std::isnan(nothing.warp_px));
  CertifiedTile tile = tile_ahead();
  tile.certificate = {};
  const FramePromise unmeasured = promise_of(ahead(), {tile});
  EXPECT_TRUE(std::isnan(unmeasured.void_share) && std::isnan(unmeasured.psnr_db) && std::isnan(unmeasured.warp_px));
}

TEST(FramePromise, BoundsWhatIsExpectedWithConfidenceAndSlack) {
  const PromiseSlack slack;
  const FramePromise whole = promise_of(ahead(), {whole_ahead(), whole_ahead()});
  EXPECT_NEAR(whole.expected_psnr_db, psnr_of(40), 1e-6);
  EXPECT_NEAR(whole.psnr_db, psnr_of(40 + 2.3263 * 4 / std::sqrt(2.0)) - slack.colour_db, 1e-3);
  const FramePromise promise = promise_of(ahead(), {tile_ahead(), tile_ahead()});
  EXPECT_NEAR(promise.expected_void_share, 4.0 / 40000, 1e-9);
  EXPECT_NEAR(promise.void_share, slack.void_factor * poisson_upper_bound(4, 0.99) / 40000 + slack.void_per_pitch * Display().pixel_pitch(), 1e-9);
}

TEST(FramePromise, FourSamplesPerPixelHaveTheirOwnError) {
  PromisedView view = ahead();
  view.samples_per_pixel = 4;
  EXPECT_NEAR(promise_of(view, {whole_ahead()}).expected_psnr_db, psnr_of(20), 1e-6);
}

TEST(FramePromise, ManyTilesAreMoreCertainThanOne) {
  CertifiedTile beside = whole_ahead();
  beside.id.x = 5;
  const FramePromise one = promise_of(ahead(), {whole_ahead()}), two = promise_of(ahead(), {whole_ahead(), beside});
  EXPECT_NEAR(one.expected_psnr_db, two.expected_psnr_db, 1e-6);
  EXPECT_GT(two.psnr_db, one.psnr_db + 0.1);
}

TEST(FramePromise, HowTilesDifferIsKnownAndCostsNoCertainty) {
  CertifiedTile better = whole_ahead(), worse = whole_ahead();
  better.certificate.colour_mse[0] = 20, worse.certificate.colour_mse[0] = 60;
  const FramePromise same = promise_of(ahead(), {whole_ahead(), whole_ahead()}), different = promise_of(ahead(), {better, worse});
  EXPECT_NEAR(same.expected_psnr_db, different.expected_psnr_db, 1e-6);
  EXPECT_NEAR(same.psnr_db, different.psnr_db, 1e-6);
  worse.certificate.colour_mse_error[0] = 12;
  EXPECT_LT(promise_of(ahead(), {better, worse}).psnr_db, different.psnr_db - 0.5) << "what within a tile is not";
}

TEST(FramePromise, WhatNoViewHoldsCountsAgainstThePartThatShowsImpostors) {
  const PromiseSlack slack;
  const auto mse = [](double psnr_db) { return 255 * 255 * std::pow(10, -0.1 * psnr_db); };
  const auto of_voids = [&](double part) {  // of the tiles that show
    CertifiedTile whole = whole_ahead(), open = tile_ahead();
    for (CertifiedTile* tile : {&whole, &open}) tile->covered_samples = static_cast<std::uint32_t>(part * tile->covered_samples);
    return mse(promise_of(ahead(), {open}).expected_psnr_db) - mse(promise_of(ahead(), {whole}).expected_psnr_db);
  };
  // A face is 9 tiles across and as wide as a right angle; a frame 106 by 60 degrees, 2.05 by 1.15 in tangents.
  const double tile_in_frame = 2.0 / 9 * 2.0 / 9 / (2.0528 * 1.1547);
  EXPECT_NEAR(of_voids(1), 4.0 / 40000 / tile_in_frame * slack.void_mse, 0.2 * of_voids(1));
  EXPECT_NEAR(of_voids(0.5) / of_voids(1), 2, 1e-3);
  EXPECT_NEAR(of_voids(1e-4), slack.void_mse, 1e-6) << "there is no more than all of it";
  CertifiedTile open = tile_ahead();
  const double promised = promise_of(ahead(), {open}).psnr_db;
  open.certificate.void_hits *= 2;
  EXPECT_LT(promise_of(ahead(), {open}).psnr_db, promised - 0.5);
  EXPECT_GT(mse(promised) - mse(promise_of(ahead(), {whole_ahead()}).psnr_db), slack.void_factor * of_voids(1)) << "and confidence beside the slack";
}

TEST(FramePromise, TilesThatWereNotMeasuredAreStoodForByOthers) {
  CertifiedTile other = tile_ahead();
  other.certificate.colour_mse[0] = other.certificate.disparity_p99 = -1;
  other.tolerance = 2e-3f;
  PromisedView view = ahead();
  view.eye.position.x += 0.25;
  const FramePromise one = promise_of(view, {tile_ahead()}), two = promise_of(view, {tile_ahead(), other});
  EXPECT_NEAR(two.psnr_db, one.psnr_db, 1e-6);
  EXPECT_NEAR(two.warp_px, 2 * one.warp_px, 1e-3) << "by what their coding guarantees";
}

TEST(FramePromise, TilesBehindTheEyeSayNothingOfColour) {
  CertifiedTile behind = tile_ahead();
  behind.id.face = 5;
  behind.certificate.colour_mse[0] = 4000;
  EXPECT_NEAR(promise_of(ahead(), {tile_ahead(), behind}).psnr_db, promise_of(ahead(), {tile_ahead()}).psnr_db, 1e-6);
}

TEST(FramePromise, AShellCountsOnceAndShellsAddUp) {
  const double once = promise_of(ahead(), {tile_ahead()}).expected_void_share;
  EXPECT_NEAR(promise_of(ahead(), {tile_ahead(), tile_ahead()}).expected_void_share, once, 1e-12);
  EXPECT_NEAR(promise_of(ahead(), {tile_ahead(), tile_ahead(1)}).expected_void_share, 2 * once, 1e-12);
}

TEST(FramePromise, WarpGrowsWithTheWayFromTheViewAndIsNothingAtIt) {
  PromisedView view = ahead();
  EXPECT_NEAR(promise_of(view, {tile_ahead()}).warp_px, 0, 1e-9);
  view.eye.position.x += 0.25;
  const double near = promise_of(view, {tile_ahead()}).warp_px;
  view.eye.position.x += 0.25;
  const double far = promise_of(view, {tile_ahead()}).warp_px;
  // Half a side to the side of a sample straight ahead: 0.5·1e-3 rad, a little more aside.
  EXPECT_GE(far, 0.5e-3 / view.display.pixel_pitch() * 0.98);
  EXPECT_LE(far, 0.5e-3 / view.display.pixel_pitch() * 1.5);
  EXPECT_NEAR(far / near, 2, 0.2);
  view.is_mesh = true;
  CertifiedTile tile = tile_ahead();
  tile.tolerance = 1e-3f;
  EXPECT_GT(promise_of(view, {tile}).warp_px, 3 * far) << "meshes are simplified";
}

// The bound of a sample's displacement against a brute-force projection of samples that are wrong by as much.
TEST(FramePromise, NoSampleInTheFrameIsDisplacedFurther) {
  PromisedView view = ahead();
  view.eye.position += glm::dvec3(0.45, -0.4, 0.3);
  const CertifiedTile tile = tile_ahead();
  const double promised = promise_of(view, {tile}).warp_px, pitch = view.display.pixel_pitch();
  const glm::dmat3 camera_from_world = glm::transpose(glm::dmat3(glm::mat3_cast(view.eye.world_from_camera)));
  double worst = 0;
  for (int k = 0; k < 4000; ++k) {
    // Low-discrepancy places, so that the worst is met closely.
    const double x = std::fmod(k * 0.7548776662466927, 1.0), y = std::fmod(k * 0.5698402909980532, 1.0), d = 0.4 * std::fmod(k * 0.6180339887498949, 1.0);
    const double u = sample_tangent(tile.edge_samples, 4 * kTileStride + (0.125 + 0.75 * x) * kTileSamples);
    const double v = sample_tangent(tile.edge_samples, 4 * kTileStride + (0.125 + 0.75 * y) * kTileSamples);
    const auto place = [&](double disparity) {
      const glm::dvec3 q = camera_from_world * (CubeFace::of(4).direction(u, v) - (view.eye.position - tile.view_position) * disparity);
      return glm::dvec2(q.x / q.z, q.y / q.z) / pitch;
    };
    worst = std::max(worst, glm::distance(place(d), place(d + 1e-3)));
  }
  EXPECT_LE(worst, promised * 1.02);
  EXPECT_GE(worst, promised * 0.3) << "and the bound is of use";
}

}  // namespace
}  // namespace farfield
