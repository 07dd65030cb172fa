// SPDX-License-Identifier: Apache-2.0
#include "server/model/polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace farfield {
namespace {

/// Twice the area vector of a ring (Newell 1972); relative to its first point so that large coordinates cancel.
glm::dvec3 newell_normal(std::span<const glm::dvec3> points, std::span<const std::uint32_t> ring) {
  glm::dvec3 sum(0);
  const glm::dvec3 base = points[ring[0]];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    sum += glm::cross(points[ring[i]] - base, points[ring[(i + 1) % ring.size()]] - base);
  }
  return sum;
}

/// The plane of a polygon as two of the three axes, ordered so that the outer ring runs counter-clockwise.
class Projection {
 public:
  Projection(std::span<const glm::dvec3> points, std::uint32_t base, const glm::dvec3& normal) {
    int drop = 0;
    for (int a = 1; a < 3; ++a) {
      if (std::abs(normal[a]) > std::abs(normal[drop])) drop = a;
    }
    int u = (drop + 1) % 3, v = (drop + 2) % 3;
    if (normal[drop] < 0) std::swap(u, v);
    flat_.reserve(points.size());
    for (const glm::dvec3& p : points) flat_.emplace_back(p[u] - points[base][u], p[v] - points[base][v]);
  }
  const glm::dvec2& operator[](std::uint32_t index) const { return flat_[index]; }

 private:
  std::vector<glm::dvec2> flat_;
};

/// Twice the signed area of abc: positive if it turns left.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool is_inside(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

bool is_same_place(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x == b.x && a.y == b.y;
}

/// Clips ears off one counter-clockwise ring, held as a doubly linked list over ring positions.
class EarClipper {
 public:
  /// Without holes only reflex corners can lie in an ear; twins at bridges make that true of any corner.
  EarClipper(const Projection& flat, std::span<const std::uint32_t> ring, bool has_bridges)
      : flat_(flat), ring_(ring), has_bridges_(has_bridges) {
    const auto count = static_cast<std::uint32_t>(ring.size());
    next_.resize(count), previous_.resize(count), may_block_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) next_[i] = (i + 1) % count, previous_[i] = (i + count - 1) % count;
    for (std::uint32_t i = 0; i < count; ++i) {
      may_block_[i] = has_bridges || corner(i) <= 0;
      if (may_block_[i]) blockers_.push_back(i);
    }
  }

  void run(std::vector<std::uint32_t>& triangles) {
    auto left = static_cast<std::uint32_t>(ring_.size());
    std::uint32_t at = 0, looked_at = 0;
    while (left > 3) {
      const bool is_stuck = looked_at >= left;
      if (is_stuck) at = most_convex(at, left);
      if (is_stuck || is_ear(at)) {
        at = cut(at, triangles);
        --left;
        looked_at = 0;
      } else {
        at = next_[at];
        ++looked_at;
      }
    }
    emit(at, triangles);
  }

 private:
  const glm::dvec2& point(std::uint32_t i) const { return flat_[ring_[i]]; }
  double corner(std::uint32_t i) const { return turn(point(previous_[i]), point(i), point(next_[i])); }

  bool is_ear(std::uint32_t i) const {
    if (corner(i) <= 0) return false;
    for (const std::uint32_t r : blockers_) {
      if (!may_block_[r] || r == previous_[i] || r == i || r == next_[i]) continue;
      if (blocks(r, point(previous_[i]), point(i), point(next_[i]))) return false;
    }
    return true;
  }

  /// Whether corner r keeps abc from being an ear. A bridge visits its two ends twice, so r may be the twin of one of
  /// the three; then it matters only where the ring goes from there.
  bool blocks(std::uint32_t r, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) const {
    const glm::dvec2& p = point(r);
    if (is_same_place(p, a) || is_same_place(p, c)) return false;
    if (!is_same_place(p, b)) return is_inside(p, a, b, c);
    const auto leads_between = [&](const glm::dvec2& q) { return turn(a, b, q) > 0 && turn(b, c, q) > 0; };
    return leads_between(point(previous_[r])) || leads_between(point(next_[r]));
  }

  std::uint32_t most_convex(std::uint32_t at, std::uint32_t left) const {
    std::uint32_t best = at;
    for (std::uint32_t k = 0; k < left; ++k, at = next_[at]) {
      if (corner(at) > corner(best)) best = at;
    }
    return best;
  }

  void emit(std::uint32_t i, std::vector<std::uint32_t>& triangles) const {
    triangles.insert(triangles.end(), {ring_[previous_[i]], ring_[i], ring_[next_[i]]});
  }

  /// Returns: the corner to look at next; one further on, so that ears are taken all round instead of as a fan.
  std::uint32_t cut(std::uint32_t i, std::vector<std::uint32_t>& triangles) {
    emit(i, triangles);
    const std::uint32_t p = previous_[i], n = next_[i];
    next_[p] = n, previous_[n] = p;
    may_block_[i] = false;
    for (const std::uint32_t k : {p, n}) may_block_[k] = may_block_[k] && (has_bridges_ || corner(k) <= 0);
    return next_[n];
  }

  const Projection& flat_;
  std::span<const std::uint32_t> ring_;
  std::vector<std::uint32_t> next_, previous_;
  bool has_bridges_;
  std::vector<char> may_block_;  // by ring position; a corner that became convex stays convex
  std::vector<std::uint32_t> blockers_;
};

