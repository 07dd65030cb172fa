// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/depth_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "common/impostor/cut_cell.h"
#include "common/impostor/simplify_mesh.h"
#include "common/math/cube_face.h"

namespace farfield {
namespace {

using Random = std::mt19937;

float uniform(Random& random, float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); }

Tile blank_tile(int width, int height) {
  Tile tile;
  tile.edge_samples = face_samples(12);
  tile.width = width;
  tile.height = height;
  tile.coverage.assign(tile.samples(), 1);
  tile.disparity.assign(tile.samples(), 0.1f);
  tile.rgb.assign(3 * tile.samples(), 128);
  tile.cut_right.assign(tile.samples(), 0);
  tile.cut_down.assign(tile.samples(), 0);
  return tile;
}

template <class F>
void set_disparity(Tile& tile, F f) {
  for (int y = 0; y < tile.height; ++y) {
    for (int x = 0; x < tile.width; ++x) tile.disparity[y * tile.width + x] = static_cast<float>(f(x, y));
  }
}

/// Twice the area of triangle t in texture space, always counted positive.
double doubled_area(const DepthMesh& mesh, std::size_t t) {
  const auto &a = mesh.vertices[mesh.indices[3 * t]], &b = mesh.vertices[mesh.indices[3 * t + 1]],
             &c = mesh.vertices[mesh.indices[3 * t + 2]];
  return std::fabs((double(b.column) - a.column) * (double(c.row) - a.row) -
                   (double(c.column) - a.column) * (double(b.row) - a.row));
}

double area(const DepthMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) sum += 0.5 * doubled_area(mesh, t);
  return sum;
}

/// All disparities the mesh shows at texture position (x, y), by barycentric interpolation.
std::vector<double> disparities_at(const DepthMesh& mesh, double x, double y) {
  std::vector<double> found;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const auto &a = mesh.vertices[mesh.indices[t]], &b = mesh.vertices[mesh.indices[t + 1]],
               &c = mesh.vertices[mesh.indices[t + 2]];
    const double det = (double(b.column) - a.column) * (double(c.row) - a.row) -
                       (double(c.column) - a.column) * (double(b.row) - a.row);
    const double s = ((x - a.column) * (double(c.row) - a.row) - (double(c.column) - a.column) * (y - a.row)) / det;
    const double r = ((double(b.column) - a.column) * (y - a.row) - (x - a.column) * (double(b.row) - a.row)) / det;
    const double slack = 1e-9;
    if (s >= -slack && r >= -slack && s + r <= 1 + slack) {
      found.push_back(a.disparity + s * (double(b.disparity) - a.disparity) + r * (double(c.disparity) - a.disparity));
    }
  }
  return found;
}

TEST(DepthMesh, ReferenceKeepsTwoTrianglesPerQuad) {
  const DepthMesh mesh = build_depth_mesh(blank_tile(9, 7), 0);
  EXPECT_EQ(mesh.indices.size(), 3u * 2 * 8 * 6);
  EXPECT_EQ(mesh.vertices.size(), 63u);
  EXPECT_NEAR(area(mesh), 48, 1e-9);
}

TEST(DepthMesh, VerticesStandAtTheirSamples) {
  Tile tile = blank_tile(kTileSamples, kTileSamples);
  tile.id.x = 3;
  tile.id.y = 5;
  const DepthMesh mesh = build_depth_mesh(tile, 0);
  for (const DepthMeshVertex& v : mesh.vertices) {
    EXPECT_FLOAT_EQ(v.u, static_cast<float>(sample_tangent(tile.edge_samples, 3 * kTileStride + v.column - 0.5)));
    EXPECT_FLOAT_EQ(v.v, static_cast<float>(sample_tangent(tile.edge_samples, 5 * kTileStride + v.row - 0.5)));
  }
  EXPECT_EQ(mesh.width, kTileSamples);
  EXPECT_EQ(mesh.rgb.size(), 3u * kTileSamples * kTileSamples);
}

TEST(DepthMesh, AnyPlaneIsTwoTriangles) {
  for (const auto& [sx, sy] : {std::pair{0.0, 0.0}, {1e-4, -3e-4}, {-7e-4, 7e-4}, {1e-3, 1e-3}}) {
    Tile tile = blank_tile(kTileSamples, kTileSamples);
    set_disparity(tile, [&](int x, int y) { return 0.2 + sx * x + sy * y; });
    const DepthMesh mesh = build_depth_mesh(tile, 1e-6f);
    EXPECT_EQ(mesh.indices.size(), 6u);
    EXPECT_NEAR(area(mesh), 127.0 * 127.0, 1e-6);
  }
}

