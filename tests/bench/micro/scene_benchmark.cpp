// SPDX-License-Identifier: Apache-2.0
// Casting and shading whole cube maps: the floor under every cell time. Also building, and what chunks weigh.
//
// The scene is FARFIELD_BENCH_SCENE, "kind:triangles" of a generator, "pipes:1000000" unless set.
#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstdlib>
#include <string>

#include "common/math/cube_face.h"
#include "server/model/generate.h"
#include "server/scene/scene.h"

namespace farfield {
namespace {

constexpr int kEdge = 1514;  // samples along a face's edge: 720p at 60 degrees
constexpr int kBlock = 4;    // a packet is a block of 4 × 4 samples: compact, so coherent
constexpr int kBlocks = (kEdge + kBlock - 1) / kBlock;

Model bench_model() {
  const char* set = std::getenv("FARFIELD_BENCH_SCENE");
  const std::string name = set ? set : "pipes:1000000";
  const std::size_t colon = name.find(':');
  Result<Model> model = generate_model(name.substr(0, colon), std::stoull(name.substr(colon + 1)), 1);
  if (!model) throw std::runtime_error(model.error().message);
  return std::move(*model);
}

const Scene& bench_scene() {
  static const std::shared_ptr<const Scene> scene = Scene::build(bench_model()).value();
  return *scene;
}

// Rays of one row of blocks; the tangents come from a table, so that making rays costs little beside casting them.
class FaceRays {
 public:
  explicit FaceRays(const glm::vec3& eye) {
    for (int i = 0; i < kBlocks * kBlock; ++i) tangent_[i] = static_cast<float>(sample_tangent(kEdge, i));
    for (int lane = 0; lane < kPacketSize; ++lane) {
      at_eye_.origin_x[lane] = eye.x, at_eye_.origin_y[lane] = eye.y, at_eye_.origin_z[lane] = eye.z;
      at_eye_.near[lane] = 0, at_eye_.far[lane] = std::numeric_limits<float>::infinity();
    }
  }
  const RayPacket& at_eye() const { return at_eye_; }
  void aim(RayPacket& rays, int face, int block_x, int block_y) const {
    const CubeFace cube = CubeFace::of(face);
    float* component[3] = {rays.direction_x, rays.direction_y, rays.direction_z};
    for (int lane = 0; lane < kPacketSize; ++lane) {
      component[cube.axis][lane] = static_cast<float>(cube.sign);
      component[cube.u_axis()][lane] = tangent_[block_x * kBlock + lane % kBlock];
      component[cube.v_axis()][lane] = tangent_[block_y * kBlock + lane / kBlock];
    }
  }

 private:
  RayPacket at_eye_{};
  float tangent_[kBlocks * kBlock];
};

enum class Work { kRays, kCast, kCastAndShade };

void cube_map(benchmark::State& state, Work work) {
  const Scene& scene = bench_scene();
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  const Box& bounds = scene.bounds();
  const glm::vec3 eye(bounds.center().x + 0.37, bounds.min.y + 1.7, bounds.center().z + 0.21);
  const FaceRays face_rays(eye);
  std::atomic<std::size_t> hit_count{0};
  for (auto _ : state) {
    arena.execute([&] {
      tbb::parallel_for(0, kCubeFaces * kBlocks, [&](int row) {
        const int face = row / kBlocks;
        alignas(64) float rgb[3 * kPacketSize] = {};
        std::size_t hits_in_row = 0;
        HitPacket hits;
        RayPacket rays = face_rays.at_eye();
        for (int x = 0; x < kBlocks; ++x) {
          face_rays.aim(rays, face, x, row % kBlocks);
          benchmark::DoNotOptimize(&rays);
          if (work == Work::kRays) continue;
          scene.intersect(rays, hits);
          for (int lane = 0; lane < kPacketSize; ++lane) hits_in_row += hits.part[lane] != kNoHit;
          if (work == Work::kCastAndShade) scene.shade(rays, hits, static_cast<float>(sample_pitch(kEdge)), rgb);
          benchmark::DoNotOptimize(rgb);
        }
        hit_count += hits_in_row;
      });
    });
  }
  const double rays = static_cast<double>(state.iterations()) * kCubeFaces * kBlocks * kBlocks * kPacketSize;
  state.counters["rays/s"] = benchmark::Counter(rays, benchmark::Counter::kIsRate);
  state.counters["hits"] = static_cast<double>(hit_count) / rays;
}

void scene_cube_map_rays_only(benchmark::State& state) {
  cube_map(state, Work::kRays);
}
void scene_cube_map_cast(benchmark::State& state) {
  cube_map(state, Work::kCast);
}
void scene_cube_map_cast_and_shade(benchmark::State& state) {
  cube_map(state, Work::kCastAndShade);
}
BENCHMARK(scene_cube_map_rays_only)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(scene_cube_map_cast)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(scene_cube_map_cast_and_shade)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void scene_build(benchmark::State& state) {
  double triangles = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Model model = bench_model();
    state.ResumeTiming();
    const auto scene = Scene::build(std::move(model)).value();
    triangles += static_cast<double>(scene->statistics().drawn_triangles);
  }
  state.counters["triangles/s"] = benchmark::Counter(triangles, benchmark::Counter::kIsRate);
}
BENCHMARK(scene_build)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();

void scene_encode_chunks(benchmark::State& state) {
  const Scene& scene = bench_scene();
  std::size_t bytes = 0, triangles = 0, at = 0;
  for (auto _ : state) {
    const auto chunk = static_cast<std::uint32_t>(at);
    at = (at + 7919) % scene.chunks().size();  // a prime stride: all over the scene
    bytes += encode_chunk(scene.chunk_geometry(chunk)).size();
    triangles += scene.chunks()[chunk].triangles;
  }
  state.counters["bytes/triangle"] = static_cast<double>(bytes) / static_cast<double>(triangles);
  state.counters["triangles/s"] = benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsRate);
}
BENCHMARK(scene_encode_chunks)->Unit(benchmark::kMicrosecond);

void scene_decode_chunks(benchmark::State& state) {
  const Scene& scene = bench_scene();
  std::size_t triangles = 0, at = 0;
  for (auto _ : state) {
    const auto chunk = static_cast<std::uint32_t>(at);
    at = (at + 7919) % std::min<std::size_t>(scene.chunks().size(), 1000);
    benchmark::DoNotOptimize(decode_chunk(*scene.encoded_chunk(chunk)));
    triangles += scene.chunks()[chunk].triangles;
  }
  state.counters["triangles/s"] = benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsRate);
}
BENCHMARK(scene_decode_chunks)->Unit(benchmark::kMicrosecond);

void scene_chunks_in_box(benchmark::State& state) {
  const Scene& scene = bench_scene();
  const glm::dvec3 centre = scene.bounds().center();
  std::size_t found = 0;
  for (auto _ : state) found += scene.chunks_in(Box{centre, centre}.grown(5)).size();
  state.counters["found"] = static_cast<double>(found) / static_cast<double>(state.iterations());
}
BENCHMARK(scene_chunks_in_box)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace farfield
