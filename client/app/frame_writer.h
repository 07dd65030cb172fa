// SPDX-License-Identifier: Apache-2.0
// Writes frames as frame_000000.png, frame_000001.png … into a folder, on a thread of its own so that compressing
// them does not disturb the clock of a real-time run. Belongs to one thread.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "client/warp/frame_image.h"
#include "common/base/result.h"
#include "common/image/image.h"

namespace farfield::client {

class FrameWriter {
 public:
  explicit FrameWriter(std::filesystem::path folder);
  /// Writes what still waits.
  ~FrameWriter();

  /// Makes the folder. Errors: kIo.
  Status prepare();
  /// Queues a copy; blocks while kMostWaiting frames wait. Errors: kIo, of an earlier frame.
  Status write(const Frame& frame, std::size_t index);
  /// Waits until everything is on disk. Errors: kIo.
  Status finish();

 private:
  static constexpr std::size_t kMostWaiting = 8;
  struct Picture {
    std::string path;
    Image8 image;
  };
  void run();

  const std::filesystem::path folder_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::deque<Picture> waiting_;
  Status status_;
  bool is_busy_ = false;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace farfield::client
