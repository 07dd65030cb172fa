// SPDX-License-Identifier: Apache-2.0
// Budgets and targets on generated scenes: what is promised of a cell against what its tiles turn out to be.
#include "server/encode/rate_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <thread>

#include "common/codec/tile_codec.h"
#include "server/encode/tile_maker.h"
#include "server/model/generate.h"
#include "server/visibility/standpoints.h"

namespace farfield {
namespace {

// Of tiles not looked at no more is known than that they are like those that were: three standard deviations of the sample.
constexpr double kBytesTolerance = 0.2, kDecibelTolerance = 0.5;

struct Place {
  const char* kind;
  std::size_t triangles;
};
void PrintTo(const Place& place, std::ostream* out) { *out << place.kind; }

// What the tiles of a leaf's own shell turn out to be.
struct Made {
  double bytes = 0;
  double squares = 0, solid_angle = 0;   // of colours, over directions
  std::size_t tiles = 0, views = 0;
  double void_share = 0;
  double psnr() const { return 10 * std::log10(255.0 * 255.0 * solid_angle / squares); }
};

class RateControlTest : public testing::TestWithParam<Place> {
 protected:
  static ImpostorSettings settings(double cell_bytes, double psnr_db = 0) {
    ImpostorSettings settings;
    settings.display = {480, 270};
    settings.face_tiles = 6;
    settings.delta_views = 4;
    settings.near_triangles = 3000;
    settings.rate = {cell_bytes, psnr_db};
    settings.targets.coding_psnr_db = 0;  // certificates would code the worst tiles finer, whatever the target
    return settings;
  }
  static std::shared_ptr<const Scene> scene() {
    static std::map<std::string, std::shared_ptr<const Scene>> built;
    std::shared_ptr<const Scene>& scene = built[GetParam().kind];
    if (!scene) scene = Scene::build(generate_model(GetParam().kind, GetParam().triangles, 1).value()).value();
    return scene;
  }
  // All share the tree and what it remembers of what can be seen.
  struct Steered {
    std::shared_ptr<RateControl> rates;
    ImpostorSources sources;
  };
  static Steered steered(double cell_bytes, double psnr_db = 0) {
    static std::map<std::string, ImpostorSources> of_scene;
    ImpostorSources& base = of_scene[GetParam().kind];
    if (!base.tree) base = make_impostor_sources(scene(), settings(0));
    if (cell_bytes <= 0 && psnr_db <= 0) return {nullptr, base};
    const ImpostorSettings wanted = settings(cell_bytes, psnr_db);
    const NestedShells shells{CellGrid{wanted.finest_side_m}, wanted.kappa};
    const auto caster = [tiles = base.tiles](const TileId& id, const CancelFlag& cancel) {
      TileWork work;
      return tiles->cast(id, cancel, work);
    };
    Steered made;
    made.rates = std::make_shared<RateControl>(scene(), base.tree, base.views, shells, wanted, caster);
    made.sources = {base.tree, made.rates, std::make_shared<LeafPlanner>(scene(), base.tree, made.rates, shells, wanted),
                    std::make_shared<TileMaker>(scene(), base.tree, made.rates, shells, wanted, made.rates)};
    return made;
  }
  // At eye height, near the middle, where somebody can stand.
  static CellId leaf(const ImpostorSources& made) {
    const glm::dvec3 middle = scene()->bounds().center();
    for (int k = 0; k < 100; ++k) {
      const double angle = 2.399963 * k, radius = 0.7 * std::sqrt(k);
      const glm::dvec3 point(middle.x + radius * std::cos(angle), 1.7 - scene()->origin().y, middle.z + radius * std::sin(angle));
      if (is_free(*scene(), point)) return made.leaves->leaf_at(point, nullptr).value();
    }
    throw std::runtime_error("nobody can stand there");
  }
  static Made make(const ImpostorSources& made, const CellId& leaf) {
    Made result;
    const SharedPlan plan = made.leaves->plan(leaf, nullptr).value();
    for (const NeededTile& needed : plan->tiles) {
      if (needed.id.cell != leaf) continue;
      const auto encoded = made.tiles->make(needed.id, nullptr).value();
      if (encoded->bytes->empty()) continue;
      ++result.tiles;
      result.bytes += static_cast<double>(encoded->bytes->size());
      TileWork work;
      const Tile exact = made.tiles->cast(needed.id, nullptr, work).value(), decoded = decode_tile(*encoded->bytes).value();
      result.solid_angle += ColourTrial(exact).solid_angle();
      result.squares += squares_of(exact, decoded);
      result.void_share = decoded.certificate.void_share();
    }
    result.views = made.views->views(leaf, nullptr).value()->positions.size();
    return result;
  }
  // Over directions, from the definition.
  static double squares_of(const Tile& exact, const Tile& decoded) {
    const double pitch = sample_pitch(exact.edge_samples);
    double sum = 0;
    for (int y = 0; y < exact.height; ++y)
      for (int x = 0; x < exact.width; ++x) {
        const std::size_t at = static_cast<std::size_t>(y) * exact.width + x;
        if (!exact.coverage[at]) continue;
        int i = exact.id.x * kTileStride + x, j = exact.id.y * kTileStride + y;
        if (exact.is_packed()) {
          const BlockPlace block = exact.blocks[static_cast<std::size_t>(y / kBlockSamples) * kPackedColumns + x / kBlockSamples];
          i = block.x * kBlockSamples + x % kBlockSamples, j = block.y * kBlockSamples + y % kBlockSamples;
        }
        const double u = sample_tangent(exact.edge_samples, i), v = sample_tangent(exact.edge_samples, j);
        double squares = 0;
        for (std::size_t c = 3 * at; c < 3 * at + 3; ++c) squares += std::pow(int{exact.rgb[c]} - int{decoded.rgb[c]}, 2);
        sum += pitch * pitch * std::pow(1 + u * u + v * v, -1.5) * squares / 3;
      }
    return sum;
  }
};

TEST_P(RateControlTest, BudgetsAreMetAndMoreBytesAreNeverWorse) {
  const CellId cell = leaf(steered(0).sources);
  const Made as_before = make(steered(0).sources, cell);
  ASSERT_GT(as_before.tiles, 96u) << "else every tile is looked at";
  Made poorer;
  for (const double share : {0.25, 0.5, 1.1}) {
    const double budget = share * as_before.bytes;
    const Steered made = steered(budget);
    const auto coding = made.rates->coding(cell, nullptr).value();
    const Made here = make(made.sources, cell);
    EXPECT_TRUE(!coding->is_over_budget || share < 0.5) << share << ": " << coding->expected_bytes << " of " << budget << " with " << here.views << " views, slope " << coding->slope;
    EXPECT_EQ(coding->is_over_budget, coding->expected_bytes > budget);
    if (coding->is_over_budget) continue;  // coarsest colours, no delta views, and still too much coverage
    EXPECT_LE(here.bytes, (1 + kBytesTolerance) * budget) << share;
    const bool is_finest = coding->slope < 1.1 * slope_of_quality(kFinestQuality, settings(0).edge_samples());
    EXPECT_TRUE(is_finest || here.bytes >= (1 - kBytesTolerance) * budget) << here.bytes << " of " << budget << ", and more would help";
    EXPECT_NEAR(here.bytes, coding->expected_bytes, kBytesTolerance * here.bytes) << share;
    if (poorer.tiles > 0) {
      EXPECT_LE(here.squares / here.solid_angle, 1.02 * poorer.squares / poorer.solid_angle) << share;
      EXPECT_GE(here.views, poorer.views) << share;
      EXPECT_LE(here.void_share, poorer.void_share) << share;
    }
    poorer = here;
  }
  EXPECT_GT(poorer.tiles, 0u) << "no budget was met";
}

TEST_P(RateControlTest, TargetsAreMetByDecodedTiles) {
  const CellId cell = leaf(steered(0).sources);
  double coarser_bytes = 0;
  for (const double target : {33.0, 39.0}) {
    const Steered made = steered(0, target);
    const Made here = make(made.sources, cell);
    const bool is_coarsest = made.rates->coding(cell, nullptr).value()->slope > 0.9 * slope_of_quality(kCoarsestQuality, settings(0).edge_samples());
    EXPECT_GE(here.psnr(), target - kDecibelTolerance);
    EXPECT_TRUE(is_coarsest || here.psnr() <= target + 2 * kDecibelTolerance) << here.psnr() << " for " << target << ": bytes for nothing";
    EXPECT_GT(here.bytes, coarser_bytes);
    coarser_bytes = here.bytes;
  }
}

TEST_P(RateControlTest, OfBothTheBudgetGoesFirst) {
  const Steered wanted = steered(0, 39);
  const CellId cell = leaf(wanted.sources);
  const auto alone = wanted.rates->coding(cell, nullptr).value();
  const double dear = alone->expected_bytes;
  const auto halved = steered(0.5 * dear, 39).rates->coding(cell, nullptr).value();
  EXPECT_LE(halved->expected_bytes, 0.5 * dear);
  EXPECT_GT(halved->slope, alone->slope);
  const auto plenty = steered(1.5 * dear, 39).rates->coding(cell, nullptr).value();
  EXPECT_EQ(plenty->expected_bytes, dear) << "no more than is needed for the target";
  EXPECT_EQ(plenty->views->positions, alone->views->positions);
}

INSTANTIATE_TEST_SUITE_P(Scenes, RateControlTest,
                         testing::Values(Place{"pipes", 60000}, Place{"city", 60000}, Place{"statues", 60000}, Place{"house", 30000}),
                         [](const auto& info) { return std::string(info.param.kind); });

class RateControlOnce : public RateControlTest {};

TEST_P(RateControlOnce, BytesDependOnNobody) {
  const ImpostorSources first = make_impostor_sources(scene(), settings(60000)), second = make_impostor_sources(scene(), settings(60000));
  const CellId cell = leaf(first);
  std::vector<TileId> ids;
  const SharedPlan plan = first.leaves->plan(cell, nullptr).value();
  for (std::size_t k = 0; k < plan->tiles.size(); k += 1 + plan->tiles.size() / 40) ids.push_back(plan->tiles[k].id);
  const auto make_all = [](const ImpostorSources& from, const std::vector<TileId>& wanted) {
    std::vector<Bytes> made;
    for (const TileId& id : wanted) made.push_back(*from.tiles->make(id, nullptr).value()->bytes);
    return made;
  };
  // Of the second, outer shells first and without a plan; by two threads that meet in every cell.
  const std::vector<TileId> reversed(ids.rbegin(), ids.rend());
  std::vector<Bytes> a, b;
  std::thread other([&] { a = make_all(second, reversed); });
  b = make_all(second, reversed);
  other.join();
  EXPECT_EQ(a, b);
  std::reverse(a.begin(), a.end());
  EXPECT_EQ(make_all(first, ids), a);
}

TEST_P(RateControlOnce, WithoutTargetsQualityIsFixed) {
  const ImpostorSources fixed = steered(0).sources;
  EXPECT_FALSE(std::dynamic_pointer_cast<RateControl>(fixed.views));
  const SharedPlan plan = fixed.leaves->plan(leaf(fixed), nullptr).value();
  std::size_t compared = 0;
  for (std::size_t k = 0; k < plan->tiles.size(); k += 7) {
    const TileId& id = plan->tiles[k].id;
    const Bytes made = *fixed.tiles->make(id, nullptr).value()->bytes;
    if (made.empty()) continue;
    TileWork work;
    const Tile exact = fixed.tiles->cast(id, nullptr, work).value();
    constexpr std::size_t kQualityPlace = 3;
    const int quality = id.is_delta() ? 64 : 80;
    if (made[kQualityPlace] != quality) continue;  // missed its target, and was coded finer
    Bytes expected = encode_tile(exact, {quality}).value();
    set_certificate(expected, decode_tile(made).value().certificate);
    EXPECT_EQ(made, expected);
    ++compared;
  }
  EXPECT_GT(compared, 10u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, RateControlOnce, testing::Values(Place{"pipes", 60000}), [](const auto& info) { return std::string(info.param.kind); });

}  // namespace
}  // namespace farfield
