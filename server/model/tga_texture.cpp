// SPDX-License-Identifier: Apache-2.0
// Truevision TGA File Format Specification, version 2.0 (1991). Written here rather than taken from a library: the
// format is small, and rows go straight into the reducer, so that memory stays bounded.
#include "server/model/tga_texture.h"

#include <algorithm>
#include <array>

#include "server/model/row_reducer.h"

namespace farfield {
namespace {

constexpr std::size_t kHeaderBytes = 18;

struct TgaHeader {
  std::size_t id_bytes = 0;
  bool has_map = false, is_run_length = false, is_grey = false, is_mapped = false;
  std::size_t map_first = 0, map_entries = 0;
  int map_bits = 0;
  int width = 0, height = 0, bits = 0, alpha_bits = 0;
  bool is_right_to_left = false, is_top_down = false;

  std::size_t pixel_bytes() const { return static_cast<std::size_t>(bits + 7) / 8; }
  std::size_t map_entry_bytes() const { return static_cast<std::size_t>(map_bits + 7) / 8; }
};

bool is_colour_depth(int bits) { return bits == 15 || bits == 16 || bits == 24 || bits == 32; }

/// Returns: false if the bytes are no header that is understood.
bool read_header(ByteView bytes, TgaHeader& header) {
  if (bytes.size() < kHeaderBytes || bytes[1] > 1) return false;
  const auto word = [&](std::size_t at) { return bytes[at] | bytes[at + 1] << 8; };
  const int type = bytes[2] & ~8;
  header.id_bytes = bytes[0];
  header.has_map = bytes[1] == 1;
  header.is_run_length = (bytes[2] & 8) != 0;
  header.is_mapped = type == 1;
  header.is_grey = type == 3;
  header.map_first = static_cast<std::size_t>(word(3));
  header.map_entries = static_cast<std::size_t>(word(5));
  header.map_bits = bytes[7];
  header.width = word(12);
  header.height = word(14);
  header.bits = bytes[16];
  header.alpha_bits = bytes[17] & 15;
  header.is_right_to_left = (bytes[17] & 16) != 0;
  header.is_top_down = (bytes[17] & 32) != 0;
  if (header.width == 0 || header.height == 0 || (bytes[17] & 0xc0) != 0) return false;
  if (header.has_map && !is_colour_depth(header.map_bits)) return false;
  if (type == 1) return header.has_map && header.map_entries > 0 && (header.bits == 8 || header.bits == 16);
  if (type == 2) return is_colour_depth(header.bits);
  return type == 3 && header.bits == 8;
}

using Texel = std::array<std::uint8_t, 4>;

Texel colour_of(const std::uint8_t* bytes, int bits, bool has_alpha) {
  if (bits >= 24) return {bytes[2], bytes[1], bytes[0], bits == 32 && has_alpha ? bytes[3] : std::uint8_t{255}};
  const int packed = bytes[0] | bytes[1] << 8;
  const auto wide = [&](int shift) {
    const int five = packed >> shift & 31;
    return static_cast<std::uint8_t>(five << 3 | five >> 2);
  };
  return {wide(10), wide(5), wide(0), 255};
}

/// Gives texels in the file's order. Running out of bytes is remembered.
class TexelStream {
 public:
  TexelStream(const TgaHeader& header, ByteView map, ByteView data) : header_(header), map_(map), data_(data) {}

  Texel next() {
    if (!header_.is_run_length) return read();
    if (left_ == 0) {
      if (data_.empty()) return cut_off();
      is_repeated_ = (data_[0] & 0x80) != 0;
      left_ = 1 + (data_[0] & 0x7f);
      data_ = data_.subspan(1);
      if (is_repeated_) repeated_ = read();
    }
    --left_;
    return is_repeated_ ? repeated_ : read();
  }
  bool is_cut_off() const { return is_cut_off_; }

 private:
  Texel cut_off() {
    is_cut_off_ = true;
    return {0, 0, 0, 255};
  }
  Texel read() {
    if (data_.size() < header_.pixel_bytes()) return cut_off();
    const std::uint8_t* bytes = data_.data();
    data_ = data_.subspan(header_.pixel_bytes());
    if (header_.is_grey) return {bytes[0], bytes[0], bytes[0], 255};
    if (!header_.is_mapped) return colour_of(bytes, header_.bits, header_.alpha_bits > 0);
    const std::size_t index = static_cast<std::size_t>(header_.bits == 16 ? bytes[0] | bytes[1] << 8 : bytes[0]);
    const std::size_t at = (index - header_.map_first) * header_.map_entry_bytes();
    if (index < header_.map_first || at >= map_.size()) return {0, 0, 0, 255};
    return colour_of(map_.data() + at, header_.map_bits, header_.alpha_bits > 0);
  }

  const TgaHeader& header_;
  ByteView map_, data_;
  int left_ = 0;  // of the packet
  bool is_repeated_ = false, is_cut_off_ = false;
  Texel repeated_{};
};

void flip_rows(TextureImage& image) {
  const std::size_t row_bytes = std::size_t{4} * static_cast<std::size_t>(image.width);
  for (int low = 0, high = image.height - 1; low < high; ++low, --high) {
    std::uint8_t* row = image.rgba.data() + static_cast<std::size_t>(low) * row_bytes;
    std::swap_ranges(row, row + row_bytes, image.rgba.data() + static_cast<std::size_t>(high) * row_bytes);
  }
}

void repair_alpha(TextureImage& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
    if (image.rgba[i] != 0) return;
  }
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
}

}  // namespace

bool looks_like_tga(ByteView file_bytes) {
  TgaHeader header;
  return read_header(file_bytes, header);
}

Result<TextureImage> decode_tga(ByteView file_bytes) {
  TgaHeader header;
  if (!read_header(file_bytes, header)) return fail(ErrorCode::kBadData, "not a TGA image that can be read; convert it");
  const std::size_t map_at = kHeaderBytes + header.id_bytes;
  const std::size_t map_bytes = header.has_map ? header.map_entries * header.map_entry_bytes() : 0;
  const std::size_t texels = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  // The fewest bytes that can hold so many texels: checked before memory is taken for them.
  const std::size_t least = header.is_run_length ? (texels + 127) / 128 * (1 + header.pixel_bytes()) : texels * header.pixel_bytes();
  if (file_bytes.size() < map_at + map_bytes + least) {
    return fail(ErrorCode::kBadData, "a TGA image of {} x {} that ends early; copy it again", header.width, header.height);
  }
  TexelStream stream(header, file_bytes.subspan(map_at, map_bytes), file_bytes.subspan(map_at + map_bytes));
  RowReducer reducer(header.width, header.height, reduction_factor(std::max(header.width, header.height), kMaxTextureFileEdge));
  std::vector<std::uint8_t> row(std::size_t{4} * static_cast<std::size_t>(header.width));
  for (int y = 0; y < header.height && !stream.is_cut_off(); ++y) {
    for (int x = 0; x < header.width; ++x) {
      const Texel texel = stream.next();
      const int column = header.is_right_to_left ? header.width - 1 - x : x;
      std::copy(texel.begin(), texel.end(), row.begin() + 4 * static_cast<std::ptrdiff_t>(column));
    }
    reducer.add_row(row.data());
  }
  if (stream.is_cut_off()) {
    return fail(ErrorCode::kBadData, "a TGA image of {} x {} that ends early; copy it again", header.width, header.height);
  }
  TextureImage image = reducer.take();
  if (!header.is_top_down) flip_rows(image);
  repair_alpha(image);
  return image;
}

}  // namespace farfield
