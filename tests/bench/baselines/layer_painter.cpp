// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/layer_painter.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>

#include "client/gl/view_transform.h"

namespace farfield::bench {
namespace {

constexpr int kSquare = 32;
constexpr int kBands = 16;
constexpr std::size_t kRunsPerChunk = 64;

glm::dvec3 face_axis(const ViewFrame& frame) {
  glm::dvec3 axis(0);
  axis[frame.face.axis] = frame.face.sign;
  return axis;
}

glm::dmat3 camera_from_face(const ViewFrame& frame, const Pose& eye) {
  const glm::dmat3 camera_from_scene = glm::transpose(glm::dmat3(glm::mat3_cast(eye.world_from_camera)));
  return {camera_from_scene[frame.face.u_axis()], camera_from_scene[frame.face.v_axis()], frame.face.sign * camera_from_scene[frame.face.axis]};
}

}  // namespace

void LayerPainter::set_cell(const LayeredCell& cell) {
  cell_ = &cell;
  squares_.clear();
  for (int f = 0; f < kCubeFaces; ++f) {
    const LayeredFace& face = cell[static_cast<std::size_t>(f)];
    const int edge = face.frame.edge_samples;
    for (int j = 0; j < edge; j += kSquare)
      for (int i = 0; i < edge; i += kSquare) {
        Square square{f, i, std::min(i + kSquare, edge), j, std::min(j + kSquare, edge), 1e30f, 0};
        for (int y = square.j0; y < square.j1; ++y) {
          const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(edge);
          const std::uint32_t begin = face.first[row + static_cast<std::size_t>(i)], end = face.first[row + static_cast<std::size_t>(square.i1)];
          for (std::uint32_t s = begin; s < end; ++s)
            square.low = std::min(square.low, face.samples[s].disparity), square.high = std::max(square.high, face.samples[s].disparity);
        }
        if (square.low <= square.high) squares_.push_back(square);
      }
  }
}

// The order of McMillan and Bishop. A point seen in direction (u, v, 1) that moves towards the eye at e, relative to the
// images' centre, changes its u with the sign of e_u - u·e_w: columns where that is positive are drawn with u rising,
// so that of points on one ray from the eye the nearest comes last. The two signs divide columns, and likewise rows:
// his four sheets. Between images: where two meet, the plane between them has the normal a - b (their axes), and
// what the eye's side of it shows comes later, so images are drawn by rising e·a.
std::vector<LayerPainter::Run> LayerPainter::ordered_runs(const Pose& eye, const Display& display) const {
  const client::ViewTransform view = client::ViewTransform::of(display, eye, 0.01);
  std::array<int, kCubeFaces> order;
  std::iota(order.begin(), order.end(), 0);
  const auto nearness = [&](int f) {
    const ViewFrame& frame = (*cell_)[static_cast<std::size_t>(f)].frame;
    return glm::dot(eye.position - frame.position, face_axis(frame));
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return nearness(a) < nearness(b); });
  std::vector<Run> runs;
  for (const int f : order) {
    const ViewFrame& frame = (*cell_)[static_cast<std::size_t>(f)].frame;
    const glm::dvec3 e = eye.position - frame.position;
    const double e_w = frame.face.sign * e[frame.face.axis];
    const auto is_rising = [&](int axis, int index) { return e[axis] - frame.u(index) * e_w > 0; };
    const auto split = [&](int axis) {  // the first index whose sign differs from that of 0
      int first = 0;
      while (first < frame.edge_samples && is_rising(axis, first) == is_rising(axis, 0)) ++first;
      return first;
    };
    const int split_i = split(frame.face.u_axis()), split_j = split(frame.face.v_axis());
    const glm::dmat3 matrix = camera_from_face(frame, eye);
    const glm::dvec3 shift = view.camera_from_scene * (-e / frame.side_m);
    std::array<std::vector<Run>, 4> sheets;
    for (const Square& square : squares_) {
      if (square.face != f) continue;
      const glm::dvec3 middle{frame.u(0.5 * (square.i0 + square.i1 - 1)), frame.u(0.5 * (square.j0 + square.j1 - 1)), 0.5 * (square.low + square.high)};
      const double half_u = 0.5 * (square.i1 - square.i0) * frame.pitch, half_v = 0.5 * (square.j1 - square.j0) * frame.pitch;
      const client::AffineBox box{matrix * glm::dvec3(middle.x, middle.y, 1) + middle.z * shift,
                                  glm::dmat3(matrix[0] * half_u, matrix[1] * half_v, shift * (0.5 * (square.high - square.low)))};
      if (!view.may_see(box)) continue;
      for (int sheet = 0; sheet < 4; ++sheet) {
        Run run{f, square.i0, square.i1, square.j0, square.j1, true, true};
        (sheet % 2 ? run.i0 : run.i1) = std::clamp(split_i, square.i0, square.i1);
        (sheet / 2 ? run.j0 : run.j1) = std::clamp(split_j, square.j0, square.j1);
        if (run.i0 >= run.i1 || run.j0 >= run.j1) continue;
        run.is_i_rising = is_rising(frame.face.u_axis(), run.i0), run.is_j_rising = is_rising(frame.face.v_axis(), run.j0);
        sheets[static_cast<std::size_t>(sheet)].push_back(run);
      }
    }
    for (std::vector<Run>& sheet : sheets) {
      std::sort(sheet.begin(), sheet.end(), [](const Run& a, const Run& b) {
        if (a.j0 != b.j0) return a.is_j_rising ? a.j0 < b.j0 : a.j0 > b.j0;
        return a.is_i_rising ? a.i0 < b.i0 : a.i0 > b.i0;
      });
      runs.insert(runs.end(), sheet.begin(), sheet.end());
    }
  }
  return runs;
}

