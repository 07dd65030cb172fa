// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace farfield::bench {
namespace {

std::string name_of(const CellId& cell) { return fmt::format("L{} {},{},{}", cell.level, cell.x, cell.y, cell.z); }

struct Column {
  const char* title;
  const char* why;  // what the column counts; null: not of what was skipped
  std::uint64_t (*count)(const CellStatistics&);
};

using Cell = const CellStatistics&;
constexpr Column kColumns[] = {
    {"tiles", nullptr, [](Cell c) { return std::uint64_t{c.tiles}; }},
    {"empty", "tiles made that held nothing: not sent", [](Cell c) { return std::uint64_t{c.empty_tiles}; }},
    {"unseen", "tiles of the leaf's shells not made: no ray from the leaf meets anything in them", [](Cell c) { return c.left_out.tiles_unseen; }},
    {"small", "tiles not made: less of them is seen than is worth a tile's bytes", [](Cell c) { return c.left_out.tiles_too_small; }},
    {"rays", nullptr, [](Cell c) { return c.rays; }},
    {"hidden", "samples of the leaf's own shell not cast: near geometry hides them from everywhere in the leaf",
     [](Cell c) { return c.skipped.hidden_samples; }},
    {"1 colour", "samples coloured from one ray or look-up: more would change nothing", [](Cell c) { return c.skipped.samples_coloured_once; }},
    {"no depth", "samples without depth: parallax in the cell stays below the tolerance", [](Cell c) { return c.skipped.samples_without_depth; }},
    {"d.hidden", "blocks of delta views not probed: hidden from everywhere in the leaf", [](Cell c) { return c.skipped.delta_blocks_hidden; }},
    {"d.held", "blocks of delta views probed and not cast: earlier views hold them", [](Cell c) { return c.skipped.delta_blocks_not_cast; }},
    {"d.dropped", "samples of delta views cast and not kept: earlier views hold them", [](Cell c) { return c.skipped.delta_samples_held; }},
    {"alike", "tiles that show what another cell's tile shows", [](Cell c) { return c.skipped.identical_tiles; }},
    {"chunks", nullptr, [](Cell c) { return std::uint64_t{c.chunks}; }},
    {"away", "chunks of the near region not sent: they face away from everywhere in the leaf", [](Cell c) { return c.left_out.chunks_facing_away; }},
    {"no ray", "chunks of the near region not sent: no ray from the leaf reaches them", [](Cell c) { return c.left_out.chunks_unseen; }},
    {"triangles", "triangles of these chunks, not drawn", [](Cell c) { return c.left_out.triangles_unseen; }},
};

std::string views_of(const CellStatistics& cell) { return !cell.is_leaf || cell.delta_views < 0 ? "-" : fmt::format("{}", cell.delta_views); }

nlohmann::json to_json(const CellStatistics& c) {
  return {{"cell", {{"level", c.cell.level}, {"x", c.cell.x}, {"y", c.cell.y}, {"z", c.cell.z}}},
          {"is_leaf", c.is_leaf},
          {"is_blocked", c.left_out.blocked_cells > 0},
          {"delta_views", c.is_leaf && c.delta_views >= 0 ? nlohmann::json(c.delta_views) : nlohmann::json(nullptr)},
          {"bytes", c.bytes},
          {"ms", 1e3 * c.seconds},
          {"tiles", {{"made", c.tiles}, {"empty", c.empty_tiles}, {"unseen", c.left_out.tiles_unseen},
                     {"too_small", c.left_out.tiles_too_small}, {"identical", c.skipped.identical_tiles}}},
          {"samples", {{"cast", c.rays}, {"hidden", c.skipped.hidden_samples}, {"coloured_once", c.skipped.samples_coloured_once},
                       {"without_depth", c.skipped.samples_without_depth}, {"held", c.skipped.delta_samples_held}}},
          {"delta_blocks", {{"hidden", c.skipped.delta_blocks_hidden}, {"not_cast", c.skipped.delta_blocks_not_cast}}},
          {"chunks", {{"listed", c.chunks}, {"facing_away", c.left_out.chunks_facing_away}, {"unseen", c.left_out.chunks_unseen},
                      {"triangles", c.near_triangles}, {"triangles_unseen", c.left_out.triangles_unseen}}}};
}

std::string figure(double value, const char* format) { return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : std::string("-"); }

}  // namespace

std::vector<CellStatistics> explained_cells(std::vector<CellStatistics> cells) {
  std::sort(cells.begin(), cells.end(), [](Cell a, Cell b) { return std::tuple(!a.is_leaf, a.cell) < std::tuple(!b.is_leaf, b.cell); });
  if (cells.size() > kMostExplained) cells.resize(kMostExplained);
  return cells;
}

nlohmann::json explain_json(std::span<const MethodResult> methods) {
  nlohmann::json list = nlohmann::json::array();
  for (const MethodResult& method : methods)
    for (const CellStatistics& cell : method.explained) {
      list.push_back(to_json(cell));
      list.back()["method"] = method.name;
    }
  return list;
}

void print_explanation(const MethodResult& method, std::ostream& out) {
  if (method.explained.empty()) return;
  std::size_t width = 6;
  for (const CellStatistics& cell : method.explained) width = std::max(width, name_of(cell.cell).size() + 2);
  out << fmt::format("\n{}: what each cell left out (* nobody can stand in it; cells below the leaves are their ancestors)\n{:<{}}{:>6}",
                     method.name, "cell", width, "views");
  for (const Column& column : kColumns) out << fmt::format("{:>10}", column.title);
  out << '\n';
  for (const CellStatistics& cell : method.explained) {
    out << fmt::format("{:<{}}{:>6}", name_of(cell.cell) + (cell.left_out.blocked_cells > 0 ? " *" : ""), width, views_of(cell));
    for (const Column& column : kColumns) out << fmt::format("{:>10}", column.count(cell));
    out << '\n';
  }
  out << fmt::format("  {:<10} delta views of the leaf's own shell: no further one, as the voids left are below the target\n", "views");
  for (const Column& column : kColumns)
    if (column.why) out << fmt::format("  {:<10} {}\n", column.title, column.why);
  if (method.savings.empty()) return;
  out << fmt::format("\n{}: what that saved on the walk\n{:<44}{:>24}{:>14}{:>10}{:>12}{:>12}\n", method.name, "skip", "counter", "count", "M rays", "ms", "kB");
  for (const Saving& s : method.savings)
    out << fmt::format("{:<44}{:>24}{:>14.0f}{:>10}{:>12}{:>12}\n", s.skip, s.counter, s.count, figure(1e-6 * s.rays, "{:.2f}"), figure(s.ms, "{:.0f}"),
                       figure(1e-3 * s.bytes, "{:.1f}"));
}

}  // namespace farfield::bench