TEST(DepthMesh, MergedSurfacesCoverTheTileOnceWithinTheTolerance) {
  Random random(7);
  const float tolerance = 2e-4f;
  for (int trial = 0; trial < 6; ++trial) {
    Tile tile = blank_tile(37, 41);
    const double crease = uniform(random, 5, 30), bend = uniform(random, 0, 2e-5f);
    set_disparity(tile, [&](int x, int y) {
      return 0.1 + 1e-3 * std::fabs(x - crease) + bend * y * y + uniform(random, -4e-5f, 4e-5f);
    });
    const DepthMesh mesh = build_depth_mesh(tile, tolerance);
    EXPECT_LT(mesh.indices.size(), 3u * 2 * 36 * 40 / 2);
    EXPECT_NEAR(area(mesh), 36.0 * 40.0, 1e-6);
    for (int y = 0; y < 41; ++y) {
      for (int x = 0; x < 37; ++x) {
        const auto shown = disparities_at(mesh, x + 0.5, y + 0.5);
        ASSERT_FALSE(shown.empty());
        for (const double d : shown) EXPECT_NEAR(d, tile.disparity[y * 37 + x], kWorstOverTolerance * tolerance * 1.001);
      }
    }
  }
}

/// Every undirected edge belongs to two triangles, or to one and lies on the outline of the tile.
void expect_no_t_junctions(const DepthMesh& mesh, double width, double height) {
  std::map<std::array<std::pair<float, float>, 2>, int> edges;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    for (int k = 0; k < 3; ++k) {
      const auto &a = mesh.vertices[mesh.indices[t + k]], &b = mesh.vertices[mesh.indices[t + (k + 1) % 3]];
      std::array<std::pair<float, float>, 2> edge{std::pair{a.column, a.row}, {b.column, b.row}};
      if (edge[1] < edge[0]) std::swap(edge[0], edge[1]);
      ++edges[edge];
    }
  }
  for (const auto& [edge, count] : edges) {
    const bool on_outline = (edge[0].first == edge[1].first && (edge[0].first == 0.5f || edge[0].first == width - 0.5)) ||
                            (edge[0].second == edge[1].second && (edge[0].second == 0.5f || edge[0].second == height - 0.5));
    EXPECT_EQ(count, on_outline ? 1 : 2) << edge[0].first << "," << edge[0].second << " - " << edge[1].first << ","
                                         << edge[1].second;
  }
}

TEST(DepthMesh, HasNoTJunctions) {
  Random random(3);
  for (int trial = 0; trial < 5; ++trial) {
    Tile tile = blank_tile(33, 29);
    const int bump_x = 4 + static_cast<int>(random() % 24), bump_y = 4 + static_cast<int>(random() % 20);
    set_disparity(tile, [&](int x, int y) {
      return 0.1 + 1e-3 * x + (x == bump_x && y == bump_y ? 0.05 : 0.0) + (x > 20 ? 2e-3 * (x - 20) : 0.0);
    });
    const DepthMesh mesh = build_depth_mesh(tile, 1e-5f);
    EXPECT_LT(mesh.indices.size(), 3u * 600);
    expect_no_t_junctions(mesh, 33, 29);
  }
}

TEST(DepthMesh, ASurfaceEndsAtItsCutAndContinuesItsPlane) {
  Tile tile = blank_tile(8, 2);  // a tilted surface left of the cut, a flat far one right of it
  set_disparity(tile, [](int x, int) { return x <= 3 ? 0.3 + 0.01 * x : 0.05; });
  tile.cut_right[3] = tile.cut_right[8 + 3] = 6;  // (6 - 1/2)/8 = 0.6875 of the way
  const DepthMesh mesh = build_depth_mesh(tile, 0);
  EXPECT_NEAR(area(mesh), 7, 1e-6);
  const auto before = disparities_at(mesh, 3.5 + 0.68, 1.0), after = disparities_at(mesh, 3.5 + 0.70, 1.0);
  ASSERT_FALSE(before.empty());
  ASSERT_FALSE(after.empty());
  for (const double d : before) EXPECT_NEAR(d, 0.33 + 0.01 * 0.68, 1e-6);
  for (const double d : after) EXPECT_NEAR(d, 0.05, 1e-6);
}

