// SPDX-License-Identifier: Apache-2.0
// Format: one range-coded stream; per surface a bit "one of the last colours" with its place in a move-to-front list of
// eight as three bits, else three differences from the colour before: green, red less green's, blue less green's, in steps of kStep.
#include "common/codec/surface_colours.h"

#include <algorithm>
#include <array>

#include "common/codec/bit_coder.h"
#include "common/impostor/tile_neighbours.h"

namespace farfield {
namespace {

constexpr int kStep = 4;  // finer steps cost more here than the difference costs in the image
constexpr int kLevels = 256 / kStep;
constexpr int kRecent = 8;

using Base = std::array<int, 3>;  // in steps

// The colours used last, newest first. Both sides keep it alike.
class RecentColours {
 public:
  int find(const Base& colour) const {
    const auto at = std::find(list_.begin(), list_.end(), colour);
    return at == list_.end() ? -1 : static_cast<int>(at - list_.begin());
  }
  const Base& operator[](int place) const { return list_[place]; }
  void use(const Base& colour) {
    auto at = std::find(list_.begin(), list_.end(), colour);
    if (at == list_.end()) --at;  // the oldest goes
    std::move_backward(list_.begin(), at, at + 1);
    list_.front() = colour;
  }

 private:
  std::array<Base, kRecent> list_{};
};

struct Contexts {
  BitContext is_recent;
  std::array<BitContext, kRecent> place;
  std::array<IntegerContext, 3> difference;
};

std::array<int, 3> difference_of(const Base& a, const Base& b) {
  const int green = a[1] - b[1];
  return {green, a[0] - b[0] - green, a[2] - b[2] - green};
}
Base sum_of(const Base& b, const std::array<int, 3>& d) {
  const auto level = [](int value) { return std::clamp(value, 0, kLevels - 1); };
  return {level(b[0] + d[1] + d[0]), level(b[1] + d[0]), level(b[2] + d[2] + d[0])};
}

void put_bases(const std::vector<Base>& bases, BitEncoder& coder) {
  Contexts contexts;
  RecentColours recent;
  for (const Base& base : bases) {
    const int place = recent.find(base);
    coder.put(place >= 0, contexts.is_recent);
    if (place >= 0) {
      int node = 1;
      for (int bit = 2; bit >= 0; --bit) {
        const int value = place >> bit & 1;
        coder.put(value != 0, contexts.place[node]);
        node = node * 2 + value;
      }
    } else {
      const auto difference = difference_of(base, recent[0]);
      for (int c = 0; c < 3; ++c) put_integer(coder, difference[c], contexts.difference[c]);
    }
    recent.use(base);
  }
}

std::vector<Base> get_bases(ByteView bytes, std::int32_t count) {
  BitDecoder coder(bytes);
  Contexts contexts;
  RecentColours recent;
  std::vector<Base> bases(static_cast<std::size_t>(count));
  for (Base& base : bases) {
    if (coder.get(contexts.is_recent)) {
      int node = 1;
      for (int bit = 0; bit < 3; ++bit) node = node * 2 + coder.get(contexts.place[node]);
      base = recent[node - kRecent];
    } else {
      std::array<int, 3> difference;
      for (int c = 0; c < 3; ++c) difference[c] = std::clamp(get_integer(coder, contexts.difference[c]), -2 * kLevels, 2 * kLevels);
      base = sum_of(recent[0], difference);
    }
    recent.use(base);
  }
  return bases;
}

struct ColourRange {
  std::array<std::uint32_t, 3> sum{};
  std::array<std::uint8_t, 3> low{255, 255, 255}, high{};
  std::uint32_t samples = 0;
};

Base base_of(const ColourRange& range) {
  Base base;
  for (int c = 0; c < 3; ++c) {
    const int mean = static_cast<int>((range.sum[c] + range.samples / 2) / range.samples);
    const int value = std::clamp(mean, std::min(range.high[c] - 127, range.low[c] + 128), range.low[c] + 128);
    base[c] = std::clamp((value + kStep / 2) / kStep, 0, kLevels - 1);
  }
  return base;
}

}  // namespace

Surfaces find_surfaces(const Tile& tile) {
  // Union-find over the tile in raster order; the root of a set is its first sample.
  const TileNeighbours neighbours(tile);
  const auto size = static_cast<std::int32_t>(tile.samples());
  std::vector<std::int32_t> parent(static_cast<std::size_t>(size));
  const auto root_of = [&](std::int32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto join = [&](std::int32_t a, std::int32_t b) {
    a = root_of(a), b = root_of(b);
    parent[std::max(a, b)] = std::min(a, b);
  };
  for (std::int32_t i = 0; i < size; ++i) parent[i] = i;
  for (std::int32_t i = 0; i < size; ++i) {
    if (!tile.coverage[i]) continue;
    if (const int right = neighbours.right(i); right >= 0 && tile.coverage[right] && tile.cut_right[i] == kConnected) join(i, right);
    if (const int down = neighbours.down(i); down >= 0 && tile.coverage[down] && tile.cut_down[i] == kConnected) join(i, down);
  }
  Surfaces surfaces;
  surfaces.of_sample.assign(static_cast<std::size_t>(size), -1);
  for (std::int32_t i = 0; i < size; ++i) {
    if (!tile.coverage[i]) continue;
    const std::int32_t root = root_of(i);
    surfaces.of_sample[i] = root == i ? surfaces.count++ : surfaces.of_sample[root];
  }
  return surfaces;
}

Bytes take_out_base_colours(const Surfaces& surfaces, std::vector<std::uint8_t>& rgb) {
  std::vector<ColourRange> ranges(static_cast<std::size_t>(surfaces.count));
  for (std::size_t i = 0; i < surfaces.of_sample.size(); ++i) {
    if (surfaces.of_sample[i] < 0) continue;
    ColourRange& range = ranges[surfaces.of_sample[i]];
    ++range.samples;
    for (int c = 0; c < 3; ++c) {
      const std::uint8_t value = rgb[3 * i + c];
      range.sum[c] += value;
      range.low[c] = std::min(range.low[c], value), range.high[c] = std::max(range.high[c], value);
    }
  }
  std::vector<Base> bases;
  bases.reserve(ranges.size());
  for (const ColourRange& range : ranges) bases.push_back(base_of(range));
  for (std::size_t i = 0; i < surfaces.of_sample.size(); ++i) {
    const std::int32_t surface = surfaces.of_sample[i];
    for (int c = 0; c < 3; ++c)
      rgb[3 * i + c] = surface < 0 ? 128 : static_cast<std::uint8_t>(std::clamp(rgb[3 * i + c] - kStep * bases[surface][c] + 128, 0, 255));
  }
  BitEncoder coder;
  put_bases(bases, coder);
  return coder.finish();
}

void put_back_base_colours(ByteView bytes, const Surfaces& surfaces, std::vector<std::uint8_t>& rgb) {
  const std::vector<Base> bases = get_bases(bytes, surfaces.count);
  for (std::size_t i = 0; i < surfaces.of_sample.size(); ++i) {
    if (surfaces.of_sample[i] < 0) continue;
    for (int c = 0; c < 3; ++c)
      rgb[3 * i + c] = static_cast<std::uint8_t>(std::clamp(rgb[3 * i + c] + kStep * bases[surfaces.of_sample[i]][c] - 128, 0, 255));
  }
}

}  // namespace farfield
