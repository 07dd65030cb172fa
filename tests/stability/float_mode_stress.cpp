// SPDX-License-Identifier: Apache-2.0
// What threads do with denormals, NaN and infinities. A library built with -ffast-math switches denormals off for the
// thread that loads it, and threads inherit that: here every thread that computes is asked, TBB's workers after Embree has
// used them included.
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <mutex>
#include <set>
#include <thread>

#include "tests/stability/float_mode.h"
#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"

namespace farfield::stability {
namespace {

// Until two workers have answered, if the machine has two; each task takes long enough for the others to wake up.
StressRow workers() {
  WorstError worst;
  std::mutex mutex;
  std::set<std::thread::id> seen;
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  tbb::task_arena arena(2);
  for (int round = 0; round < 50 && seen.size() < 2; ++round)
    arena.execute([&] {
      tbb::parallel_for(0, 16, [&](int) {
        const bool is_fine = is_thread_ieee();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const std::lock_guard lock(mutex);
        seen.insert(std::this_thread::get_id());
        worst.count(!is_fine);
      });
    });
  worst.count(seen.size() < 2);
  return worst.row("TBB's workers after Embree built and cast", "IEEE 754", "not so", 0);
}

}  // namespace

Rows stress_float_modes(const Effort&) {
  WorstError main, other, after;
  main.count(!is_thread_ieee());
  std::thread([&] { other.count(!is_thread_ieee()); }).join();
  const auto scene = build_scene(hall_model());
  const ReferenceImage image = render_reference(*scene, {kHallEyes[0] - scene->origin(), {1, 0, 0, 0}}, kSmallDisplay, 16);
  after.count(!is_thread_ieee());
  after.count(image.disparity.empty());
  return {main.row("the program's first thread", "IEEE 754", "not so", 0), other.row("a thread it starts", "IEEE 754", "not so", 0),
          after.row("the thread that built a scene and cast rays", "IEEE 754", "not so", 0), workers()};
}

}  // namespace farfield::stability