/// Whether the ring's inside, at this corner, lies towards p. Tells apart the twins that earlier bridges made.
bool looks_towards(const Projection& flat, const std::vector<std::uint32_t>& ring, std::size_t i, const glm::dvec2& p) {
  const glm::dvec2 &a = flat[ring[(i + ring.size() - 1) % ring.size()]], &v = flat[ring[i]],
                   &b = flat[ring[(i + 1) % ring.size()]];
  if (turn(a, v, b) > 0) return turn(a, v, p) >= 0 && turn(v, b, p) >= 0;
  return turn(a, v, p) > 0 || turn(v, b, p) > 0;
}

/// Where in `ring` to bridge to `hole_point`, the hole's rightmost point (Eberly 1998 §5): the corner that a ray to
/// the right meets, or the reflex corner inside the triangle before it that is nearest in angle.
std::optional<std::size_t> bridge_corner(const Projection& flat, const std::vector<std::uint32_t>& ring,
                                         const glm::dvec2& hole_point) {
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 &a = flat[ring[i]], &b = flat[ring[(i + 1) % ring.size()]];
    // Edges of a counter-clockwise ring that face a point inside it from the right run upwards.
    if (!(a.y <= hole_point.y && b.y >= hole_point.y && b.y > a.y)) continue;
    const double x = a.x + (hole_point.y - a.y) / (b.y - a.y) * (b.x - a.x);
    if (x < hole_point.x || x >= nearest) continue;
    nearest = x;
    best = a.x > b.x ? i : (i + 1) % ring.size();
  }
  if (!best) return std::nullopt;
  const glm::dvec2 hit{nearest, hole_point.y}, corner = flat[ring[*best]];
  const bool is_corner_hit = is_same_place(hit, corner);
  double smallest_slope = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2& p = flat[ring[i]];
    if (p.x <= hole_point.x || !looks_towards(flat, ring, i, hole_point)) continue;
    if (is_corner_hit) {
      if (is_same_place(p, corner)) return i;  // of its twins the one that can be seen
      continue;
    }
    const bool is_in =
        corner.y < hole_point.y ? is_inside(p, hole_point, corner, hit) : is_inside(p, hole_point, hit, corner);
    if (!is_in) continue;
    const double slope = std::abs(p.y - hole_point.y) / (p.x - hole_point.x);
    // Corners in one line with the hole, as in rows of windows: the nearest one hides the others.
    if (slope < smallest_slope || (slope == smallest_slope && p.x < flat[ring[*best]].x))
      smallest_slope = slope, best = i;
  }
  return best;
}

/// Cuts `hole` (clockwise) into `ring` through a bridge walked both ways.
void join_hole(const Projection& flat, std::vector<std::uint32_t>& ring, std::span<const std::uint32_t> hole) {
  std::size_t right = 0;
  for (std::size_t i = 1; i < hole.size(); ++i) {
    if (flat[hole[i]].x > flat[hole[right]].x) right = i;
  }
  const std::optional<std::size_t> corner = bridge_corner(flat, ring, flat[hole[right]]);
  if (!corner) return;  // outside the ring: no hole of this polygon
  std::vector<std::uint32_t> inserted;
  for (std::size_t i = 0; i <= hole.size(); ++i) inserted.push_back(hole[(right + i) % hole.size()]);
  inserted.push_back(ring[*corner]);
  ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(*corner) + 1, inserted.begin(), inserted.end());
}

}  // namespace

void triangulate_polygon(std::span<const glm::dvec3> points, std::vector<std::uint32_t>& triangles) {
  if (points.size() < 3) return;
  std::vector<std::uint32_t> ring(points.size());
  std::iota(ring.begin(), ring.end(), 0u);
  triangulate_polygon_with_holes(points, std::span(&ring, 1), triangles);
}

void triangulate_polygon_with_holes(std::span<const glm::dvec3> points,
                                    std::span<const std::vector<std::uint32_t>> rings,
                                    std::vector<std::uint32_t>& triangles) {
  if (rings.empty() || rings[0].size() < 3) return;
  if (rings.size() == 1 && rings[0].size() == 3) {
    triangles.insert(triangles.end(), rings[0].begin(), rings[0].end());
    return;
  }
  const glm::dvec3 normal = newell_normal(points, rings[0]);
  if (!(glm::dot(normal, normal) > 0)) return;  // no area, or not finite
  const Projection flat(points, rings[0][0], normal);

  // ── holes: clockwise, rightmost first ──
  std::vector<std::uint32_t> ring = rings[0];
  std::vector<std::vector<std::uint32_t>> holes;
  for (const std::vector<std::uint32_t>& hole : rings.subspan(1)) {
    if (hole.size() < 3) continue;
    holes.push_back(hole);
    if (glm::dot(newell_normal(points, hole), normal) > 0) std::reverse(holes.back().begin(), holes.back().end());
  }
  const auto rightmost = [&](const std::vector<std::uint32_t>& hole) {
    double x = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : hole) x = std::max(x, flat[i].x);
    return x;
  };
  std::stable_sort(holes.begin(), holes.end(),
                   [&](const auto& a, const auto& b) { return rightmost(a) > rightmost(b); });
  for (const std::vector<std::uint32_t>& hole : holes) join_hole(flat, ring, hole);

  EarClipper(flat, ring, ring.size() > rings[0].size()).run(triangles);
}

}  // namespace farfield