std::size_t LayerPainter::warp(const Run& run, const Pose& eye, const Display& display, int band_rows, std::vector<Band>& bands) const {
  const LayeredFace& face = (*cell_)[static_cast<std::size_t>(run.face)];
  const ViewFrame& frame = face.frame;
  const glm::mat3 matrix(camera_from_face(frame, eye));
  const glm::dmat3 camera_from_scene = glm::transpose(glm::dmat3(glm::mat3_cast(eye.world_from_camera)));
  const glm::vec3 shift(camera_from_scene * ((frame.position - eye.position) / frame.side_m));
  const float per_tangent = static_cast<float>(1 / display.pixel_pitch()), per_side = static_cast<float>(1 / frame.side_m);
  const float middle_x = 0.5f * static_cast<float>(display.width), middle_y = 0.5f * static_cast<float>(display.height);
  const int reach = options_.splat_radius;
  std::size_t warped = 0;
  for (int row = 0; row < run.j1 - run.j0; ++row) {
    const int j = run.is_j_rising ? run.j0 + row : run.j1 - 1 - row;
    const glm::vec3 row_direction = matrix[2] + static_cast<float>(frame.u(j)) * matrix[1];
    for (int column = 0; column < run.i1 - run.i0; ++column) {
      const int i = run.is_i_rising ? run.i0 + column : run.i1 - 1 - column;
      const std::size_t pixel = static_cast<std::size_t>(j) * static_cast<std::size_t>(frame.edge_samples) + static_cast<std::size_t>(i);
      const glm::vec3 direction = row_direction + static_cast<float>(frame.u(i)) * matrix[0];
      for (std::uint32_t s = face.first[pixel + 1]; s-- > face.first[pixel];) {  // back to front
        const LayeredSample& sample = face.samples[s];
        const glm::vec3 q = direction + sample.disparity * shift;
        if (!(q.z < 0)) continue;
        ++warped;
        const float inverse_w = -1.0f / q.z;
        const float fx = middle_x + q.x * inverse_w * per_tangent, fy = middle_y - q.y * inverse_w * per_tangent;
        if (!(fx > -2 && fy > -2 && fx < static_cast<float>(display.width + 2) && fy < static_cast<float>(display.height + 2))) continue;
        const int x = static_cast<int>(std::floor(fx)), y = static_cast<int>(std::floor(fy));
        const Splat splat{static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                          sample.r | std::uint32_t{sample.g} << 8 | std::uint32_t{sample.b} << 16, sample.disparity * per_side * inverse_w};
        const int first = std::max(0, y - reach) / band_rows, last = std::min(display.height - 1, y + reach) / band_rows;
        for (int band = first; band <= last; ++band) bands[static_cast<std::size_t>(band)].push_back(splat);
      }
    }
  }
  return warped;
}

void LayerPainter::draw(const Band& band, int first_row, int last_row, client::Frame& frame) const {
  const int reach = options_.splat_radius;
  for (const Splat& splat : band)
    for (int y = std::max(first_row, splat.y - reach); y <= std::min(last_row - 1, splat.y + reach); ++y)
      for (int x = std::max(0, splat.x - reach); x <= std::min(frame.width - 1, splat.x + reach); ++x) {
        const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(x);
        if (frame.coverage[at] == client::Coverage::kNear) continue;
        if (options_.has_depth_buffer && frame.coverage[at] == client::Coverage::kImpostor && frame.disparity[at] >= splat.disparity) continue;
        frame.coverage[at] = client::Coverage::kImpostor;
        frame.disparity[at] = splat.disparity;
        std::uint8_t* rgba = &frame.rgba[4 * at];
        rgba[0] = static_cast<std::uint8_t>(splat.colour), rgba[1] = static_cast<std::uint8_t>(splat.colour >> 8);
        rgba[2] = static_cast<std::uint8_t>(splat.colour >> 16), rgba[3] = 255;
      }
}

std::size_t LayerPainter::paint(const Pose& eye, const Display& display, client::Frame& frame) {
  const std::vector<Run> runs = ordered_runs(eye, display);
  const int band_rows = (display.height + kBands - 1) / kBands;
  const std::size_t chunk_count = (runs.size() + kRunsPerChunk - 1) / kRunsPerChunk;
  if (chunks_.size() < chunk_count) chunks_.resize(chunk_count);
  std::atomic<std::size_t> warped{0};
  tbb::parallel_for(std::size_t{0}, chunk_count, [&](std::size_t c) {
    chunks_[c].resize(kBands);
    for (Band& band : chunks_[c]) band.clear();
    const std::size_t end = std::min(runs.size(), (c + 1) * kRunsPerChunk);
    for (std::size_t r = c * kRunsPerChunk; r < end; ++r) warped += warp(runs[r], eye, display, band_rows, chunks_[c]);
  });
  tbb::parallel_for(0, kBands, [&](int b) {
    for (std::size_t c = 0; c < chunk_count; ++c)
      draw(chunks_[c][static_cast<std::size_t>(b)], b * band_rows, std::min((b + 1) * band_rows, display.height), frame);
  });
  return warped;
}

}  // namespace farfield::bench
