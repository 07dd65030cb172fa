// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/colour_probe.h"

#include <gtest/gtest.h>

#include "server/impostor/dense_tile.h"
#include "tests/unit/server/impostor/block_scenes.h"

namespace farfield {
namespace {

class ColourProbeTest : public testing::Test {
 protected:
  ColourProbeTest() : placed_(test::pillar_room().build()), space_(test::space_around(placed_, glm::dvec3(0), 1)) {
    TileWork work;
    tile_ = cast_dense_tile(*placed_.scene, space_, placed_.at(glm::dvec3(0)), {{}, kIntraView, 0, 1, 1}, face_samples(4), 1.0, 1e-3, nullptr, work);
  }
  ColourProbes probes() const { return {*placed_.scene, space_, placed_.at(glm::dvec3(0)), tile_, {640, 360}}; }
  Certificate measured(const Tile& decoded) const {
    Certificate certificate;
    probes().measure(tile_, {decoded.disparity, decoded.rgb}, certificate);
    return certificate;
  }
  test::PlacedScene placed_;
  CellSpace space_;
  Tile tile_;
};

TEST_F(ColourProbeTest, AnExactTileIsCloseToTruth) {
  const Certificate exact = measured(tile_);
  for (int k = 0; k < 2; ++k) {
    EXPECT_GE(exact.colour_mse[k], 0);
    EXPECT_LE(exact.colour_mse[k], 200) << "edges of chequers and of the pillar alone";
    EXPECT_GE(exact.colour_mse_error[k], 0);
  }
  EXPECT_FLOAT_EQ(exact.disparity_p99, 0);
}

TEST_F(ColourProbeTest, WrongColoursAndDisparitiesAreMeasured) {
  const Certificate exact = measured(tile_);
  Tile wrong = tile_;
  for (std::uint8_t& value : wrong.rgb) value = static_cast<std::uint8_t>(value > 200 ? value - 30 : value + 30);
  for (float& disparity : wrong.disparity) disparity += 2e-3f;
  const Certificate damaged = measured(wrong);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(damaged.colour_mse[k], 900 + exact.colour_mse[k], 200);
  EXPECT_NEAR(damaged.disparity_p99, 2e-3, 1e-6);
}

TEST_F(ColourProbeTest, ProbesOfATileAreAlwaysTheSame) {
  EXPECT_EQ(measured(tile_), measured(tile_));
}

TEST_F(ColourProbeTest, ATileWithoutSurfaceIsNotMeasured) {
  std::fill(tile_.coverage.begin(), tile_.coverage.end(), std::uint8_t{0});
  EXPECT_EQ(measured(tile_), Certificate{});
}

}  // namespace
}  // namespace farfield
