// SPDX-License-Identifier: Apache-2.0
// A ray-tracing structure that may still be in the making: whoever asks for rays waits, whoever does not goes on.
#pragma once

#include <atomic>
#include <functional>
#include <future>

#include "server/scene/ray_scene.h"

namespace farfield {

/// get() is safe from any thread; set up by one, once.
class PendingRays {
 public:
  PendingRays() = default;
  PendingRays(const PendingRays&) = delete;
  PendingRays& operator=(const PendingRays&) = delete;
  /// Waits for the build.
  ~PendingRays();

  void set(RayScene rays);
  /// Builds on a thread of its own. What `build` refers to must not move and must outlive this.
  void build_later(std::function<Result<RayScene>()> build);
  /// Waits while it is being built. Throws std::runtime_error if it could not be: the job that casts fails with its words.
  const RayScene& get() const {
    const RayScene* ready = ready_.load(std::memory_order_acquire);
    return ready ? *ready : wait();
  }

 private:
  const RayScene& wait() const;

  RayScene rays_;
  std::atomic<const RayScene*> ready_{nullptr};
  std::shared_future<Status> built_;
};

}  // namespace farfield
