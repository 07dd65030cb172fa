// SPDX-License-Identifier: Apache-2.0
// What is baked is what viewers ask for; a bake that was stopped goes on; a repeated one makes nothing.
#include "server/app/bake_tool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "common/trace/trace_file.h"
#include "server/app/build_service.h"
#include "server/store/memory_tile_store.h"
#include "tests/support/temporary_folder.h"

namespace farfield {
namespace {

TEST(BakePlaces, EveryFinestCellOfAPathOnce) {
  Trace trace;
  trace.frames = {{0, {{10.2, 1.7, 0.1}, {}}}, {1, {{14.2, 1.7, 0.1}, {}}}, {2, {{10.2, 1.7, 0.1}, {}}}};
  const CellGrid grid{0.5};
  const glm::dvec3 origin(10, 0, 0);
  const std::vector<Trace> traces{trace};
  const std::vector<glm::dvec3> places = places_along(traces, origin, grid);
  std::set<CellId> cells;
  for (const glm::dvec3& place : places) cells.insert(grid.cell_at(place, 0));
  EXPECT_EQ(cells.size(), 9u) << "0.2 to 4.2 m in steps of half a metre";
  EXPECT_EQ(places.size(), cells.size()) << "the way back adds nothing";
}

TEST(BakePlaces, ABoxIsSweptCellByCell) {
  const CellGrid grid{0.5};
  const PlacesInBox places(Box{{0.1, 0.1, 0.1}, {1.4, 0.4, 0.9}}, grid);
  ASSERT_EQ(places.count(), 3u * 1u * 2u);
  std::set<CellId> cells;
  for (std::uint64_t i = 0; i < places.count(); ++i) cells.insert(grid.cell_at(places.place(i), 0));
  EXPECT_EQ(cells.size(), 6u);
}

class BakeTest : public testing::Test {
 protected:
  BakeTest() {
    options_.scene = "pipes:4000:1";
    options_.stores.folder = folder_.path() / "store";
    options_.settings.face_tiles = 2;
    options_.is_json = true;
    options_.threads = 2;
  }
  nlohmann::json run(bool expect_complete = true) {
    std::ostringstream out, talk;
    const Result<bool> stopped = run_bake(options_, is_stopped_, out, talk);
    EXPECT_TRUE(stopped.has_value()) << stopped.error().message;
    if (!stopped) return {};
    EXPECT_EQ(*stopped, !expect_complete);
    return nlohmann::json::parse(out.str());
  }
  /// A service as a server makes it over the same store.
  std::shared_ptr<MeasuredCellService> service() {
    ServiceOptions options;
    options.settings = options_.settings;
    options.store = std::make_shared<MemoryTileStore>(std::size_t{64} << 20);
    options.pool = std::make_shared<JobPool>(1);
    options.blobs = open_stores(options_.stores, {})->blobs;
    return build_service({"plant", options_.scene}, options).value();
  }
  /// A short way from the scene's own start.
  Trace walk() {
    const auto prepared = prepare_scene(options_.scene, {}, {});
    const glm::dvec3 start = *prepared->standing + prepared->scene->origin();
    Trace trace;
    trace.frames = {{0, {start, glm::dquat(1, 0, 0, 0)}}, {1, {start + glm::dvec3(0.6, 0, 0), glm::dquat(1, 0, 0, 0)}}};
    return trace;
  }
  TemporaryFolder folder_;
  BakeOptions options_;
  std::atomic<bool> is_stopped_{false};
};

TEST_F(BakeTest, WhatWasBakedIsFoundByTheNextBakeAndByServers) {
  const Trace trace = walk();
  std::filesystem::create_directories(folder_.path() / "walks");
  ASSERT_TRUE(write_trace(folder_.path() / "walks" / "a.trace", trace));
  options_.traces = {folder_.path() / "walks"};
  const nlohmann::json first = run(), second = run();
  EXPECT_EQ(first["format"], "farfield-bake/1");
  EXPECT_GT(first["tiles"]["made"], 0);
  EXPECT_GT(first["leaves"], 0);
  EXPECT_EQ(second["tiles"]["made"], 0);
  EXPECT_EQ(second["tiles"]["all"], first["tiles"]["all"]);
  EXPECT_EQ(second["bytes"], first["bytes"]);

  const auto served = service();
  const glm::dvec3 viewpoint = trace.frames.back().pose.position - served->scene().world_origin;
  std::promise<SharedPlan> promise;
  const Ticket leaf = served->leaf(viewpoint, {}, [&](Result<SharedPlan> plan) { promise.set_value(plan.value_or(nullptr)); });
  const SharedPlan plan = promise.get_future().get();
  ASSERT_TRUE(plan);
  std::atomic<std::size_t> answered{0};
  std::vector<Ticket> tickets;
  const SharedPlan part = plan_at(plan, CellGrid{served->scene().settings.finest_side_m}, viewpoint);
  for (const NeededTile& tile : part->tiles) tickets.push_back(served->tile(tile.id, {}, [&](auto) { ++answered; }));
  while (answered < part->tiles.size()) std::this_thread::yield();
  EXPECT_EQ(served->statistics().plans_made, 0u);
  EXPECT_EQ(served->statistics().tile_seconds.count, 0u) << "nothing was cast";
}

TEST_F(BakeTest, ARegionIsBakedWhereSomebodyCanStand) {
  const glm::dvec3 start = walk().frames.front().pose.position;
  options_.region = Box{start - glm::dvec3(0.3, 0.3, 0.3), start + glm::dvec3(0.3, 0.3, 0.3)};
  const nlohmann::json report = run();
  EXPECT_GT(report["leaves"], 0);
  EXPECT_EQ(report["places"], report["places_done"]);
  EXPECT_EQ(report["failed"], 0);
  options_.region = Box{start + 1e5, start + 1e5 + 1.0};
  std::ostringstream out, talk;
  const auto outside = run_bake(options_, is_stopped_, out, talk);
  ASSERT_FALSE(outside.has_value());
  EXPECT_THAT(outside.error().message, testing::HasSubstr("outside the scene"));
}

TEST_F(BakeTest, AStoppedBakeSaysSoAndTheNextOneGoesOn) {
  const glm::dvec3 start = walk().frames.front().pose.position;
  options_.region = Box{start - glm::dvec3(0.3, 0.3, 0.3), start + glm::dvec3(0.3, 0.3, 0.3)};
  is_stopped_ = true;
  const nlohmann::json stopped = run(false);
  EXPECT_EQ(stopped["complete"], false);
  is_stopped_ = false;
  EXPECT_EQ(run()["complete"], true);
}

TEST_F(BakeTest, PathsThatAreNotThereAreNamed) {
  std::ostringstream out, talk;
  options_.traces = {folder_.path() / "nowhere.trace"};
  auto result = run_bake(options_, is_stopped_, out, talk);
  ASSERT_FALSE(result.has_value());
  EXPECT_THAT(result.error().message, testing::HasSubstr("nowhere.trace"));
  std::filesystem::create_directories(folder_.path() / "empty");
  options_.traces = {folder_.path() / "empty"};
  result = run_bake(options_, is_stopped_, out, talk);
  ASSERT_FALSE(result.has_value());
  EXPECT_THAT(result.error().message, testing::HasSubstr("no *.trace file"));
}

}  // namespace
}  // namespace farfield
