// SPDX-License-Identifier: Apache-2.0
// Format: one range-coded stream; per surface a bit "one of the last colours" with its place in a move-to-front list of
// eight as three bits, else three differences from the colour before: green, red less green's, blue less green's, in steps of kStep.
#include "common/codec/surface_colours.h"

#include <algorithm>
#include <array>
#include <bit>

#include "common/codec/bit_coder.h"

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

// Samples of a run that are taken at once, and their bytes.
constexpr int kTogether = 8, kBytes = 3 * kTogether;

struct ColourRange {
  std::array<std::uint32_t, 3> sum{};
  std::array<std::uint8_t, 3> low{255, 255, 255}, high{};
  std::uint32_t samples = 0;

  // Requires: count of one run, so that lanes of 16 bits hold its sums.
  void add(const std::uint8_t* rgb, int count) {
    static_assert(kTileSamples / kTogether * 255 <= 0xffff);
    samples += static_cast<std::uint32_t>(count);
    int i = 0;
    if (count >= kTogether) {
      std::array<std::uint16_t, kBytes> sums{};
      std::array<std::uint8_t, kBytes> least, most{};
      least.fill(255);
      for (; i + kTogether <= count; i += kTogether)
        for (int k = 0; k < kBytes; ++k) {
          const std::uint8_t value = rgb[3 * i + k];
          sums[k] = static_cast<std::uint16_t>(sums[k] + value);
          least[k] = std::min(least[k], value), most[k] = std::max(most[k], value);
        }
      for (int k = 0; k < kBytes; ++k) {
        sum[k % 3] += sums[k];
        low[k % 3] = std::min(low[k % 3], least[k]), high[k % 3] = std::max(high[k % 3], most[k]);
      }
    }
    for (; i < count; ++i)
      for (int c = 0; c < 3; ++c) {
        const std::uint8_t value = rgb[3 * i + c];
        sum[c] += value;
        low[c] = std::min(low[c], value), high[c] = std::max(high[c], value);
      }
  }
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

// Adds one difference to all samples of a run, clamped.
void shift_run(const std::uint8_t* from, int count, const std::array<int, 3>& difference, std::uint8_t* to) {
  std::array<std::int16_t, kBytes> differences;
  for (std::size_t k = 0; k < differences.size(); ++k) differences[k] = static_cast<std::int16_t>(difference[k % 3]);
  const auto shifted = [](std::uint8_t value, std::int16_t by) {
    const std::int16_t sum = static_cast<std::int16_t>(value + by);
    return static_cast<std::uint8_t>(sum < 0 ? 0 : sum > 255 ? 255 : sum);
  };
  int i = 0;
  for (; i + kTogether <= count; i += kTogether)
    for (int k = 0; k < kBytes; ++k) to[3 * i + k] = shifted(from[3 * i + k], differences[k]);
  for (; i < count; ++i)
    for (int c = 0; c < 3; ++c) to[3 * i + c] = shifted(from[3 * i + c], differences[c]);
}

// Union-find over runs: the root of a set is its first run.
class RunSets {
 public:
  void add() { parent_.push_back(static_cast<std::int32_t>(parent_.size())); }
  std::int32_t root_of(std::int32_t run) {
    while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
    return run;
  }
  void join(std::int32_t a, std::int32_t b) {
    a = root_of(a), b = root_of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

// The runs of a tile, each of joined samples. In packed tiles a run ends with its block: the next in the image may lie
// elsewhere on the face.
std::vector<Surfaces::Run> find_runs(const Tile& tile, const TileBits& bits, const std::vector<std::uint64_t>& joined_right) {
  const BlockGrid& grid = bits.grid();
  std::vector<Surfaces::Run> runs;
  for (int y = 0; y < tile.height; ++y) {
    bool goes_on = false;  // the last run reaches into this block
    for (int column = 0; column < grid.columns(); ++column) {
      const int block = y / kBlockSamples * grid.columns() + column, shift = y % kBlockSamples * kBlockSamples;
      const unsigned joined = joined_right[block] >> shift & 0xff;
      for (unsigned covered = bits[block].covered >> shift & 0xff; covered != 0;) {
        const int x = std::countr_zero(covered), count = std::min(std::countr_one(joined >> x) + 1, kBlockSamples - x);
        if (!goes_on) runs.push_back({y * tile.width + column * kBlockSamples + x, 0, -1});
        runs.back().count += count;
        goes_on = !tile.is_packed() && x + count == kBlockSamples && joined >> 7;
        covered = covered >> (x + count) << (x + count);
      }
    }
  }
  return runs;
}

}  // namespace

Surfaces find_surfaces(const Tile& tile, const TileBits& bits) {
  const BlockGrid& grid = bits.grid();
  std::vector<std::uint64_t> joined_right(static_cast<std::size_t>(grid.size()));
  for (int block = 0; block < grid.size(); ++block) joined_right[block] = bits.joined_right(block);
  Surfaces surfaces;
  surfaces.runs = find_runs(tile, bits, joined_right);
  std::vector<std::int32_t>& run_of = surfaces.of_sample;  // until the runs are joined
  run_of.assign(tile.samples(), -1);
  RunSets sets;
  for (std::size_t run = 0; run < surfaces.runs.size(); ++run) {
    sets.add();
    std::fill_n(&run_of[surfaces.runs[run].first], surfaces.runs[run].count, static_cast<std::int32_t>(run));
  }
  // Index of sample k of a block.
  const auto sample = [&](int block, int k) { return grid.first_sample(block) + k / kBlockSamples * tile.width + k % kBlockSamples; };
  for (int block = 0; block < grid.size(); ++block) {
    const BlockGrid::Beside& beside = grid.beside(block);
    const std::uint64_t below = bits.joined_below(block), right = joined_right[block];
    // Two runs that touch in several samples in a row are joined at the first.
    const std::uint64_t again = below & right & bits_below(right, beside.below < 0 ? 0 : joined_right[beside.below]);
    for (std::uint64_t todo = below & ~(again << 1 & ~kFirstColumn); todo != 0; todo &= todo - 1) {
      const int k = std::countr_zero(todo);
      sets.join(run_of[sample(block, k)], run_of[k < 56 ? sample(block, k + 8) : sample(beside.below, k - 56)]);
    }
    if (!tile.is_packed()) continue;
    for (std::uint64_t todo = right & kLastColumn; todo != 0; todo &= todo - 1) {
      const int k = std::countr_zero(todo);
      sets.join(run_of[sample(block, k)], run_of[sample(beside.right, k - 7)]);
    }
  }
  for (std::size_t run = 0; run < surfaces.runs.size(); ++run) {
    Surfaces::Run& own = surfaces.runs[run];
    const auto root = static_cast<std::size_t>(sets.root_of(static_cast<std::int32_t>(run)));
    own.surface = root == run ? surfaces.count++ : surfaces.runs[root].surface;
    std::fill_n(&surfaces.of_sample[own.first], own.count, own.surface);
  }
  return surfaces;
}

Bytes take_out_base_colours(const Surfaces& surfaces, std::vector<std::uint8_t>& rgb) {
  std::vector<ColourRange> ranges(static_cast<std::size_t>(surfaces.count));
  for (const Surfaces::Run& run : surfaces.runs) ranges[run.surface].add(&rgb[3 * std::size_t(run.first)], run.count);
  std::vector<Base> bases;
  bases.reserve(ranges.size());
  for (const ColourRange& range : ranges) bases.push_back(base_of(range));
  std::vector<std::uint8_t> left(rgb.size(), 128);
  for (const Surfaces::Run& run : surfaces.runs) {
    const Base& base = bases[run.surface];
    shift_run(&rgb[3 * std::size_t(run.first)], run.count, {128 - kStep * base[0], 128 - kStep * base[1], 128 - kStep * base[2]},
              &left[3 * std::size_t(run.first)]);
  }
  rgb = std::move(left);
  BitEncoder coder;
  put_bases(bases, coder);
  return coder.finish();
}

void put_back_base_colours(ByteView bytes, const Surfaces& surfaces, std::vector<std::uint8_t>& rgb) {
  const std::vector<Base> bases = get_bases(bytes, surfaces.count);
  for (const Surfaces::Run& run : surfaces.runs) {
    const Base& base = bases[run.surface];
    std::uint8_t* first = &rgb[3 * std::size_t(run.first)];
    shift_run(first, run.count, {kStep * base[0] - 128, kStep * base[1] - 128, kStep * base[2] - 128}, first);
  }
}

}  // namespace farfield
