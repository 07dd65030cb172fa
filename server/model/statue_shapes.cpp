// SPDX-License-Identifier: Apache-2.0
#include "server/model/statue_shapes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "server/model/noise_tile.h"
#include "server/model/random_stream.h"

namespace farfield {
namespace {

// A limb: a capsule whose radius runs from one end to the other. Limbs melt into each other where they meet.
struct Limb {
  glm::vec3 from, to;
  float from_radius, to_radius;
  float length = 0;  // filled in by field_of()
};

float limb_distance(const Limb& limb, const glm::vec3& p) {
  const glm::vec3 axis = limb.to - limb.from, q = p - limb.from;
  const float length2 = glm::dot(axis, axis);
  const float t = length2 > 0 ? glm::clamp(glm::dot(q, axis) / length2, 0.0f, 1.0f) : 0.0f;
  return glm::length(q - t * axis) - glm::mix(limb.from_radius, limb.to_radius, t);
}

// Polynomial smooth minimum (Quilez): joins within `blend` metres.
float melted(float a, float b, float blend) {
  const float h = std::max(blend - std::abs(a - b), 0.0f) / blend;
  return std::min(a, b) - 0.25f * h * h * blend;
}

/// Grain of the stone: three projections of a 2D tile, metres.
class Grain {
 public:
  explicit Grain(std::uint64_t seed) : tile_(std::make_shared<NoiseTile>(seed, 8)) {}
  float at(const glm::vec3& p, float scale) const {
    return (tile_->at(p.x * scale, p.y * scale) + tile_->at(p.y * scale + 0.37, p.z * scale) + tile_->at(p.z * scale, p.x * scale + 0.71)) / 3 - 0.5f;
  }