TEST(DepthMesh, ACutTowardsNothingBoundsTheSurface) {
  Tile tile = blank_tile(4, 2);
  tile.coverage[2] = tile.coverage[3] = tile.coverage[6] = tile.coverage[7] = 0;
  tile.cut_right[1] = tile.cut_right[5] = 2;  // 0.1875
  EXPECT_NEAR(area(build_depth_mesh(tile, 0)), 1.1875, 1e-6);
  tile.cut_right[1] = tile.cut_right[5] = 0;  // unknown: halfway
  EXPECT_NEAR(area(build_depth_mesh(tile, 0)), 1.5, 1e-6);
}

/// About what coding to 1/4 pixel tolerates: 1/500 of the disparities a shell can have.
constexpr float kCodedTolerance = 4e-4f;

/// A near surface before a far one, parted along x = at(y), known to an eighth of a sample.
template <class F>
Tile parted_tile(int edge, F at) {
  Tile tile = blank_tile(edge, edge);
  set_disparity(tile, [&](int x, int y) { return x <= at(y) ? 0.3 + 1e-4 * x : 0.05; });
  for (int y = 0; y < edge; ++y) {
    const double place = at(y), first = std::floor(place);
    tile.cut_right[y * edge + static_cast<int>(first)] = static_cast<std::uint8_t>(1 + std::min(7.0, std::floor(8 * (place - first))));
    if (y + 1 == edge) continue;
    for (int x = 0; x < edge; ++x) {
      const bool is_near = x <= place, is_near_below = x <= at(y + 1);
      if (is_near != is_near_below) tile.cut_down[y * edge + x] = 4;
    }
  }
  return tile;
}

TEST(DepthMesh, AStraightSilhouetteTakesFewTriangles) {
  const Tile upright = parted_tile(64, [](int) { return 30.4; });
  const DepthMesh mesh = build_depth_mesh(upright, kCodedTolerance);
  EXPECT_LE(mesh.indices.size() / 3, 8u);
  EXPECT_NEAR(area(mesh), 63 * 63, 1e-3);
  const Tile slanted = parted_tile(64, [](int y) { return 10.3 + 0.4 * y; });
  const std::size_t exact = build_depth_mesh(slanted, 0).indices.size();
  EXPECT_LT(build_depth_mesh(slanted, kCodedTolerance).indices.size() * 20, exact);
}

TEST(DepthMesh, ASimplifiedSilhouetteStaysWhereItIs) {
  const auto edge = [](int y) { return 20.3 + 0.002 * (y - 32) * (y - 32); };
  const Tile tile = parted_tile(64, edge);
  const DepthMesh mesh = build_depth_mesh(tile, kCodedTolerance);
  for (int y = 1; y < 63; ++y) {
    const auto before = disparities_at(mesh, edge(y) - 0.7 + 0.5, y + 0.5), after = disparities_at(mesh, edge(y) + 0.7 + 0.5, y + 0.5);
    ASSERT_FALSE(before.empty());
    ASSERT_FALSE(after.empty());
    for (const double d : before) EXPECT_GT(d, 0.2) << y;
    for (const double d : after) EXPECT_LT(d, 0.2) << y;
  }
}

TEST(DepthMesh, DamagedDisparitiesAreNotSimplified) {
  Tile tile = blank_tile(16, 16);
  tile.disparity[40] = std::nanf("");
  tile.disparity[90] = std::numeric_limits<float>::infinity();
  const DepthMesh mesh = build_depth_mesh(tile, 1e-4f);
  for (const std::uint32_t index : mesh.indices) EXPECT_LT(index, mesh.vertices.size());
}

TEST(DepthMesh, DisparityNeverRunsBeyondInfinity) {
  Tile tile = blank_tile(3, 2);
  set_disparity(tile, [](int x, int) { return x == 0 ? 0.5 : 0.0; });
  tile.cut_right[1] = tile.cut_right[4] = 8;
  for (const DepthMeshVertex& v : build_depth_mesh(tile, 0).vertices) EXPECT_GE(v.disparity, 0.0f);
}

