// SPDX-License-Identifier: Apache-2.0
// The whole way of an image without network: plan a leaf, make and decode its tiles, warp them on the CPU, and compare
// with truth. Thresholds stand beside the scene they were measured on.
#include <gtest/gtest.h>

#include "tests/image/leaf_frames.h"
#include "tests/unit/client/warp/near_layer.h"

namespace farfield {
namespace {

using test::decoded_leaf, test::looking, test::NearPixels;

const Display kDisplay{400, 225};

Image8 as_image(const std::vector<std::uint8_t>& values, int channels) { return test::as_image(values, channels, kDisplay); }

std::shared_ptr<const Scene> plant(const glm::dvec3& shift = glm::dvec3(0)) {
  Model model = generate_model("pipes", 20000, 1).value();
  for (MeshInstance& instance : model.instances) instance.world_from_mesh[3] += glm::dvec4(shift, 0);
  return Scene::build(std::move(model)).value();
}

TEST(ImpostorTruth, ALeafsImpostorsLookLikeThePlant) {
  const auto scene = plant();
  ImpostorSettings settings;
  settings.display = kDisplay;
  settings.face_tiles = face_tiles_for(kDisplay, settings.kappa, 1.0);
  settings.finest_side_m = finest_side_for(*scene, 0.5);
  settings.near_triangles = 3000;
  const ImpostorSources sources = make_impostor_sources(scene, settings);
  const glm::dvec3 middle = scene->bounds().center();
  const CellId leaf = sources.leaves->leaf_at({middle.x, 1.7 - scene->origin().y, middle.z}, nullptr).value();
  const auto plan = sources.leaves->plan(leaf, nullptr).value();
  const client::LeafView view = decoded_leaf(*scene, sources, settings, *plan);
  ASSERT_FALSE(view.tiles.empty());

  constexpr int kQuality = 4;  // samples per pixel of the warper: 2×2
  const Display fine{2 * kDisplay.width, 2 * kDisplay.height, kDisplay.fovy_rad};
  client::CpuWarper warper({.samples_per_pixel = kQuality});
  std::size_t compared = 0;
  const glm::dvec3 places[] = {{0.5, 0.5, 0.5}, {0.1, 0.4, 0.85}, {0.9, 0.7, 0.2}};
  for (int k = 0; k < 3; ++k) {
    const Pose eye = looking(view.leaf_box.min + view.leaf_box.extent() * places[k], 0.4 + 2.1 * k);
    const ReferenceImage truth = render_reference(*scene, eye, kDisplay, 16), rays = render_reference(*scene, eye, kDisplay, 1);
    const NearPixels near(render_reference(*scene, eye, fine, 1), eye, fine, view.near_region);
    const client::NearLayer layer{fine.width, fine.height, near.rgba, near.disparity, 1.0f};
    client::Frame frame;
    warper.draw(view, eye, kDisplay, &layer, frame);
    std::vector<std::uint8_t> is_impostor(frame.pixels());
    std::size_t impostors = 0, voids = 0;
    for (std::size_t p = 0; p < frame.pixels(); ++p) {
      const client::Coverage coverage = frame.coverage[p];
      is_impostor[p] = coverage == client::Coverage::kImpostor || coverage == client::Coverage::kCrackClosed;
      impostors += is_impostor[p];
      voids += truth.has_surface[p] && (coverage == client::Coverage::kVoidFilled || coverage == client::Coverage::kBackground);
    }
    compared += impostors;
    const Image8 wanted = as_image(truth.rgb, 3);
    const double shown_db = psnr_db(wanted, as_image(frame.rgba, 4), is_impostor), rays_db = psnr_db(wanted, as_image(rays.rgb, 3), is_impostor);
    RecordProperty("eye" + std::to_string(k), fmt::format("impostor {:.1f} dB, rays {:.1f} dB, {} impostor pixels, {} void", shown_db, rays_db, impostors, voids));
    EXPECT_GE(shown_db, rays_db - 4.5) << "eye " << k;
    EXPECT_LE(static_cast<double>(voids), 0.003 * static_cast<double>(frame.pixels())) << "eye " << k;
  }
  EXPECT_GT(compared, 3u * 4000u) << "impostors should fill a good part of the frames";
}

TEST(ImpostorTruth, AModelTenMillionMetresAwayLooksTheSame) {
  const glm::dvec3 shift(1e7 + 1.0 / 3, 0, -1e7);
  const auto here = plant(), there = plant(shift);
  const glm::dvec3 middle = here->origin() + here->bounds().center();
  const Pose world = looking({middle.x, 1.7, middle.z}, 1.0);
  const auto image = [&](const Scene& scene, const glm::dvec3& moved) {
    return render_reference(scene, {world.position + moved - scene.origin(), world.world_from_camera}, kDisplay, 16);
  };
  const ReferenceImage a = image(*here, glm::dvec3(0)), b = image(*there, shift);
  std::size_t different = 0;
  const std::size_t pixels = a.has_surface.size();
  for (std::size_t p = 0; p < pixels; ++p) {
    int worst = 0;
    for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(int{a.rgb[3 * p + c]} - int{b.rgb[3 * p + c]}));
    different += worst > 1;
  }
  EXPECT_LE(static_cast<double>(different), 0.001 * static_cast<double>(pixels)) << different << " of " << pixels;
}

}  // namespace
}  // namespace farfield
