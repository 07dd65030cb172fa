// SPDX-License-Identifier: Apache-2.0
#include "server/scene/pending_rays.h"

#include <stdexcept>
#include <utility>

namespace farfield {

PendingRays::~PendingRays() {
  if (built_.valid()) built_.wait();
}

void PendingRays::set(RayScene rays) {
  rays_ = std::move(rays);
  ready_.store(&rays_, std::memory_order_release);
}

void PendingRays::build_later(std::function<Result<RayScene>()> build) {
  built_ = std::async(std::launch::async, [this, build = std::move(build)]() -> Status {
             Result<RayScene> rays = build();
             if (!rays) return tl::unexpected(std::move(rays).error());
             set(std::move(*rays));
             return {};
           }).share();
}

const RayScene& PendingRays::wait() const {
  const std::shared_future<Status> built = built_;  // a copy of one's own is what makes waiting safe from several threads
  if (!built.valid()) throw std::logic_error("a scene without rays");
  const Status status = built.get();
  if (!status) throw std::runtime_error(status.error().message);
  return rays_;
}

}  // namespace farfield
