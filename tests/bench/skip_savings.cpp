// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/skip_savings.h"

#include <set>

#include "common/base/thread_clock.h"
#include "common/codec/tile_codec.h"
#include "server/encode/tile_maker.h"

namespace farfield::bench {
namespace {

constexpr std::size_t kLeaves = 12;      // planned again
constexpr std::size_t kViewCells = 2;    // given all the delta views they may have
constexpr std::size_t kTilesMade = 60;   // of those not listed
constexpr std::size_t kTilesCast = 40;   // with what is hidden
constexpr double kRaysPerRefined = 4;    // server/impostor/supersample.cpp

struct Cost {
  double ms = 0, bytes = 0;
};

double share_of(double sum, double count) { return count > 0 ? sum / count : 0; }

// At most `count` of `all`, evenly spread.
template <class T>
std::vector<T> spread(const std::vector<T>& all, std::size_t count) {
  if (all.size() <= count) return all;
  std::vector<T> some;
  for (std::size_t k = 0; k < count; ++k) some.push_back(all[k * all.size() / count]);
  return some;
}

class SavingsMeter {
 public:
  SavingsMeter(const World& world, const ImpostorSettings& settings, const MethodResult& result)
      : scene_(world.scene), settings_(settings), shells_{CellGrid{settings.finest_side_m}, settings.kappa}, result_(result),
        sources_(make_impostor_sources(world.scene, settings)) {
    std::vector<CellId> leaves;
    for (const CellStatistics& cell : result.explained)
      if (cell.is_leaf) leaves.push_back(cell.cell);
    leaf_count_ = static_cast<double>(leaves.size());
    for (const CellId& leaf : spread(leaves, kLeaves)) {
      // A fresh tree learns by the way that the cell is a leaf.
      static_cast<void>(sources_.leaves->leaf_at(shells_.grid.box(leaf).center(), nullptr));
      if (const auto plan = sources_.leaves->plan(leaf, nullptr)) plans_.push_back(*plan);
    }
  }

  std::vector<Saving> run() {
    price_rays_and_hidden();
    add({"empty tiles: not sent", "empty_tiles", count("empty_tiles"), kNone, kNone, count("empty_tiles") * blank_tile_bytes()});
    const double hidden = count("hidden_samples") + 64 * count("delta_blocks_hidden");
    add({"hidden layers: samples nobody in the leaf sees", "hidden_samples", hidden, hidden, hidden * hidden_.ms, hidden * hidden_.bytes});
    add_unlisted_tiles();
    add_chunks();
    const double leaf_ms = share_of(sum([](const CellStatistics& c) { return 1e3 * (c.seconds + c.visibility_seconds); }), leaf_count_);
    const double blocked = count("leaves_blocked_ahead");
    add({"leaves ahead nobody can stand in: not made", "leaves_blocked_ahead", blocked, kNone, blocked * leaf_ms, kNone});
    add_delta_views();
    const double probed = 64 * count("delta_blocks_not_cast");
    add({"delta blocks earlier views hold: not cast", "delta_blocks_not_cast", count("delta_blocks_not_cast"), probed, probed * ray_ms_, kNone});
    const double held = count("delta_samples_held");
    add({"delta samples earlier views hold: not kept", "delta_samples_held", held, kNone, kNone, held * delta_sample_bytes_});
    add({"tiles and chunks of earlier leaves: not sent", "payloads_held", count("payloads_held"), kNone, kNone, count("payload_bytes_held")});
    add({"tiles alike in other cells: sent all the same", "identical_tiles", count("identical_tiles"), kNone, kNone, 0});
    add({"depth beyond the parallax limit", "samples_without_depth", count("samples_without_depth"), kNone, kNone,
         count("samples_without_depth") * (std::isfinite(result_.depth_bits) ? result_.depth_bits / 8 : 0)});
    const double rays = kRaysPerRefined * count("samples_coloured_once");
    add({"several rays where one tells the colour", "samples_coloured_once", count("samples_coloured_once"), rays, rays * ray_ms_, kNone});
    return std::move(savings_);
  }

 private:
  void add(Saving saving) { savings_.push_back(std::move(saving)); }
  double count(const std::string& name) const {
    const auto found = result_.skipped.find(name);
    return found == result_.skipped.end() ? 0 : found->second;
  }
  template <class Figure>
  double sum(Figure figure) const {
    double total = 0;
    for (const CellStatistics& cell : result_.explained) total += cell.is_leaf ? figure(cell) : 0;
    return total;
  }
  double blank_tile_bytes() const {
    Tile blank;
    blank.edge_samples = settings_.edge_samples();
    blank.width = blank.height = kTileSamples, blank.disparity_tolerance = 1e-3f;
    const std::size_t n = blank.samples();
    blank.coverage.assign(n, 0), blank.cut_right.assign(n, 0), blank.cut_down.assign(n, 0);
    blank.disparity.assign(n, 0), blank.rgb.assign(3 * n, 0);
    const Result<Bytes> encoded = encode_tile(blank, {settings_.colour_quality});
    return encoded ? static_cast<double>(encoded->size()) : 0;
  }

