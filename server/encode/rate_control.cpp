// SPDX-License-Identifier: Apache-2.0
#include "server/encode/rate_control.h"

#include <algorithm>
#include <cmath>

namespace farfield {
namespace {

constexpr int kRounds = 32;
constexpr double kCloseEnough = 0.01;  // of bytes or of the mean square error
constexpr double kSameSlope = 1.01;    // a step of quality is a third
// About: halving the bytes of colours takes four times the slope and more; the error goes with the slope or a little less.
constexpr double kBytesPower = -0.4, kErrorPower = 0.8;
constexpr double kSlopeStep = 1.4;     // so do views with the bytes left for colours need no finer ones to be compared
constexpr double kMostToleranceScale = 2;
// What coding does to a tile is averaged when several samples make a pixel; voids are not. Measured on a walk through a plant: from
// quality 40 to 88 tiles lose 13 levels² of error and frames 2.
constexpr double kCodingErrorInFrames = 0.15;

// What coding a shell with one slope comes to.
struct Decision {
  std::size_t views = 1;  // the intra view and the delta views that are worth their bytes
  RateModel::Outcome outcome;
};

class ShellRates {
 public:
  ShellRates(RateModel& model, const ShellViews& searched) : model_(model), count_(searched.positions.size()) {
    const VoidCount& count = searched.validated;
    for (const VoidCount::Left& left : count.left)
      void_error_.push_back(count.rays ? 4 * 3.14159265358979323846 * left.hits / count.rays * model.void_mean_square() / kCodingErrorInFrames : 0);
  }

  // With all views that were searched out.
  Decision with_all_views(double slope) { return with_views(count_, slope); }
  // With the first so many, at least 1; those after them leave voids instead.
  Decision with_views(std::size_t count, double slope) { return up_to(slope)[count - 1]; }
  // Of the numbers of views, each with the colours that are left bytes for, the one with the least error in frames, and a slope of
  // at least `fine` at which it fits. No views: not even one fits at slope `coarse`.
  struct Choice {
    std::size_t views = 0;
    double slope = 0;
  };
  Choice choose_views(double fine, double coarse, double budget) {
    // From coarse to fine, so that qualities that nothing can have are not tried.
    Choice best;
    std::vector<Choice> finest(count_);
    std::vector<double> costs(count_);
    for (double slope = coarse;; slope = std::max(fine, slope / kSlopeStep)) {
      const std::vector<Decision> decisions = up_to(slope);
      bool is_any = false;
      for (std::size_t k = 0; k < count_ && decisions[k].outcome.bytes <= budget; ++k) {
        finest[k] = {k + 1, slope}, is_any = true;
        costs[k] = decisions[k].outcome.weighted_error + (k < void_error_.size() ? void_error_[k] : 0);
      }
      if (!is_any || slope <= fine) break;
    }
    for (std::size_t k = 0; k < count_; ++k)
      if (finest[k].views > 0 && (best.views == 0 || costs[k] < costs[best.views - 1])) best = finest[k];
    return best;
  }
  // The slope in [low, high] where excess(slope), the logarithm of what there is to what there may be, falls from above 0 to at
  // most 0 on the way to `fine`, low or high. `power`: what it falls with, about, of the slope. Returns: `fine` if it never does.
  template <class Excess>
  static double solve(double low, double high, double start, double power, Excess excess) {
    const bool fine_is_high = power < 0;
    double at_slope = std::clamp(start, low, high);
    for (int round = 0; round < kRounds; ++round) {
      const double over = excess(at_slope);
      const bool is_fine = over <= 0;
      (is_fine == fine_is_high ? high : low) = at_slope;
      if ((is_fine && over > -kCloseEnough) || high < low * kSameSlope) break;
      const double next = at_slope * std::exp(-over / power);
      // By turns, as the power is only a guess and qualities come in steps.
      at_slope = round % 2 == 0 && next > low && next < high ? next : std::sqrt(low * high);
    }
    return fine_is_high ? high : low;
  }

 private:
  // [k]: of the first k + 1 views.
  std::vector<Decision> up_to(double slope) {
    const std::vector<RateModel::Outcome> views = model_.of_views(slope);
    std::vector<Decision> decisions;
    RateModel::Outcome sum;
    for (std::size_t k = 0; k < count_; ++k) {
      if (k < views.size()) {
        sum.bytes += views[k].bytes, sum.saved_by_coarse_depth += views[k].saved_by_coarse_depth;
        sum.error += views[k].error, sum.weighted_error += views[k].weighted_error, sum.solid_angle += views[k].solid_angle;
      }
      decisions.push_back({k + 1, sum});
    }
    return decisions;
  }

