// SPDX-License-Identifier: Apache-2.0
// Scenes far from the world's origin. Everything behind the scene's origin is in its own frame, so a move by a multiple of
// the frame's unit must change nothing at all, and any other move no more than the position grid allows.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "client/session/wire_convert.h"
#include "server/model/obj_reader.h"
#include "server/scene/scene_frame.h"
#include "tests/stability/stress.h"
#include "tests/stability/stress_scenes.h"

namespace farfield::stability {
namespace {

std::size_t tiles_of(const Effort& effort) {
  return effort.is_full ? 40 : 4;
}
std::size_t eyes_of(const Effort& effort) {
  return effort.is_full ? std::size(kHallEyes) : 1;
}

struct Hall {
  std::shared_ptr<const Scene> scene;
  std::vector<Visit> visits;
};
Hall hall_at(const glm::dvec3& by, const Effort& effort) {
  const ImpostorSettings settings = hall_settings();
  Hall hall{build_scene(placed(hall_model(), moved(by))), {}};
  const ImpostorSources sources = make_impostor_sources(hall.scene, settings);
  for (std::size_t k = 0; k < eyes_of(effort); ++k)
    hall.visits.push_back(visit(hall.scene, sources, settings, kHallEyes[k] + by - hall.scene->origin(), tiles_of(effort)));
  return hall;
}

// Poses of the visits are multiples of 1/8 m and moves whole metres, exact in doubles up to 2^49 m: nothing may differ.
StressRow whole_metres(int exponent, const Hall& here, const Effort& effort) {
  const double metres = std::pow(10.0, exponent);
  const glm::dvec3 by(metres, -metres, metres);
  const Hall there = hall_at(by, effort);
  WorstError worst;
  worst.count(here.scene->hash() != there.scene->hash());
  worst.count(here.scene->origin() + by != there.scene->origin());
  for (std::size_t k = 0; k < here.visits.size(); ++k) worst.count(differences(here.visits[k], there.visits[k]), compared(here.visits[k]));
  return worst.row(fmt::format("moved by 10^{} m", exponent), "the scene where it was", "leaves, tile lists, tiles, pixels that differ", 0);
}

glm::dmat4 turned_at(const glm::dvec3& by) {
  return glm::rotate(moved(by), 0.3, glm::normalize(glm::dvec3(1, 2, 3)));
}

// Vertices are rounded to the position grid (half a step per axis) after their mesh's offset was rounded to an eighth of
// it (a sixteenth); the doubles on the way are within 2^-40 m of that for a hall of 12 m.
StressRow fractions_of_metres(int exponent) {
  const double metres = std::pow(10.0, exponent) + 1.0 / 3;
  const glm::dmat4 world = turned_at({metres, -metres, metres});
  const Model model = placed(hall_model(), world);
  const auto scene = build_scene(model);
  const double step = choose_scene_frame(model.bounds()).step_m;
  std::vector<Long3> exact;
  for (const glm::vec3& p : model.meshes[0].positions) {
    Long3 q(0);
    for (int row = 0; row < 3; ++row) {
      q[row] = static_cast<long double>(world[3][row]);
      for (int k = 0; k < 3; ++k) q[row] += static_cast<long double>(world[k][row]) * static_cast<long double>(p[k]);
    }
    exact.push_back(q);
  }
  WorstError worst;
  for (const SceneChunk& chunk : scene->chunks()) {
    for (const ChunkVertex& vertex : scene->chunk_geometry(static_cast<std::uint32_t>(&chunk - scene->chunks().data())).vertices) {
      const Long3 shown = Long3(chunk.scene_from_chunk * glm::dvec4(vertex.position, 1)) + Long3(scene->origin());
      long double nearest = INFINITY;
      for (const Long3& q : exact) {
        const Long3 off = glm::abs(q - shown);
        nearest = std::min(nearest, std::max({off.x, off.y, off.z}));
      }
      worst.add(static_cast<double>(nearest));
    }
  }
  return worst.row(fmt::format("vertices, moved by 10^{} + 1/3 m and turned", exponent), "long double", "m",
                   step * (1.0 / 2 + 1.0 / 16) + 0x1p-40);
}

// Coordinates as text: rounded to double, then, less a whole offset, to float; half of the extent is 16 m at most.
StressRow text_of_a_file(int exponent) {
  const auto file = std::filesystem::temp_directory_path() / fmt::format("farfield-stability-{}-{}.obj", ::getpid(), exponent);
  std::mt19937 random(2);
  std::vector<long double> exact;
  {
    std::ofstream out(file);
    for (int k = 0; k < 300; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        const std::string text = fmt::format("1{:0{}d}.{:03d}", random() % 32, exponent, random() % 1000);
        exact.push_back(std::strtold(text.c_str(), nullptr));
        out << (axis == 0 ? "v " : " ") << text << (axis == 2 ? "\n" : "");
      }
    }
    for (int k = 1; k <= 300; k += 3) out << "f " << k << ' ' << k + 1 << ' ' << k + 2 << '\n';
  }
  const Result<Model> model = read_obj(file);
  std::filesystem::remove(file);
  WorstError worst;
  const double bound = half_double_ulp(2 * std::pow(10.0, exponent)) + half_float_ulp(31.999);
  if (!model || model->meshes.size() != 1 || model->meshes[0].positions.size() != 300) {
    worst.add(INFINITY);
  } else {
    const Long3 offset = Long3(glm::dvec3(model->instances[0].world_from_mesh[3]));
    for (std::size_t k = 0; k < exact.size(); ++k) {
      const int axis = static_cast<int>(k % 3);
      worst.add(static_cast<double>(offset[axis] + static_cast<long double>(model->meshes[0].positions[k / 3][axis]) - exact[k]));
    }
  }
  return worst.row(fmt::format("an OBJ file's text at 10^{} m", exponent), "long double", "m", bound);
}

// A pose travels as a finest cell and a float offset from its centre, at most half a side: rounded by half a float's unit
// there, and to double where centre and offset are added again. Also on borders of cells, and one double before them.
StressRow positions_on_the_wire(const Effort& effort) {
  std::mt19937 random(9);
  WorstError worst;
  for (int exponent = -10; exponent <= 3; ++exponent) {
    const CellGrid grid{std::ldexp(1.0, exponent)};
    const double reach = std::min(1e7, 0x1p28 * grid.finest_side_m);
    std::uniform_real_distribution<double> place(-reach, reach);
    for (int k = 0; k < (effort.is_full ? 100000 : 5000); ++k) {
      glm::dvec3 point(place(random), place(random), place(random));
      const unsigned kind = random() % 4;
      for (int a = 0; a < 3; ++a) {
        if (kind > 0) point[a] = std::floor(point[a] / grid.finest_side_m) * grid.finest_side_m;
        if (kind > 1) point[a] = std::nextafter(point[a], kind == 2 ? -INFINITY : INFINITY);
      }
      const glm::dvec3 arrived = client::position_on_wire(grid, point);
      for (int a = 0; a < 3; ++a)
        worst.add(static_cast<double>(static_cast<long double>(arrived[a]) - static_cast<long double>(point[a])),
                  half_float_ulp(0.49 * grid.finest_side_m) + 2 * half_double_ulp(point[a]));
    }
  }
  return worst.in_parts_of_bound("positions on the wire, up to 10^7 m, cells of 2^-10 to 8 m", "what was sent");
}

}  // namespace

Rows stress_shift(const Effort& effort) {
  Rows rows;
  const Hall here = hall_at(glm::dvec3(0), effort);
  for (int exponent = 3; exponent <= 8; ++exponent) rows.push_back(whole_metres(exponent, here, effort));
  for (int exponent = 3; exponent <= 8; ++exponent) rows.push_back(fractions_of_metres(exponent));
  for (int exponent = 3; exponent <= 8; ++exponent) {
    const double metres = std::pow(10.0, exponent) + 1.0 / 3;
    rows.push_back(hits_in_a_room(1, {metres, -metres, metres}, effort.is_full ? 20000 : 1000)
                       .in_parts_of_bound(fmt::format("first hits in a room 10^{} + 1/3 m away", exponent), "long double"));
  }
  for (int exponent = 3; exponent <= 8; ++exponent) rows.push_back(text_of_a_file(exponent));
  rows.push_back(positions_on_the_wire(effort));
  return rows;
}

}  // namespace farfield::stability