TEST(CutCell, PolygonsTileTheCellWhateverTheCuts) {
  Random random(11);
  for (int pattern = 0; pattern < 256; ++pattern) {
    CutCell cell;
    for (int k = 0; k < 4; ++k) {
      cell.is_covered[k] = true;
      cell.is_joined[k] = pattern >> k & 1;
      cell.cut[k] = (static_cast<float>(1 + random() % 8) - 0.5f) / 8;
    }
    const CellPartition partition = divide_cell(cell);
    double sum = 0;
    int corners = 0;
    for (int p = 0; p < partition.size; ++p) {
      const CellPolygon& polygon = partition.polygons[p];
      std::array<CellPoint, 5> at;
      for (int k = 0; k < polygon.size; ++k) {
        const PolygonPoint& point = polygon.points[k];
        corners += point.kind == PolygonPoint::kCorner;
        at[k] = point.kind == PolygonPoint::kCorner ? corner_point(point.index)
                : point.kind == PolygonPoint::kCut  ? cut_point(cell, point.index)
                                                    : partition.inner;
        EXPECT_TRUE(at[k].x >= 0 && at[k].x <= 1 && at[k].y >= 0 && at[k].y <= 1);
      }
      // Convex, all round one way: every fan triangle has positive area.
      for (int k = 0; k < polygon.size; ++k) {
        const CellPoint a = at[k], b = at[(k + 1) % polygon.size], c = at[(k + 2) % polygon.size];
        EXPECT_GE((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y), -1e-6) << "pattern " << pattern;
      }
      for (int k = 1; k + 1 < polygon.size; ++k) {
        sum += 0.5 * ((at[k].x - at[0].x) * (at[k + 1].y - at[0].y) - (at[k + 1].x - at[0].x) * (at[k].y - at[0].y));
      }
    }
    EXPECT_EQ(corners, 4);
    EXPECT_NEAR(sum, 1, 1e-5) << "pattern " << pattern;
  }
}

TEST(DepthMesh, RandomCutsConserveArea) {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    Tile tile = blank_tile(19, 17);
    set_disparity(tile, [&](int, int) { return uniform(random, 0.0f, 0.4f); });
    for (auto& cut : tile.cut_right) cut = random() % 3 ? 0 : static_cast<std::uint8_t>(1 + random() % 8);
    for (auto& cut : tile.cut_down) cut = random() % 3 ? 0 : static_cast<std::uint8_t>(1 + random() % 8);
    const double whole = area(build_depth_mesh(tile, 0));
    EXPECT_NEAR(whole, 18 * 16, 1e-3);
    // Simplified outlines move by a fraction of a sample, on either side of a cut alike.
    EXPECT_NEAR(area(build_depth_mesh(tile, 1e-3f)), whole, 0.03 * whole);
    for (auto& covered : tile.coverage) covered = random() % 4 != 0;
    EXPECT_LT(area(build_depth_mesh(tile, 0)), 18 * 16);
  }
}

Tile packed_tile(std::vector<BlockPlace> blocks) {
  Tile tile = blank_tile(kPackedColumns * kBlockSamples,
                         static_cast<int>((blocks.size() + kPackedColumns - 1) / kPackedColumns) * kBlockSamples);
  tile.id.view = 1;
  tile.coverage.assign(tile.samples(), 0);
  tile.blocks = std::move(blocks);
  for (std::size_t b = 0; b < tile.blocks.size(); ++b) {
    for (int j = 0; j < 8; ++j) {
      for (int i = 0; i < 8; ++i) {
        const std::size_t k = (b / kPackedColumns * 8 + j) * tile.width + b % kPackedColumns * 8 + i;
        const int x = tile.blocks[b].x * 8 + i, y = tile.blocks[b].y * 8 + j;
        tile.coverage[k] = 1;
        tile.disparity[k] = 0.1f + 1e-4f * static_cast<float>(x) + 2e-4f * static_cast<float>(y);
        tile.rgb[3 * k] = static_cast<std::uint8_t>(x), tile.rgb[3 * k + 1] = static_cast<std::uint8_t>(y);
      }
    }
  }
  return tile;
}

double face_area_in_samples(const DepthMesh& mesh, int edge_samples) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const auto &a = mesh.vertices[mesh.indices[t]], &b = mesh.vertices[mesh.indices[t + 1]],
               &c = mesh.vertices[mesh.indices[t + 2]];
    sum += 0.5 * std::fabs((double(b.u) - a.u) * (double(c.v) - a.v) - (double(c.u) - a.u) * (double(b.v) - a.v));
  }
  const double pitch = sample_pitch(edge_samples);
  return sum / (pitch * pitch);
}

