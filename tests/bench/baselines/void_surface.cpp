// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/void_surface.h"

#include <algorithm>

namespace farfield::bench {

ViewAdjacency connect_view(const FarView& view, std::span<const FarView* const> others) {
  ViewAdjacency adjacency;
  for (const FarFace& face : view.faces) adjacency.push_back(connect_surfaces(face, others));
  return adjacency;
}

VoidMeter::VoidMeter(const glm::dvec3& viewpoint, double side_m, int edge)
    : viewpoint_(viewpoint), side_m_(side_m), edge_(edge), surface_(static_cast<std::size_t>(kCubeFaces * edge * edge), 0.0f),
      nearest_skin_(surface_) {}

VoidMeter::Corner VoidMeter::corner_of(const FarFace& face, int i, int j, const glm::dvec3& shift) const {
  const double disparity = face.disparity[face.at(i, j)];
  Corner corner{face.frame.direction(i, j) + shift * disparity, disparity};
  corner.face = dominant_face(corner.q);
  const CubeFace frame = CubeFace::of(corner.face);
  const double per_unit = 0.5 * edge_ / std::abs(corner.q[frame.axis]);
  corner.x = static_cast<float>(corner.q[frame.u_axis()] * per_unit + 0.5 * edge_ - 0.5);
  corner.y = static_cast<float>(corner.q[frame.v_axis()] * per_unit + 0.5 * edge_ - 0.5);
  return corner;
}

// Most quads of samples are: the picture is the coarser of the two.
bool VoidMeter::is_between_pixels(const Corner& a, const Corner& b, const Corner& c, const Corner& d) const {
  if (a.face != b.face || a.face != c.face || a.face != d.face) return false;
  const auto [low_x, high_x] = std::minmax({a.x, b.x, c.x, d.x});
  const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y, d.y});
  constexpr float kRounding = 1e-3f;  // of pixels' places up to some thousands
  return std::ceil(low_x - kRounding) > high_x + kRounding || std::ceil(low_y - kRounding) > high_y + kRounding;
}

void VoidMeter::add(const FarView& sample, const ViewAdjacency& adjacency) {
  Picture skins(surface_.size(), 0.0f);
  const glm::dvec3 shift = (sample.position - viewpoint_) / side_m_;
  for (const FarFace& face : sample.faces) {
    const Adjacency& joined = adjacency[static_cast<std::size_t>(face.face)];
    using A = Adjacency;
    std::vector<Corner> above(static_cast<std::size_t>(face.edge())), below(above.size());
    for (int i = 0; i < face.edge(); ++i) below[static_cast<std::size_t>(i)] = corner_of(face, i, 0, shift);
    for (int j = 0; j + 1 < face.edge(); ++j) {
      std::swap(above, below);
      for (int i = 0; i < face.edge(); ++i) below[static_cast<std::size_t>(i)] = corner_of(face, i, j + 1, shift);
      for (int i = 0; i + 1 < face.edge(); ++i) {
        const auto left = static_cast<std::size_t>(i), right = left + 1;
        const Corner &a = above[left], &b = above[right], &c = below[left], &d = below[right];
        if (!(a.disparity + b.disparity + c.disparity + d.disparity > 0)) continue;  // open sky hides nothing
        if (is_between_pixels(a, b, c, d)) continue;
        const bool across = joined.is_connected(i + 1, j, A::kDownLeft);
        const bool upper = across && joined.is_connected(i, j, A::kRight) && joined.is_connected(i, j, A::kDown);
        const bool lower = across && joined.is_connected(i, j + 1, A::kRight) && joined.is_connected(i + 1, j, A::kDown);
        draw(a, b, c, upper ? surface_ : skins);
        draw(b, c, d, lower ? surface_ : skins);
      }
    }
  }
  for (std::size_t k = 0; k < skins.size(); ++k) nearest_skin_[k] = is_first_ ? skins[k] : std::min(nearest_skin_[k], skins[k]);
  is_first_ = false;
}

void VoidMeter::draw(const Corner& a, const Corner& b, const Corner& c, Picture& picture) const {
  if (a.face == b.face && b.face == c.face) {
    draw_on(a.face, a, b, c, picture);
    return;
  }
  for (int face = 0; face < kCubeFaces; ++face) draw_on(face, a, b, c, picture);
}

// A pixel's direction g is a combination of the corners with weights M⁻¹g, M = (a b c): none negative inside. The same
// weights give the disparity, which is linear in g.
void VoidMeter::draw_on(int face, const Corner& a, const Corner& b, const Corner& c, Picture& picture) const {
  const CubeFace frame = CubeFace::of(face);
  const auto turned = [&](const glm::dvec3& q) { return glm::dvec3(q[frame.u_axis()], q[frame.v_axis()], frame.sign * q[frame.axis]); };
  const glm::dvec3 p = turned(a.q), q = turned(b.q), r = turned(c.q);
  int x0 = 0, x1 = edge_ - 1, y0 = 0, y1 = edge_ - 1;
  if (p.z <= 0 && q.z <= 0 && r.z <= 0) return;
  if (p.z > 0 && q.z > 0 && r.z > 0) {
    const auto [low_u, high_u] = std::minmax({p.x / p.z, q.x / q.z, r.x / r.z});
    const auto [low_v, high_v] = std::minmax({p.y / p.z, q.y / q.z, r.y / r.z});
    const auto pixel = [&](double t) { return std::clamp((t + 1) * 0.5 * edge_ - 0.5, -1.0, static_cast<double>(edge_)); };
    x0 = std::max(x0, static_cast<int>(std::ceil(pixel(low_u)))), x1 = std::min(x1, static_cast<int>(std::floor(pixel(high_u))));
    y0 = std::max(y0, static_cast<int>(std::ceil(pixel(low_v)))), y1 = std::min(y1, static_cast<int>(std::floor(pixel(high_v))));
    if (x0 > x1 || y0 > y1) return;  // between pixels, as most are
  }
  glm::dvec3 wa = glm::cross(q, r), wb = glm::cross(r, p), wc = glm::cross(p, q);
  const double volume = glm::dot(p, wa);
  if (volume == 0.0) return;  // seen exactly edge-on: covers nothing
  wa /= volume, wb /= volume, wc /= volume;
  const glm::dvec3 disparity = a.disparity * wa + b.disparity * wb + c.disparity * wc;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const glm::dvec3 g((x + 0.5) * 2 / edge_ - 1, (y + 0.5) * 2 / edge_ - 1, 1);
      if (glm::dot(g, wa) < 0 || glm::dot(g, wb) < 0 || glm::dot(g, wc) < 0) continue;
      float& at = picture[static_cast<std::size_t>((face * edge_ + y) * edge_ + x)];
      at = std::max(at, static_cast<float>(glm::dot(g, disparity)));
    }
}

double VoidMeter::solid_angle() const {
  const double pitch = 2.0 / edge_;
  double sum = 0;
  for (int face = 0; face < kCubeFaces; ++face)
    for (int y = 0; y < edge_; ++y)
      for (int x = 0; x < edge_; ++x) {
        const auto at = static_cast<std::size_t>((face * edge_ + y) * edge_ + x);
        // A skin begins at the surface it leaves: only what stands off by a pixel's parallax hides anything.
        if (nearest_skin_[at] > 0 && nearest_skin_[at] > surface_[at] + static_cast<float>(pitch / 4)) {
          sum += sample_solid_angle(-1 + (x + 0.5) * pitch, -1 + (y + 0.5) * pitch, pitch);
        }
      }
  return sum;
}

}  // namespace farfield::bench
