// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/frame_dump.h"

#include <fstream>

namespace farfield::bench {
namespace {

struct Header {
  double eye[7];  // position, quaternion x y z w
  std::int32_t width, height;
  client::FrameStatistics statistics;
};

}  // namespace

std::filesystem::path frame_path(const std::filesystem::path& folder, std::size_t index) {
  return folder / fmt::format("frame_{:05d}.raw", index);
}

Status write_frame(const std::filesystem::path& file, const Pose& eye, const client::Frame& frame) {
  std::ofstream out(file, std::ios::binary);
  const glm::dquat& q = eye.world_from_camera;
  const Header header{{eye.position.x, eye.position.y, eye.position.z, q.x, q.y, q.z, q.w}, frame.width, frame.height, frame.statistics};
  const auto put = [&](const void* data, std::size_t size) { out.write(static_cast<const char*>(data), static_cast<std::streamsize>(size)); };
  put(&header, sizeof header);
  put(frame.rgba.data(), frame.rgba.size());
  put(frame.disparity.data(), frame.disparity.size() * sizeof(float));
  put(frame.coverage.data(), frame.coverage.size() * sizeof(client::Coverage));
  out.close();
  if (!out) return fail(ErrorCode::kIo, "{}: cannot be written (is the disk full?)", file.string());
  return {};
}

Result<DumpedFrame> read_frame(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  Header header;
  const auto get = [&](void* data, std::size_t size) { in.read(static_cast<char*>(data), static_cast<std::streamsize>(size)); };
  get(&header, sizeof header);
  if (!in) return fail(ErrorCode::kIo, "{}: cannot be read", file.string());
  DumpedFrame dump;
  dump.eye.position = {header.eye[0], header.eye[1], header.eye[2]};
  dump.eye.world_from_camera = glm::dquat(header.eye[6], header.eye[3], header.eye[4], header.eye[5]);
  client::Frame& frame = dump.frame;
  frame.width = header.width, frame.height = header.height, frame.statistics = header.statistics;
  frame.rgba.resize(4 * frame.pixels()), frame.disparity.resize(frame.pixels()), frame.coverage.resize(frame.pixels());
  get(frame.rgba.data(), frame.rgba.size());
  get(frame.disparity.data(), frame.disparity.size() * sizeof(float));
  get(frame.coverage.data(), frame.coverage.size() * sizeof(client::Coverage));
  if (!in) return fail(ErrorCode::kIo, "{}: cut off", file.string());
  return dump;
}

}  // namespace farfield::bench
