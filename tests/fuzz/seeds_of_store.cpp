// SPDX-License-Identifier: Apache-2.0
#include "server/scene/scene.h"
#include "server/schedule/transition_table.h"
#include "server/store/blob_records.h"
#include "tests/fuzz/seeds.h"

namespace farfield::fuzz {

void add_store_seeds(Seeds& seeds) {
  EncodedTile tile;
  tile.bytes = std::make_shared<const Bytes>(Bytes(40, 0x17));
  tile.covered_samples = 300, tile.colour_bytes = 20, tile.rays = 16384;
  seeds.push_back({"stored_record", "tile", chosen(0, write_tile_record(tile))});
  tile.bytes = std::make_shared<const Bytes>();
  seeds.push_back({"stored_record", "empty_tile", chosen(0, write_tile_record(tile))});

  LeafPlan plan;
  plan.leaf = {.level = 2, .x = 100, .y = 7, .z = 12};
  plan.root = {.level = 8, .x = 1};
  plan.near_triangles = 30000;
  plan.background_visible = true;
  plan.sky.insert(glm::dvec3(0, 1, 0));
  plan.delta_views = 3;
  for (std::uint8_t k = 0; k < 12; ++k) plan.tiles.push_back({{.cell = plan.leaf.ancestor(2 + k % 3), .view = k, .face = static_cast<std::uint8_t>(k % 6), .x = k, .y = 3}, 0.01f * static_cast<float>(k)});
  plan.chunks = {0, 5, 900};
  seeds.push_back({"stored_record", "plan", chosen(1, write_plan_record(plan))});
  EnclosureMaskWriter mask;
  mask.divide();
  for (int child = 0; child < 8; ++child) mask.fill(child < 3);
  LeafPlan part = plan;
  part.enclosure = EnclosureMask::from_bytes(mask.take()).value();
  plan.enclosures = {std::make_shared<const LeafPlan>(part)};
  seeds.push_back({"stored_record", "divided_plan", chosen(1, write_plan_record(plan))});

  seeds.push_back({"stored_record", "leaf_name", chosen(2, write_leaf_name_record({plan.leaf, true}))});

  TransitionTable table;
  table.note(std::nullopt, {.level = 1}, {.level = 1, .x = 1}, {2, 0, 0});
  table.note(CellId{.level = 1}, {.level = 1, .x = 1}, {.level = 1, .x = 2}, {4, 0, 0});
  seeds.push_back({"transitions", "two", table.write()});

  Model model;
  model.name = "square";
  model.textures.push_back({2, 1, {255, 0, 0, 255, 0, 255, 0, 100}, "two"});
  model.materials = {{.name = "plain"}, {.name = "leaf", .texture = 0, .is_alpha_masked = true}};
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  model.meshes = {mesh, mesh};
  model.meshes[1].material = 1;
  model.instances = {{0, glm::dmat4(1)}, {1, glm::dmat4(2)}};
  Bytes image;
  MemoryImageWriter out([&image](ByteView block) { image.assign(block.begin(), block.end()); });
  Scene::build(std::move(model)).value()->write(out);
  out.flush();
  seeds.push_back({"scene_image", "square", std::move(image)});
}

}  // namespace farfield::fuzz
