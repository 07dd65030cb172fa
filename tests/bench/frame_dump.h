// SPDX-License-Identifier: Apache-2.0
// Frames on their way from the measured client process to the judge: one file per frame, exactly what the client had
// in memory. Private to the benchmark: native layout, no versions.
#pragma once

#include <filesystem>

#include "client/warp/frame_image.h"
#include "common/base/result.h"
#include "common/math/camera.h"

namespace farfield::bench {

struct DumpedFrame {
  Pose eye;  // world frame
  client::Frame frame;
};

std::filesystem::path frame_path(const std::filesystem::path& folder, std::size_t index);
/// Errors: kIo (a full disk among them).
Status write_frame(const std::filesystem::path& file, const Pose& eye, const client::Frame& frame);
Result<DumpedFrame> read_frame(const std::filesystem::path& file);

}  // namespace farfield::bench
