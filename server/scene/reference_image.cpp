// SPDX-License-Identifier: Apache-2.0
#include "server/scene/reference_image.h"

#include <tbb/parallel_for.h>

#include <limits>

#include "common/shading/shading.h"

namespace farfield {
namespace {

class ReferenceRenderer {
 public:
  ReferenceRenderer(const Scene& scene, const Pose& eye, const Display& display, int samples, ReferenceImage& image)
      : scene_(scene), eye_(eye), display_(display), per_axis_(samples == 16 ? 4 : samples == 4 ? 2 : 1), image_(image) {
    rotation_ = glm::dmat3(glm::mat3_cast(eye.world_from_camera));
    background_ = glm::vec3(srgb_to_linear(scene.background().r), srgb_to_linear(scene.background().g),
                            srgb_to_linear(scene.background().b));
  }

  // A packet is 4×4 samples: one pixel with 16, 2×2 pixels with 4, 4×4 pixels with one each.
  void block(int x0, int y0) const {
    RayPacket rays;
    HitPacket hits;
    rays.active = 0;
    for (int lane = 0; lane < kPacketSize; ++lane) {
      const double x = x0 + (lane % 4 + 0.5) / per_axis_, y = y0 + (lane / 4 + 0.5) / per_axis_;
      if (x < image_.width && y < image_.height) rays.active |= 1u << lane;
      const glm::dvec3 direction = rotation_ * camera_direction(display_, x, y);
      rays.origin_x[lane] = static_cast<float>(eye_.position.x);
      rays.origin_y[lane] = static_cast<float>(eye_.position.y);
      rays.origin_z[lane] = static_cast<float>(eye_.position.z);
      rays.direction_x[lane] = static_cast<float>(direction.x);
      rays.direction_y[lane] = static_cast<float>(direction.y);
      rays.direction_z[lane] = static_cast<float>(direction.z);
      rays.near[lane] = 0;
      rays.far[lane] = std::numeric_limits<float>::infinity();
    }
    scene_.intersect(rays, hits);
    float rgb[3 * kPacketSize];
    scene_.shade(rays, hits, sample_angle(x0, y0), rgb);
    for (int y = 0; y < pixels_per_edge(); ++y)
      for (int x = 0; x < pixels_per_edge(); ++x) {
        const int first = 4 * per_axis_ * y + per_axis_ * x;  // lane of the pixel's first sample
        if (rays.active >> first & 1) average(x0 + x, y0 + y, first, hits, rgb);
      }
  }
  /// Of a packet.
  int pixels_per_edge() const { return 4 / per_axis_; }

 private:
  void average(int x, int y, int first, const HitPacket& hits, const float* rgb) const {
    glm::vec3 sum(0);
    int surfaces = 0;
    for (int dy = 0; dy < per_axis_; ++dy)
      for (int dx = 0; dx < per_axis_; ++dx) {
        const int lane = first + 4 * dy + dx;
        const bool hit = hits.part[lane] != kNoHit;
        sum += hit ? glm::vec3(rgb[3 * lane], rgb[3 * lane + 1], rgb[3 * lane + 2]) : background_;
        surfaces += hit;
      }
    const int samples = per_axis_ * per_axis_;
    const int central = first + 5 * ((per_axis_ - 1) / 2);  // the sample at the centre, or one of the four around it
    // The camera's -Z component of the direction is 1, so the ray parameter is z.
    const float disparity = hits.part[central] != kNoHit ? 1.0f / hits.distance[central] : 0.0f;
    store(x, y, sum / static_cast<float>(samples), 2 * surfaces > samples, disparity);
  }
  // shade() wants the angle per unit of |direction|: the pixel's pitch shrinks towards the corners as its solid angle does.
  float sample_angle(double x, double y) const {
    const glm::dvec3 d = camera_direction(display_, x, y);
    return static_cast<float>(display_.pixel_pitch() / per_axis_ / std::pow(glm::dot(d, d), 0.75));
  }
  void store(int x, int y, const glm::vec3& colour, bool surface, float disparity) const {
    const std::size_t at = static_cast<std::size_t>(y) * image_.width + x;
    for (int c = 0; c < 3; ++c) image_.rgb[3 * at + c] = linear_to_srgb(colour[c]);
    image_.disparity[at] = disparity;
    image_.has_surface[at] = surface;
  }

  const Scene& scene_;
  const Pose& eye_;
  const Display& display_;
  const int per_axis_;  // samples of a pixel along x and along y
  ReferenceImage& image_;
  glm::dmat3 rotation_;
  glm::vec3 background_;
};

}  // namespace

ReferenceImage render_reference(const Scene& scene, const Pose& eye, const Display& display, int samples_per_pixel) {
  ReferenceImage image;
  image.width = display.width, image.height = display.height;
  const std::size_t pixels = static_cast<std::size_t>(display.width) * display.height;
  image.rgb.assign(3 * pixels, 0), image.disparity.assign(pixels, 0), image.has_surface.assign(pixels, 0);
  const ReferenceRenderer renderer(scene, eye, display, samples_per_pixel, image);
  const int edge = renderer.pixels_per_edge();
  tbb::parallel_for(tbb::blocked_range<int>(0, (display.height + edge - 1) / edge, 16 / edge), [&](const tbb::blocked_range<int>& rows) {
    for (int row = rows.begin(); row < rows.end(); ++row)
      for (int x = 0; x < display.width; x += edge) renderer.block(x, row * edge);
  });
  return image;
}

}  // namespace farfield