  Cost made(const TileId& id) const {
    const auto tile = sources_.tiles->make(id, nullptr);
    return tile ? Cost{1e3 * (*tile)->seconds, static_cast<double>((*tile)->bytes->size())} : Cost{};
  }
  // Casting and encoding it with everything in the shell, seen or not.
  Cost made_whole(const TileId& id, const ShellViews& views) const {
    const double start = thread_seconds();
    const CellSpace space = CellSpace::of_shell(shells_, id.cell, sources_.tree->scene_root());
    const double gain = views.warp_gains[id.view], tolerance = settings_.tau_px * settings_.display.pixel_pitch() / gain;
    TileWork work;
    DeltaSkips skips;
    const Tile tile = id.is_delta() ? cast_delta_tile(*scene_, space, views.positions, id, settings_, gain, tolerance, nullptr, work, skips)
                                    : cast_dense_tile(*scene_, space, views.positions[0], id, settings_.edge_samples(), gain, tolerance, nullptr, work);
    const Result<Bytes> bytes = tile.coverage.empty() ? Result<Bytes>(Bytes()) : encode_tile(tile, {settings_.colour_quality});
    return {1e3 * (thread_seconds() - start), bytes ? static_cast<double>(bytes->size()) : 0};
  }

  void price_rays_and_hidden() {
    std::vector<TileId> own;
    for (const SharedPlan& plan : plans_)
      for (const NeededTile& tile : plan->tiles)
        if (tile.id.cell == plan->leaf) own.push_back(tile.id);
    double hidden = 0, ms = 0, bytes = 0, intra_ms = 0, intra_rays = 0, delta_bytes = 0, delta_samples = 0;
    for (const TileId& id : spread(own, kTilesCast)) {
      const auto views = sources_.views->views(id.cell, nullptr);
      const auto tile = sources_.tiles->make(id, nullptr);
      if (!views || !tile) continue;
      const EncodedTile& t = **tile;
      const Cost whole = made_whole(id, **views);
      hidden += static_cast<double>(t.skips.hidden_samples + 64 * t.skips.delta_blocks_hidden);
      ms += whole.ms - made(id).ms, bytes += whole.bytes - static_cast<double>(t.bytes->size());
      if (id.is_delta()) delta_bytes += static_cast<double>(t.bytes->size()), delta_samples += t.covered_samples;
      else intra_ms += 1e3 * t.stages.intra, intra_rays += t.rays;
    }
    hidden_ = {share_of(ms, hidden), share_of(bytes, hidden)};
    ray_ms_ = share_of(intra_ms, intra_rays);
    delta_sample_bytes_ = share_of(delta_bytes, delta_samples);
  }

  // Every tile of the shells that some of the leaves are in, less those that some of them list.
  void add_unlisted_tiles() {
    std::set<TileId> listed, all;
    for (const SharedPlan& plan : plans_) {
      for (const NeededTile& tile : plan->tiles) listed.insert(tile.id);
      for (int level = plan->leaf.level; level <= plan->root.level; ++level) add_tiles_of(plan->leaf.ancestor(level), all);
    }
    std::vector<TileId> unlisted;
    for (const TileId& id : all)
      if (!listed.contains(id)) unlisted.push_back(id);
    const std::vector<TileId> some = spread(unlisted, kTilesMade);
    Cost total;
    for (const TileId& id : some) {
      const Cost one = made(id);
      total.ms += one.ms, total.bytes += one.bytes;
    }
    // The tiles of the leaves planned stand for those of all the walk's.
    const double stands_for = static_cast<double>(unlisted.size()) * share_of(leaf_count_, static_cast<double>(plans_.size()));
    const double tiles = static_cast<double>(some.size());
    add({"far tiles that no leaf of the walk sees", "tiles_unseen", stands_for, kNone, stands_for * share_of(total.ms, tiles),
         stands_for * share_of(total.bytes, tiles)});
  }
  void add_tiles_of(const CellId& cell, std::set<TileId>& all) const {
    const auto views = sources_.views->views(cell, nullptr);
    if (!views) return;
    for (std::size_t view = 0; view < (*views)->positions.size(); ++view) {
      TileId id{cell, static_cast<std::uint8_t>(view), 0, 0, 0};
      const int edge = settings_.edge_samples(id.view), tiles = id.is_delta() ? face_regions(edge) : face_tiles(edge);
      for (int k = 0; k < kCubeFaces * tiles * tiles; ++k) {
        id.face = static_cast<std::uint8_t>(k / (tiles * tiles));
        id.y = static_cast<std::uint8_t>(k / tiles % tiles), id.x = static_cast<std::uint8_t>(k % tiles);
        all.insert(id);
      }
    }
  }

