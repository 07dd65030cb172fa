// SPDX-License-Identifier: Apache-2.0
// The same on one thread and on two: scenes, plans, tiles and frames, bit by bit.
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <functional>
#include <thread>

#include "server/model/generate.h"
#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"

namespace farfield::stability {
namespace {

struct Run {
  ContentHash scene = 0;
  Visit visit;
  client::Frame frames[2];  // 1 and 4 samples per pixel
};

Run run_on(int threads, const std::function<Model()>& model, const glm::dvec3& eye, std::size_t tiles) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  Run run;
  tbb::task_arena arena(threads);
  arena.execute([&] {
    const auto scene = build_scene(model());
    ImpostorSettings settings = hall_settings();
    settings.finest_side_m = finest_side_for(*scene, 0.125);
    const ImpostorSources sources = make_impostor_sources(scene, settings);
    run.scene = scene->hash();
    run.visit = visit(scene, sources, settings, eye - scene->origin(), tiles);
    for (int k = 0; k < 2; ++k)
      client::CpuWarper({.samples_per_pixel = k == 0 ? 1 : 4, .threads = threads})
          .draw(run.visit.view, {eye - scene->origin(), glm::angleAxis(0.4, glm::dvec3(0, 1, 0))}, {320, 200}, nullptr, run.frames[k]);
  });
  return run;
}

StressRow compare(const char* input, const std::function<Model()>& model, const glm::dvec3& eye, std::size_t tiles) {
  const Run one = run_on(1, model, eye, tiles), two = run_on(2, model, eye, tiles);
  WorstError worst;
  worst.count(one.scene != two.scene);
  worst.count(differences(one.visit, two.visit), compared(one.visit));
  for (int k = 0; k < 2; ++k)
    for (std::size_t p = 0; p < one.frames[k].disparity.size(); ++p)
      worst.count(!std::equal(&one.frames[k].rgba[4 * p], &one.frames[k].rgba[4 * p] + 4, &two.frames[k].rgba[4 * p]) ||
                  one.frames[k].coverage[p] != two.frames[k].coverage[p] ||
                  std::bit_cast<std::uint32_t>(one.frames[k].disparity[p]) != std::bit_cast<std::uint32_t>(two.frames[k].disparity[p]));
  return worst.row(input, "one thread", "leaves, lists, tiles, pixels that differ", 0);
}

// Tiles of one leaf made by two threads at once, in opposite orders, by one maker: bytes depend on the tile alone.
StressRow tiles_at_once(std::size_t most) {
  const auto scene = build_scene(hall_model());
  const ImpostorSettings settings = hall_settings();
  const ImpostorSources first = make_impostor_sources(scene, settings), second = make_impostor_sources(scene, settings);
  const glm::dvec3 eye = kHallEyes[0] - scene->origin();
  const Visit alone = visit(scene, first, settings, eye, most);
  const std::size_t count = alone.tiles.size();
  second.leaves->plan(second.leaves->leaf_at(eye, nullptr).value(), nullptr).value();
  std::vector<Bytes> forwards(count), backwards(count);
  std::thread other([&] {
    for (std::size_t k = count; k-- > 0;) backwards[k] = *second.tiles->make(alone.needed[k].id, nullptr).value()->bytes;
  });
  for (std::size_t k = 0; k < count; ++k) forwards[k] = *second.tiles->make(alone.needed[k].id, nullptr).value()->bytes;
  other.join();
  WorstError worst;
  for (std::size_t k = 0; k < count; ++k) worst.count(forwards[k] != alone.tiles[k] || backwards[k] != alone.tiles[k]);
  return worst.row("tiles by two threads at once, in opposite orders", "one thread", "tiles that differ", 0);
}

}  // namespace

Rows stress_threads(const Effort& effort) {
  const std::size_t tiles = effort.is_full ? 400 : 16;
  Rows rows{compare("a hall on two threads", hall_model, kHallEyes[0], tiles)};
  if (effort.is_full) {
    for (const char* kind : {"pipes", "city", "house"}) {
      const auto model = [kind] { return generate_model(kind, 20000, 7).value(); };
      const glm::dvec3 middle = model().bounds().center();
      rows.push_back(compare(kind, model, {middle.x, 1.75, middle.z}, 60));
    }
  }
  rows.push_back(tiles_at_once(tiles));
  return rows;
}

}  // namespace farfield::stability