TEST(DepthMesh, PackedBlocksJoinAcrossTheirBorders) {
  // Half a sample beyond the outermost samples on every side, less the corner triangles of 1/8 each.
  const auto outlined = [](double width, double height) { return width * height - 4 * 0.125; };
  const Tile single = packed_tile({{5, 6}});
  EXPECT_NEAR(face_area_in_samples(build_depth_mesh(single, 0), single.edge_samples), outlined(8, 8), 1e-2);
  const Tile square = packed_tile({{5, 6}, {5, 7}, {6, 6}, {6, 7}});
  for (const float tolerance : {0.0f, 1e-5f}) {
    const DepthMesh mesh = build_depth_mesh(square, tolerance);
    EXPECT_NEAR(face_area_in_samples(mesh, square.edge_samples), outlined(16, 16), 1e-2);
    for (const DepthMeshVertex& v : mesh.vertices) {
      const double x = sample_index(square.edge_samples, v.u), y = sample_index(square.edge_samples, v.v);
      EXPECT_NEAR(v.disparity, 0.1 + 1e-4 * x + 2e-4 * y, 1e-6);
    }
  }
  // A diagonal pair: the quad between them is drawn once.
  const Tile diagonal = packed_tile({{5, 7}, {6, 6}});
  const double alone = 2 * outlined(8, 8);
  const double together = face_area_in_samples(build_depth_mesh(diagonal, 0), diagonal.edge_samples);
  EXPECT_GT(together, alone);
  EXPECT_LE(together, 128.0 + 1e-2);
}

TEST(DepthMesh, PackedTextureLeadsAcrossBlocks) {
  const Tile tile = packed_tile({{5, 6}, {5, 7}, {6, 6}, {6, 7}, {11, 6}});
  const DepthMesh mesh = build_depth_mesh(tile, 0);
  for (const DepthMeshVertex& v : mesh.vertices) {
    const double x = sample_index(tile.edge_samples, v.u), y = sample_index(tile.edge_samples, v.v);
    if (std::fabs(x - std::round(x)) > 1e-2 || std::fabs(y - std::round(y)) > 1e-2) continue;  // a cut point
    const auto column = static_cast<int>(v.column), row = static_cast<int>(v.row);
    const std::uint8_t* texel = &mesh.rgb[3 * (static_cast<std::size_t>(row) * mesh.width + column)];
    EXPECT_EQ(texel[0], std::lround(x));
    EXPECT_EQ(texel[1], std::lround(y));
  }
}

TEST(DepthMesh, TexelsBesideABlockRepeatItsNearest) {
  const Tile tile = packed_tile({{5, 6}, {7, 6}});
  const DepthMesh mesh = build_depth_mesh(tile, 0);
  ASSERT_EQ(mesh.width, 24);
  ASSERT_EQ(mesh.height, 8);
  EXPECT_TRUE(mesh.has_gaps);
  for (const auto& [column, x] : {std::pair{0, 40}, {7, 47}, {8, 47}, {15, 56}, {16, 56}, {23, 63}}) {
    EXPECT_EQ(mesh.rgb[3 * (3 * 24 + column)], x);
    EXPECT_EQ(mesh.rgb[3 * (3 * 24 + column) + 1], 6 * 8 + 3);
  }
}

TEST(DepthMesh, BlocksOfManyRegionsMakeNoHugeMesh) {
  const Tile tile = packed_tile({{0, 0}, {60000, 60000}});
  EXPECT_TRUE(build_depth_mesh(tile, 1e-4f).indices.empty());
}

TEST(DepthMesh, MergedPackedBlocksKeepTheSameOutline) {
  Tile tile = packed_tile({{5, 6}, {5, 7}, {6, 6}, {6, 7}});
  tile.disparity[3 * tile.width + 8 + 0] += 0.05f;  // a spike on the border of two blocks
  const DepthMesh merged = build_depth_mesh(tile, 1e-5f), reference = build_depth_mesh(tile, 0);
  EXPECT_LT(merged.indices.size(), reference.indices.size());
  EXPECT_NEAR(face_area_in_samples(merged, tile.edge_samples), face_area_in_samples(reference, tile.edge_samples), 1e-2);
}

}  // namespace
}  // namespace farfield