  void add_chunks() {
    std::set<ContentHash> listed;
    for (const SharedPlan& plan : plans_)
      for (const std::uint32_t chunk : plan->chunks) listed.insert(scene_->chunks()[chunk].hash);
    std::set<ContentHash> away, unseen;
    double away_bytes = 0, unseen_bytes = 0;
    for (const SharedPlan& plan : plans_)
      for (const std::uint32_t chunk : scene_->chunks_in(shells_.near_region(plan->leaf))) {
        const SceneChunk& skipped = scene_->chunks()[chunk];
        if (listed.contains(skipped.hash)) continue;
        const bool is_away = faces_away(skipped, shells_.grid.box(plan->leaf));
        if (!(is_away ? away : unseen).insert(skipped.hash).second) continue;
        (is_away ? away_bytes : unseen_bytes) += static_cast<double>(scene_->encoded_chunk(chunk)->size());
      }
    const double scale = share_of(leaf_count_, static_cast<double>(plans_.size()));
    add({"chunks that face away: not sent", "chunks_facing_away", count("chunks_facing_away"), kNone, kNone, scale * away_bytes});
    add({"chunks no ray reaches: not sent", "chunks_unseen", count("chunks_unseen"), kNone, kNone, scale * unseen_bytes});
  }

  void add_delta_views() {
    ImpostorSettings every = settings_;
    every.void_target = 0;
    const ImpostorSources without_target = make_impostor_sources(scene_, every);
    std::set<CellId> asked;
    std::vector<std::pair<CellId, SharedPlan>> seeing;
    for (const SharedPlan& plan : plans_)
      for (const NeededTile& tile : plan->tiles)
        if (asked.insert(tile.id.cell).second && unneeded_in(tile.id.cell) > 0) seeing.push_back({tile.id.cell, plan});
    Cost saved;
    double views = 0;
    for (const auto& [cell, plan] : spread(seeing, kViewCells)) {
      static_cast<void>(without_target.leaves->leaf_at(shells_.grid.box(plan->leaf).center(), nullptr));
      const auto full = without_target.leaves->plan(plan->leaf, nullptr);
      if (!full) continue;
      const Cost with = delta_tiles_of(cell, without_target, **full), without = delta_tiles_of(cell, sources_, *plan);
      saved.ms += with.ms - without.ms + search_ms(cell, every) - search_ms(cell, settings_), saved.bytes += with.bytes - without.bytes;
      views += unneeded_in(cell);
    }
    const double unneeded = count("delta_views_unneeded");
    add({"delta views that add nothing: not made", "delta_views_unneeded", unneeded, kNone, views > 0 ? unneeded * saved.ms / views : kNone,
         views > 0 ? unneeded * saved.bytes / views : kNone});
  }
  double unneeded_in(const CellId& cell) const {
    const auto views = sources_.views->views(cell, nullptr);
    return views ? (*views)->delta_views_allowed + 1.0 - static_cast<double>((*views)->positions.size()) : 0;
  }
  // Looking for the cell's views.
  double search_ms(const CellId& cell, const ImpostorSettings& settings) const {
    const Result<bool> is_leaf = sources_.tree->is_leaf(cell, nullptr);
    const double start = thread_seconds();
    const ViewSearchWidth width = is_leaf && *is_leaf ? ViewSearchWidth::kLeaf : ViewSearchWidth::kInnerCell;
    choose_views(*scene_, CellSpace::of_shell(shells_, cell, sources_.tree->scene_root()), settings, width, nullptr);
    return 1e3 * (thread_seconds() - start);
  }
  // What one leaf in the cell needs of its delta views.
  static Cost delta_tiles_of(const CellId& cell, const ImpostorSources& sources, const LeafPlan& plan) {
    Cost total;
    for (const NeededTile& needed : plan.tiles) {
      if (needed.id.cell != cell || !needed.id.is_delta()) continue;
      const auto tile = sources.tiles->make(needed.id, nullptr);
      if (tile) total.ms += 1e3 * (*tile)->seconds, total.bytes += static_cast<double>((*tile)->bytes->size());
    }
    return total;
  }

  const std::shared_ptr<const Scene> scene_;
  const ImpostorSettings settings_;
  const NestedShells shells_;
  const MethodResult& result_;
  const ImpostorSources sources_;
  std::vector<SharedPlan> plans_;
  double leaf_count_ = 0;
  Cost hidden_;                     // of one hidden sample
  double ray_ms_ = 0, delta_sample_bytes_ = 0;
  std::vector<Saving> savings_;
};

}  // namespace

std::vector<Saving> measure_savings(const World& world, const ImpostorSettings& settings, const MethodResult& result) {
  return SavingsMeter(world, settings, result).run();
}

}  // namespace farfield::bench