 private:
  std::shared_ptr<const NoiseTile> tile_;
};

struct Body {
  std::vector<Limb> limbs;
  float blend = 0.05f;
  float grain_m = 0.012f;
  float fold_m = 0;        // depth of the folds of a robe, strongest at its hem
  int folds = 0;
  float robe_top_m = 0;
};

DistanceField field_of(Body body, std::uint64_t seed) {
  for (Limb& limb : body.limbs) limb.length = glm::distance(limb.from, limb.to);
  return [body = std::move(body), grain = Grain(seed), seed](const glm::vec3& p) {
    // No limb farther than the one that seems nearest, by more than two blends, can change the result.
    float limit = 1e3f;
    for (const Limb& limb : body.limbs) {
      const glm::vec3 away = p - 0.5f * (limb.from + limb.to);
      limit = std::min(limit, glm::dot(away, away));
    }
    limit = std::sqrt(limit) + 2 * body.blend;  // the middle of a limb is at least as far as its surface
    float d = 1e3f;
    for (const Limb& limb : body.limbs) {
      const glm::vec3 away = p - 0.5f * (limb.from + limb.to);
      const float reach = limit + std::max(limb.from_radius, limb.to_radius) + 0.5f * limb.length;
      if (glm::dot(away, away) < reach * reach) d = melted(d, limb_distance(limb, p), body.blend);
    }
    if (std::abs(d) > 0.25f) return 0.8f * d;
    if (body.folds > 0 && p.y < body.robe_top_m) {
      const float angle = std::atan2(p.z, p.x), phase = static_cast<float>(seed % 7);
      const float hang = 1 - p.y / body.robe_top_m;
      d += body.fold_m * hang * (std::sin(body.folds * angle + 2.2f * p.y + phase) + 0.5f * std::sin((body.folds * 2 + 1) * angle - 4.0f * p.y));
    }
    d += body.grain_m * 2 * grain.at(p, 0.9f);
    return 0.8f * d;  // folds and grain steepen the field
  };
}

void append_head(std::vector<Limb>& limbs, const glm::vec3& c, float r) {
  limbs.push_back({c + glm::vec3(0, 0.25f * r, -0.1f * r), c + glm::vec3(0, -0.3f * r, 0.15f * r), 0.95f * r, 0.72f * r});
  limbs.push_back({c + glm::vec3(0, 0.05f * r, 0.92f * r), c + glm::vec3(0, -0.25f * r, 1.08f * r), 0.10f * r, 0.15f * r});  // nose
  limbs.push_back({c + glm::vec3(-0.4f * r, 0.22f * r, 0.74f * r), c + glm::vec3(0.4f * r, 0.22f * r, 0.74f * r), 0.14f * r, 0.14f * r});  // brow
  limbs.push_back({c + glm::vec3(-0.2f * r, -0.58f * r, 0.75f * r), c + glm::vec3(0.2f * r, -0.58f * r, 0.75f * r), 0.12f * r, 0.12f * r});  // lips
  limbs.push_back({c + glm::vec3(0, -0.9f * r, 0.62f * r), c + glm::vec3(0, -0.88f * r, 0.6f * r), 0.2f * r, 0.2f * r});  // chin
  for (const float s : {-1.0f, 1.0f}) limbs.push_back({c + glm::vec3(0.95f * s * r, 0.1f * r, -0.1f * r), c + glm::vec3(0.92f * s * r, -0.25f * r, -0.05f * r), 0.16f * r, 0.12f * r});
  for (int k = 0; k < 9; ++k) {  // locks of hair
    const float a = 0.70f * static_cast<float>(k) + 0.2f;
    limbs.push_back({c + r * glm::vec3(0.75f * std::cos(a), 0.75f, 0.62f * std::sin(a) - 0.25f), c + r * glm::vec3(0.98f * std::cos(a), 0.25f, 0.72f * std::sin(a) - 0.42f), 0.22f * r, 0.2f * r});
  }
}

Body draped_figure(RandomStream& random) {
  Body body;
  const float lean = random.between(-0.05f, 0.05f), h = 1.78f;
  body.limbs = {{{0, 0.28f, 0}, {lean, 1.0f, 0}, 0.27f, 0.17f}, {{lean, 1.0f, 0}, {lean, 1.36f, 0}, 0.16f, 0.19f},
                {{lean - 0.15f, 1.42f, 0}, {lean + 0.15f, 1.42f, 0}, 0.095f, 0.095f}, {{lean, 1.45f, 0}, {lean, 1.6f, 0.01f}, 0.07f, 0.06f},
                {{lean + 0.2f, 1.40f, 0}, {lean + 0.30f, 1.12f, 0.06f}, 0.075f, 0.06f}, {{lean + 0.30f, 1.12f, 0.06f}, {lean + 0.08f, 1.14f, 0.26f}, 0.06f, 0.042f},
                {{lean - 0.2f, 1.40f, 0}, {lean - 0.34f, 1.2f, -0.02f}, 0.075f, 0.06f}, {{lean - 0.34f, 1.2f, -0.02f}, {lean - 0.38f, 1.5f, 0.12f}, 0.055f, 0.04f},
                {{lean - 0.38f, 1.5f, 0.12f}, {lean - 0.38f, 1.58f, 0.14f}, 0.05f, 0.04f}, {{lean + 0.3f, 1.15f, 0.02f}, {lean + 0.34f, 0.55f, 0.0f}, 0.06f, 0.11f}};
  append_head(body.limbs, {lean, h - 0.05f, 0.02f}, 0.115f);
  body.fold_m = 0.035f;
  body.folds = random.between(9, 13);
  body.robe_top_m = 1.25f;
  return body;
}

Body athlete(RandomStream& random) {
  Body body;
  const float s = random.chance(0.5) ? 1.0f : -1.0f;
  body.limbs = {{{0.10f * s, 0.95f, 0}, {0.13f * s, 0.5f, 0.02f}, 0.105f, 0.075f}, {{0.13f * s, 0.5f, 0.02f}, {0.12f * s, 0.1f, -0.02f}, 0.075f, 0.045f},
                {{0.12f * s, 0.07f, -0.03f}, {0.14f * s, 0.05f, 0.17f}, 0.05f, 0.04f}, {{-0.10f * s, 0.93f, 0}, {-0.18f * s, 0.5f, 0.16f}, 0.105f, 0.075f},
                {{-0.18f * s, 0.5f, 0.16f}, {-0.22f * s, 0.1f, -0.06f}, 0.075f, 0.045f}, {{-0.22f * s, 0.07f, -0.06f}, {-0.27f * s, 0.05f, 0.13f}, 0.05f, 0.04f},
                {{0, 0.98f, 0}, {0.02f * s, 1.12f, 0}, 0.15f, 0.135f}, {{0.02f * s, 1.12f, 0}, {0, 1.36f, 0}, 0.135f, 0.17f},
                {{-0.17f, 1.46f, 0}, {0.17f, 1.46f, 0}, 0.085f, 0.085f}, {{0, 1.48f, 0}, {0, 1.62f, 0.02f}, 0.068f, 0.06f},
                {{0.22f * s, 1.45f, 0}, {0.34f * s, 1.2f, -0.06f}, 0.075f, 0.055f}, {{0.34f * s, 1.2f, -0.06f}, {0.30f * s, 0.95f, 0.1f}, 0.055f, 0.038f},
                {{-0.22f * s, 1.46f, 0}, {-0.46f * s, 1.56f, 0.05f}, 0.075f, 0.055f}, {{-0.46f * s, 1.56f, 0.05f}, {-0.48f * s, 1.84f, 0.12f}, 0.052f, 0.036f},
                {{-0.48f * s, 1.9f, 0.13f}, {-0.47f * s, 1.98f, 0.15f}, 0.065f, 0.06f}, {{0.26f * s, 0.1f, -0.16f}, {0.22f * s, 0.82f, -0.12f}, 0.12f, 0.075f},
                {{0.07f, 1.38f, 0.12f}, {0.1f, 1.36f, 0.12f}, 0.07f, 0.06f}, {{-0.07f, 1.38f, 0.12f}, {-0.1f, 1.36f, 0.12f}, 0.07f, 0.06f}};
  append_head(body.limbs, {0, 1.76f, 0.03f}, 0.112f);
  body.blend = 0.045f;
  return body;
}

Body bust(RandomStream& random) {
  Body body;
  const float w = random.between(0.9f, 1.1f);
  body.limbs = {{{0, 0.16f, 0}, {0, 0.12f, 0}, 0.14f, 0.2f}, {{0, 0.2f, 0}, {0, 0.42f, 0}, 0.1f, 0.2f}, {{-0.24f * w, 0.55f, 0}, {0.24f * w, 0.55f, 0}, 0.17f, 0.17f},
                {{0, 0.6f, 0}, {0, 0.88f, 0.03f}, 0.14f, 0.115f}};
  append_head(body.limbs, {0, 1.13f, 0.05f}, 0.235f);
  body.blend = 0.07f;
  body.fold_m = 0.02f;
  body.folds = 8;
  body.robe_top_m = 0.75f;
  return body;
}

Body horse(RandomStream& random) {
  Body body;
  const float lift = random.between(0.15f, 0.35f);
  body.limbs = {{{0, 1.1f, -0.5f}, {0, 1.12f, 0.45f}, 0.27f, 0.26f}, {{0, 1.2f, 0.5f}, {0, 1.66f, 0.85f}, 0.22f, 0.13f}, {{0, 1.72f, 0.86f}, {0, 1.5f, 1.18f}, 0.12f, 0.075f},
                {{0.06f, 1.8f, 0.84f}, {0.07f, 1.92f, 0.85f}, 0.04f, 0.015f}, {{-0.06f, 1.8f, 0.84f}, {-0.07f, 1.92f, 0.85f}, 0.04f, 0.015f},
                {{0.15f, 1.0f, 0.45f}, {0.15f, 0.55f, 0.5f}, 0.13f, 0.07f}, {{0.15f, 0.55f, 0.5f}, {0.15f, 0.12f, 0.48f}, 0.06f, 0.05f}, {{0.15f, 0.07f, 0.49f}, {0.15f, 0.05f, 0.53f}, 0.07f, 0.06f},
                {{-0.15f, 1.0f, 0.45f}, {-0.15f, 0.72f, 0.8f}, 0.13f, 0.07f}, {{-0.15f, 0.72f, 0.8f}, {-0.15f, 0.35f + lift, 0.68f}, 0.06f, 0.045f}, {{-0.15f, 0.3f + lift, 0.66f}, {-0.15f, 0.27f + lift, 0.7f}, 0.06f, 0.05f},
                {{0.16f, 1.05f, -0.55f}, {0.16f, 0.6f, -0.42f}, 0.19f, 0.09f}, {{0.16f, 0.6f, -0.42f}, {0.16f, 0.12f, -0.58f}, 0.075f, 0.05f}, {{0.16f, 0.07f, -0.58f}, {0.16f, 0.05f, -0.54f}, 0.07f, 0.06f},
                {{-0.16f, 1.05f, -0.55f}, {-0.16f, 0.58f, -0.62f}, 0.19f, 0.09f}, {{-0.16f, 0.58f, -0.62f}, {-0.16f, 0.12f, -0.78f}, 0.075f, 0.05f}, {{-0.16f, 0.07f, -0.78f}, {-0.16f, 0.05f, -0.74f}, 0.07f, 0.06f},
                {{0, 1.25f, -0.75f}, {0, 1.05f, -0.98f}, 0.07f, 0.09f}, {{0, 1.05f, -0.98f}, {0, 0.55f, -1.0f}, 0.09f, 0.03f}};
  for (int k = 0; k < 9; ++k) {  // mane
    const float t = static_cast<float>(k) / 8;
    const glm::vec3 root = glm::mix(glm::vec3(0, 1.4f, 0.42f), glm::vec3(0, 1.84f, 0.78f), t);
    body.limbs.push_back({root, root + glm::vec3(0.14f, -0.16f, -0.03f), 0.055f, 0.03f});
  }
  body.blend = 0.06f;
  return body;
}

Body thinker(RandomStream& random) {
  Body body;
  const float n = random.between(0.0f, 0.06f);
  body.limbs = {{{-0.2f, 0.22f, -0.1f}, {0.2f, 0.22f, -0.1f}, 0.24f, 0.24f}, {{-0.14f, 0.5f, 0}, {-0.16f, 0.52f, 0.42f}, 0.12f, 0.085f}, {{0.14f, 0.5f, 0}, {0.16f, 0.52f, 0.42f}, 0.12f, 0.085f},
                {{-0.16f, 0.52f, 0.42f}, {-0.15f, 0.08f, 0.36f}, 0.08f, 0.05f}, {{0.16f, 0.52f, 0.42f}, {0.17f, 0.08f, 0.30f}, 0.08f, 0.05f}, {{-0.15f, 0.05f, 0.36f}, {-0.15f, 0.04f, 0.55f}, 0.055f, 0.045f},
                {{0.17f, 0.05f, 0.3f}, {0.17f, 0.04f, 0.49f}, 0.055f, 0.045f}, {{0, 0.55f, -0.08f}, {0, 1.02f, 0.08f + n}, 0.17f, 0.18f}, {{-0.19f, 1.08f, 0.08f}, {0.19f, 1.08f, 0.08f}, 0.09f, 0.09f},
                {{0.25f, 1.05f, 0.1f}, {0.17f, 0.68f, 0.34f}, 0.075f, 0.06f}, {{0.17f, 0.68f, 0.34f}, {0.03f, 1.06f, 0.36f}, 0.055f, 0.045f}, {{-0.25f, 1.05f, 0.1f}, {-0.24f, 0.72f, 0.22f}, 0.075f, 0.06f},
                {{-0.24f, 0.72f, 0.22f}, {-0.02f, 0.62f, 0.42f}, 0.055f, 0.04f}, {{0, 1.12f, 0.12f}, {0, 1.22f, 0.22f}, 0.07f, 0.065f}};
  append_head(body.limbs, {0, 1.32f, 0.24f}, 0.118f);
  return body;
}

Body knot(RandomStream& random) {
  Body body;
  const float thick = random.between(0.10f, 0.15f);
  const auto point = [](int k) {
    const float t = 6.28318530718f * static_cast<float>(k) / 48, r = 0.42f + 0.2f * std::cos(3 * t);
    return glm::vec3(r * std::cos(2 * t), 0.98f + r * std::sin(2 * t), 0.24f * std::sin(3 * t));
  };
  for (int k = 0; k < 48; ++k) body.limbs.push_back({point(k), point(k + 1), thick, thick});
  body.limbs.push_back({{0, 0.1f, 0}, {0, 0.34f, 0}, 0.22f, 0.12f});
  body.blend = 0.03f;
  body.grain_m = 0.006f;
  return body;
}

}  // namespace

std::vector<ModelledShape> statue_shapes(std::uint64_t seed) {
  RandomStream random(seed, 31);
  const Box upright{{-0.8, -0.3, -0.7}, {0.8, 2.3, 0.8}};
  return {{"draped figure", field_of(draped_figure(random), seed), upright},
          {"athlete", field_of(athlete(random), seed + 1), upright},
          {"bust", field_of(bust(random), seed + 2), {{-0.7, -0.3, -0.6}, {0.7, 1.7, 0.7}}},
          {"horse", field_of(horse(random), seed + 3), {{-0.6, -0.3, -1.3}, {0.6, 2.2, 1.5}}},
          {"thinker", field_of(thinker(random), seed + 4), {{-0.7, -0.3, -0.6}, {0.7, 1.8, 0.8}}},
          {"knot", field_of(knot(random), seed + 5), {{-1.0, -0.3, -0.6}, {1.0, 2.0, 0.6}}}};
}

ModelledShape hedge_shape(float length_m, std::uint64_t seed) {
  const glm::vec3 half{0.5f * length_m, 0.55f, 0.35f};
  const DistanceField field = [half, grain = Grain(seed)](const glm::vec3& p) {
    constexpr float kRound = 0.12f;
    const glm::vec3 q = glm::abs(p - glm::vec3(0, 0.55f, 0)) - half + kRound;
    const float box = glm::length(glm::max(q, 0.0f)) + std::min(std::max({q.x, q.y, q.z}), 0.0f) - kRound;
    return 0.7f * (box + 0.16f * grain.at(p, 0.7f) + 0.1f * grain.at(p, 2.1f));
  };
  return {"hedge", field, {{-half.x - 0.3, -0.3, -0.7}, {half.x + 0.3, 1.5, 0.7}}};
}

}  // namespace farfield
