#include "jobs/compare/crawl.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "jobs/schemes/judge_maps.h"
#include "optimizer/figures/stability.h"
#include "partition/tracking/plan_crawl.h"

namespace lightfit {
namespace {

// The root mean square of two sets together.
double PooledRms(double a, int64_t count_a, double b, int64_t count_b) {
  const auto weight_a = static_cast<double>(count_a), weight_b = static_cast<double>(count_b);
  if (count_a + count_b == 0) return 0.0;
  return std::sqrt((weight_a * a * a + weight_b * b * b) / (weight_a + weight_b));
}

void Pool(const MapCrawl& crawl, MapCrawl* sum) {
  Crawl& points = sum->points;
  const Crawl& more = crawl.points;
  points.phase_drift_texels = PooledRms(
      points.phase_drift_texels, points.num_points, more.phase_drift_texels, more.num_points);
  points.edge_crawl_px = PooledRms(
      points.edge_crawl_px, points.num_edge_points, more.edge_crawl_px, more.num_edge_points);
  const auto num_points = static_cast<double>(points.num_points + more.num_points);
  if (num_points > 0.0) {
    points.moved_share = (points.moved_share * static_cast<double>(points.num_points) +
                          more.moved_share * static_cast<double>(more.num_points)) /
                         num_points;
  }
  points.num_points += more.num_points;
  points.num_edge_points += more.num_edge_points;
  if (!crawl.flicker.has_value()) return;
  if (!sum->flicker.has_value()) sum->flicker = Flicker();
  sum->flicker->judged += crawl.flicker->judged;
  sum->flicker->flips_ideal += crawl.flicker->flips_ideal;
  sum->flicker->flips_practical += crawl.flicker->flips_practical;
}

absl::StatusOr<Crawl> CrawlOfPoints(const PresentMaps& present,
                                    const LitStage& next_frame,
                                    const SchemeMaps& next_drawn) {
  const Surfaces* surfaces = next_frame.surfaces->ok() ? &**next_frame.surfaces : nullptr;
  const PlanMap* only = OnlyMap(present.drawn);
  const PlanMap* next_only = OnlyMap(next_drawn);
  if (only != nullptr && next_only != nullptr) {
    return MeasureCrawl({present.frame.readback, only->map_from_world, only->size},
                        {next_frame.readback, next_only->map_from_world, next_only->size, surfaces},
                        next_frame.light);
  }
  const Plan* plan = PlanOf(present.drawn);
  const Plan* next_plan = PlanOf(next_drawn);
  if (plan == nullptr || next_plan == nullptr) return Crawl();
  return MeasurePlanCrawl({present.frame.readback, *plan},
                          {next_frame.readback, *next_plan, surfaces},
                          next_frame.light,
                          next_drawn.guard_texels);
}

}  // namespace

absl::StatusOr<NextFrame> MakeNextFrame(const CompareStage& present, CompareStage next) {
  if (present.has_truth() != next.has_truth()) {
    return absl::InvalidArgumentError(
        "the next frame: want a scene for both frames, or a read-back for both");
  }
  NextFrame frame;
  frame.stage = std::move(next);
  if (!present.has_truth()) return frame;
  absl::StatusOr<std::vector<uint8_t>> seen =
      SeenFrom(frame.stage.screen.camera, *present.caster, present.screen);
  if (!seen.ok()) return seen.status();
  frame.seen = *std::move(seen);
  return frame;
}

bool SeesAnythingTwice(const NextFrame& next) {
  return !next.stage.has_truth() ||
         std::any_of(next.seen.begin(), next.seen.end(), [](uint8_t seen) { return seen != 0; });
}

std::optional<double> IdealFlipShare(const MapCrawl& crawl) {
  if (!crawl.flicker.has_value() || crawl.flicker->judged == 0) return std::nullopt;
  return static_cast<double>(crawl.flicker->flips_ideal) /
         static_cast<double>(crawl.flicker->judged);
}

absl::StatusOr<MapCrawl> MeasureMapCrawl(const PresentMaps& present,
                                         const NextFrame& next,
                                         const LitStage& next_frame,
                                         const SchemeMaps& next_drawn,
                                         const JudgeOptions& judge) {
  const absl::StatusOr<Crawl> points = CrawlOfPoints(present, next_frame, next_drawn);
  if (!points.ok()) return points.status();
  MapCrawl crawl;
  crawl.points = *points;
  const CompareStage& stage = *present.frame.stage;
  if (!stage.has_truth()) return crawl;
  const absl::StatusOr<ShadowImage> next_shadows = JudgeMapsFirstPhase(
      *stage.caster, stage.screen, present.truth, present.frame.light, next_drawn, judge);
  if (!next_shadows.ok()) return next_shadows.status();
  crawl.flicker = CountFlips(present.shadows, *next_shadows, next.seen);
  return crawl;
}

std::optional<MapCrawl> PooledCrawl(absl::Span<const MapCrawl> crawls) {
  if (crawls.empty()) return std::nullopt;
  MapCrawl sum;
  for (const MapCrawl& crawl : crawls) Pool(crawl, &sum);
  return sum;
}

}  // namespace lightfit
