// SPDX-License-Identifier: Apache-2.0
// From a leaf set and a pose to a finished image: near geometry and impostors, both by OpenGL or both on the CPU, merged by
// depth, cracks and voids filled. What the window, the headless client and the benchmark all call.
//
// Belongs to one thread, the one that created it: with OpenGL it owns (or uses) a context that is current there.
#pragma once

#include <limits>
#include <optional>
#include <memory>

#include "client/frame/promise.h"
#include "client/gl/gl_context.h"
#include "client/near/near_renderer.h"
#include "client/store/leaf_view.h"
#include "client/warp/frame_image.h"
#include "client/warp_gl/impostor_renderer.h"
#include "common/math/camera.h"

namespace farfield::client {

enum class Renderer {
  kCpu,  // triangles and splats on the CPU, without any OpenGL: fastest without a GPU
  kGl,   // triangles and depth meshes on the GPU
};

struct FrameOptions {
  /// 1, or 4: 2×2 on the CPU, multisamples in OpenGL. kChosen: 4 on a GPU, which hardly notices, and which outlines and far
  /// detail gain half a decibel to two from; 1 without one, where four would take three times as long on the CPU and five
  /// times in OpenGL. With 1, staircases along silhouettes are smoothed.
  static constexpr int kChosen = 0;
  int samples_per_pixel = kChosen;
  int cpu_threads = 0;        // of the CPU warper; 0: one per core
  /// Bytes of impostors uploaded per frame (kGl). A new leaf set is shown once it is uploaded; until then the one
  /// before it. Unlimited where every frame must show its own leaf set (lockstep).
  std::size_t frame_upload_bytes = std::numeric_limits<std::size_t>::max();
  glm::u8vec3 background{176, 200, 224};  // sRGB, while there is no leaf set
  /// A leaf set gives way to the next one in this time (leaf_fade.h), frames of which take twice as long; 0: at once. At 60
  /// frames a second 15 frames share what would otherwise change within one.
  double fade_seconds = 0.25;
  NearOptions near;
  ImpostorOptions impostors;
};

/// What a bound on main memory leaves for the client's store: without a GPU, what OpenGL holds is in main memory too, and
/// is taken from it, up to three fifths of the bound.
std::size_t store_bytes(std::size_t memory_bytes, Renderer renderer, bool is_software);

/// Milliseconds by part; each part ends with its results in memory.
struct FrameTimes {
  double near_ms = 0;       // upload and draw near geometry (kCpu: find what is in view)
  double impostors_ms = 0;  // upload and draw impostors (kCpu: draw all, with cracks and voids)
  double read_back_ms = 0;  // kGl
  double resolve_ms = 0;  // kGl: classes, cracks, voids
  double former_ms = 0;   // draw the leaf set that fades, and mix; the parts above are of the other
  double total_ms = 0;    // from the pose to the finished image
};

struct FrameReport {
  NearStatistics near;
  ImpostorStatistics impostors;  // kGl
  FrameTimes times;
  bool is_previous_leaf = false;          // the new leaf set is still being uploaded
  std::shared_ptr<const LeafView> drawn;  // null: background only. While leaf sets fade: the newest
  double drawn_share = 1;                 // less than 1: two leaf sets were mixed
};

class FrameRenderer {
 public:
  /// `context`, of kGl: null makes a surfaceless one; otherwise current on this thread and outliving the renderer.
  /// Errors: kUnavailable (no OpenGL), kInvalidArgument (samples), kLimitExceeded (display size).
  static Result<std::unique_ptr<FrameRenderer>> create(Renderer renderer, const Display& display,
                                                       const FrameOptions& options = {}, GlContext* context = nullptr);
  ~FrameRenderer();

  /// Errors: kLimitExceeded; the old size stays in use.
  Status resize(const Display& display);

  /// Draws into `frame`; reusing one saves allocations. `leaf` may be null: background only. `eye`: scene frame. `time_s`: of
  /// any clock that does not run back, for fading; without it a new leaf set is shown at once.
  FrameReport render(std::shared_ptr<const LeafView> leaf, const Pose& eye, Frame& frame, std::optional<double> time_s = {});

  /// What the certificates of `leaf` promise for a frame drawn of it with these options.
  FramePromise promise(const LeafView& leaf, const Pose& eye) const;

  const Display& display() const;
  const GlAbilities& abilities() const;  // of kGl

 private:
  FrameRenderer();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace farfield::client
