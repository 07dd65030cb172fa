// SPDX-License-Identifier: Apache-2.0
#include "client/app/frame_writer.h"

#include <fmt/format.h>
#include <png.h>

#include <system_error>
#include <utility>

namespace farfield::client {
namespace {

/// Beside the file first, then renamed: nobody sees half an image.
Status write_png(const std::filesystem::path& path, int width, int height, const std::vector<std::uint8_t>& rgba) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGBA;
  image.flags = PNG_IMAGE_FLAG_FAST;
  const std::filesystem::path temporary = path.string() + ".part";
  if (png_image_write_to_file(&image, temporary.c_str(), 0, rgba.data(), 0, nullptr) == 0) {
    const std::string why = image.message;
    png_image_free(&image);
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    return fail(ErrorCode::kIo, "{}: cannot be written: {}", path.string(), why);
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) return fail(ErrorCode::kIo, "{}: cannot be written: {}", path.string(), error.message());
  return {};
}

}  // namespace

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
  Picture picture{folder_ / fmt::format("frame_{:06}.png", index), frame.width, frame.height, frame.rgba};
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
    Status status = write_png(picture.path, picture.width, picture.height, picture.rgba);
    lock.lock();
    is_busy_ = false;
    if (!status) status_ = std::move(status);
    changed_.notify_all();
  }
}

}  // namespace farfield::client
