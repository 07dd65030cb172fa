// SPDX-License-Identifier: Apache-2.0
#include "client/app/frame_writer.h"

#include <fmt/format.h>
#include <algorithm>
#include <system_error>
#include <utility>

#include "common/image/png.h"

namespace farfield::client {
FrameWriter::FrameWriter(std::filesystem::path folder) : folder_(std::move(folder)), thread_([this] { run(); }) {}

FrameWriter::~FrameWriter() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

Status FrameWriter::prepare() {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return fail(ErrorCode::kIo, "{}: the folder cannot be made: {}", folder_.string(), error.message());
  return {};
}

Status FrameWriter::write(const Frame& frame, std::size_t index) {
  Picture picture{(folder_ / fmt::format("frame_{:06}.png", index)).string(), Image8(frame.width, frame.height, 3)};
  for (std::size_t i = 0; i < frame.pixels(); ++i) {
    std::copy_n(frame.rgba.data() + 4 * i, 3, picture.image.values.data() + 3 * i);
  }
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.size() < kMostWaiting || !status_; });
  if (!status_) return status_;
  waiting_.push_back(std::move(picture));
  changed_.notify_all();
  return {};
}

Status FrameWriter::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return (waiting_.empty() && !is_busy_) || !status_; });
  return status_;
}

void FrameWriter::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return is_over_ || !waiting_.empty(); });
    if (waiting_.empty() || !status_) return;
    const Picture picture = std::move(waiting_.front());
    waiting_.pop_front();
    is_busy_ = true;
    lock.unlock();
    Status status = write_png(picture.path, picture.image);
    lock.lock();
    is_busy_ = false;
    if (!status) status_ = std::move(status);
    changed_.notify_all();
  }
}

}  // namespace farfield::client
