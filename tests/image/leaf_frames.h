// SPDX-License-Identifier: Apache-2.0
// The whole way of an image without network, for tests that compare it with truth: plan a leaf, make and decode its tiles,
// warp them on the CPU beside near geometry taken from truth.
#pragma once

#include <memory>
#include <vector>

#include "client/decode/payload_decoder.h"
#include "client/warp/cpu_warper.h"
#include "common/codec/tile_codec.h"
#include "common/image/psnr.h"
#include "server/encode/tile_maker.h"
#include "server/model/generate.h"
#include "server/scene/reference_image.h"

namespace farfield::test {

inline Image8 as_image(const std::vector<std::uint8_t>& values, int channels, const Display& display) {
  Image8 image(display.width, display.height, 3);
  for (std::size_t k = 0; k < static_cast<std::size_t>(display.width) * display.height; ++k)
    for (int c = 0; c < 3; ++c) image.values[3 * k + c] = values[static_cast<std::size_t>(channels) * k + c];
  return image;
}

inline Pose looking(const glm::dvec3& from, double yaw_rad) { return {from, glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0))}; }

// Pixels of a reference image whose surface lies in the near region, in the form the near renderer hands over.
struct NearPixels {
  std::vector<std::uint8_t> rgba;
  std::vector<float> disparity;

  NearPixels(const ReferenceImage& image, const Pose& eye, const Display& display, const Box& near_region)
      : rgba(4 * image.disparity.size(), 255), disparity(image.disparity.size(), 0.0f) {
    const glm::dmat3 rotation(glm::mat3_cast(eye.world_from_camera));
    for (std::size_t k = 0; k < disparity.size(); ++k) {
      const int x = static_cast<int>(k) % image.width, y = static_cast<int>(k) / image.width;
      if (!(image.disparity[k] > 0)) continue;
      const glm::dvec3 point = eye.position + rotation * camera_direction(display, x + 0.5, y + 0.5) / double{image.disparity[k]};
      if (!near_region.contains(point)) continue;
      for (int c = 0; c < 3; ++c) rgba[4 * k + c] = image.rgb[3 * k + c];
      disparity[k] = image.disparity[k];
    }
  }
};

inline client::LeafView decoded_leaf(const Scene& scene, const ImpostorSources& sources, const ImpostorSettings& settings, const LeafPlan& plan) {
  const NestedShells shells{CellGrid{settings.finest_side_m}, settings.kappa};
  const client::PayloadDecoder decoder(shells.grid, client::DecodeForm::kSplats, [](ByteView bytes) { return decode_tile(bytes); });
  client::LeafView view;
  view.leaf = plan.leaf;
  view.leaf_box = shells.grid.box(plan.leaf);
  view.near_region = shells.near_region(plan.leaf);
  view.is_complete = true;
  view.background_visible = plan.background_visible;
  view.sky = plan.sky;
  view.background = scene.background();
  for (const NeededTile& tile : plan.tiles) {
    const auto made = sources.tiles->make(tile.id, nullptr).value();
    if (!made->bytes->empty()) view.tiles.push_back(decoder.decode({{client::PayloadKind::kTile, made->hash}, made->bytes}).value().tile);
  }
  return view;
}

}  // namespace farfield::test