  RateModel& model_;
  const std::size_t count_;
  std::vector<double> void_error_;  // after the first view, the first two, …
};

std::shared_ptr<const ShellViews> first_views(const std::shared_ptr<const ShellViews>& searched, std::size_t count, double void_target) {
  if (count >= searched->positions.size()) return searched;
  auto kept = std::make_shared<ShellViews>(*searched);
  kept->positions.resize(count), kept->warp_gains.resize(count);
  VoidCount& validated = kept->validated;
  if (count <= validated.left.size()) {
    validated.left.resize(count);
    validated.hits = validated.left.back().hits, validated.worst_hits = validated.left.back().worst_hits;
  }
  kept->missed_target = void_target > 0 && validated.hits > void_target * validated.rays;
  return kept;
}

constexpr double kLeastMeanSquare = 1e-3;  // 78 dB: all that 8 bits tell and more
double mean_square_of(double psnr_db) { return 255.0 * 255.0 * std::pow(10.0, -0.1 * psnr_db); }

}  // namespace

RateControl::RateControl(std::shared_ptr<const Scene> scene, std::shared_ptr<CellTree> tree, std::shared_ptr<ViewSource> searched,
                         const NestedShells& shells, const ImpostorSettings& settings, Caster caster)
    : scene_(std::move(scene)), tree_(std::move(tree)), searched_(std::move(searched)), shells_(shells), settings_(settings), caster_(std::move(caster)) {}

Result<std::shared_ptr<const CellCoding>> RateControl::coding(const CellId& cell, const CancelFlag& cancel) {
  return decided_.get(cell, [&] { return decide(cell, cancel); });
}

Result<std::shared_ptr<const ShellViews>> RateControl::views(const CellId& cell, const CancelFlag& cancel) {
  const auto decided = coding(cell, cancel);
  if (!decided) return tl::unexpected(decided.error());
  return (*decided)->views;
}

Result<std::shared_ptr<const CellCoding>> RateControl::decide(const CellId& cell, const CancelFlag& cancel) {
  const auto searched = searched_->views(cell, cancel);
  if (!searched) return tl::unexpected(searched.error());
  const CellSpace space = CellSpace::of_shell(shells_, cell, tree_->scene_root());
  const auto needs = cell_needs(*scene_, *tree_, space, *searched, settings_, cancel);
  if (!needs) return tl::unexpected(needs.error());
  RateModel model;
  for (const SampledTile& sample : sample_tiles(*needs)) {
    if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
    Result<Tile> tile = caster_((*needs)[sample.index].id, cancel);
    if (!tile) return tl::unexpected(tile.error());
    const bool is_empty = std::find(tile->coverage.begin(), tile->coverage.end(), 1) == tile->coverage.end();
    if (!is_empty) model.add(std::move(*tile), sample.count);
  }

  const double budget = settings_.rate.cell_bytes;
  ShellRates rates(model, **searched);
  const int edge = settings_.edge_samples();
  const double finest = slope_of_quality(kFinestQuality, edge), coarsest = slope_of_quality(kCoarsestQuality, edge);
  const double usual = slope_of_quality(settings_.colour_quality, edge);
  auto coding = std::make_shared<CellCoding>();
  coding->slope = finest;
  if (settings_.rate.psnr_db > 0) {
    const double most = mean_square_of(settings_.rate.psnr_db);
    coding->slope = ShellRates::solve(finest, coarsest, usual, kErrorPower, [&](double slope) {
      return std::log(std::max(kLeastMeanSquare, rates.with_all_views(slope).outcome.mean_square()) / most);
    });
  }
  Decision decision = rates.with_all_views(coding->slope);
  if (budget > 0 && decision.outcome.bytes > budget) {
    const ShellRates::Choice choice = rates.choose_views(coding->slope, std::max(coding->slope, coarsest), budget);
    if (choice.views == 0) {
      coding->slope = std::max(coding->slope, coarsest), decision = rates.with_views(1, coding->slope);
    } else {
      const auto excess = [&](double slope) { return std::log(std::max(1.0, rates.with_views(choice.views, slope).outcome.bytes) / budget); };
      const double finer = std::max(coding->slope, choice.slope / kSlopeStep);
      if (finer < choice.slope) coding->slope = ShellRates::solve(finer, choice.slope, std::sqrt(finer * choice.slope), kBytesPower, excess);
      decision = rates.with_views(choice.views, coding->slope);
    }
  }
  coding->expected_bytes = decision.outcome.bytes, coding->expected_mean_square = decision.outcome.mean_square();
  if (budget > 0 && coding->expected_bytes > budget) {
    // Bytes of disparity fall with the logarithm of the tolerance.
    const double share = std::min(1.0, (coding->expected_bytes - budget) / std::max(1.0, decision.outcome.saved_by_coarse_depth));
    coding->tolerance_scale = std::pow(kMostToleranceScale, share);
    coding->expected_bytes -= share * decision.outcome.saved_by_coarse_depth;
    coding->is_over_budget = share >= 1;
  }
  coding->views = first_views(*searched, decision.views, settings_.targets.void_share);
  delta_views_dropped_ += (*searched)->positions.size() - decision.views;
  return coding;
}

}  // namespace farfield
