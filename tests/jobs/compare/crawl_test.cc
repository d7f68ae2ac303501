// The crawl of methods: rows, and totals of many lights.

#include "jobs/compare/crawl.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "jobs/compare/camera_step.h"
#include "jobs/compare/rows.h"
#include "jobs/compare/totals.h"
#include "tests/jobs/compare/compare_scene.h"
#include "tests/jobs/compare/compared_lights.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

const Light kSun = Light::Directional("sun", {-1, -1.3, 0.4}, 5);

class CrawlTest : public ::testing::Test {
 protected:
  void SetUp() override {
    absl::StatusOr<RayCaster> caster = RayCaster::Build(BoxesOnFloor());
    ASSERT_THAT(caster, IsOk());
    caster_ = std::make_unique<RayCaster>(*std::move(caster));
    stage_ = StageOf({});
    options_.map = {100, 80};
  }

  CompareStage StageOf(const CameraStep& step) const {
    absl::StatusOr<CompareStage> stage =
        MakeStage(*caster_, Stepped(BoxesCamera(200, 150), step), 104, 78);
    EXPECT_THAT(stage, IsOk());
    return stage.ok() ? *std::move(stage) : CompareStage();
  }

  NextFrame NextOf(const CameraStep& step) const {
    absl::StatusOr<NextFrame> next = MakeNextFrame(stage_, StageOf(step));
    EXPECT_THAT(next, IsOk());
    return next.ok() ? *std::move(next) : NextFrame();
  }

  LightComparison CompareTo(const NextFrame& next, const Light& light = kSun) {
    options_.next = &next;
    return CompareMaps(stage_, light, options_);
  }

  std::unique_ptr<RayCaster> caster_;
  CompareStage stage_;
  CompareOptions options_;
};

TEST_F(CrawlTest, IsNothingWhereTheCameraStands) {
  const NextFrame next = NextOf({});
  for (const ComparedRow& map : CompareTo(next).rows) {
    SCOPED_TRACE(map.name);
    ASSERT_TRUE(map.crawl.has_value()) << map.note;
    EXPECT_GT(map.crawl->points.num_points, 500);
    EXPECT_GT(map.crawl->points.num_edge_points, 50);
    EXPECT_EQ(map.crawl->points.phase_drift_texels, 0.0);
    EXPECT_EQ(map.crawl->points.edge_crawl_px, 0.0);
    ASSERT_TRUE(map.crawl->flicker.has_value());
    EXPECT_GT(map.crawl->flicker->judged, 10000);
    EXPECT_EQ(map.crawl->flicker->flips_ideal, 0);
    EXPECT_EQ(map.crawl->flicker->flips_practical, 0);
  }
}

TEST_F(CrawlTest, IsThatOfTheMatricesOfBothFrames) {
  const NextFrame next = NextOf({0.1, 0.02, 0.0, 0.5, 0.1});
  const LightComparison present = CompareTo(next);
  options_.next = nullptr;
  const LightComparison there = CompareMaps(next.stage, kSun, options_);
  const std::vector<Lighting> truth = TrueLighting(*caster_, stage_.screen, kSun);
  for (const char* name : {"focused", "lispsm", "lightfit"}) {
    SCOPED_TRACE(name);
    const ComparedRow& row = *present.Find(name);
    const Eigen::Matrix4d& a = MatrixOf(row);
    const Eigen::Matrix4d& b = MatrixOf(*there.Find(name));
    EXPECT_NE(a, b);
    const absl::StatusOr<Flicker> flicker = MeasureFlicker(*caster_,
                                                           stage_.screen,
                                                           next.seen,
                                                           truth,
                                                           kSun,
                                                           {a, options_.map},
                                                           {b, options_.map},
                                                           options_.judge);
    ASSERT_THAT(flicker, IsOk());
    ASSERT_TRUE(row.crawl.has_value()) << row.note;
    EXPECT_EQ(row.crawl->flicker->judged, flicker->judged);
    EXPECT_EQ(row.crawl->flicker->flips_ideal, flicker->flips_ideal);
    EXPECT_EQ(row.crawl->flicker->flips_practical, flicker->flips_practical);
    EXPECT_GT(flicker->flips_ideal, 0);
    // Where neither map is wrong they agree.
    const absl::StatusOr<ShadowImage> b_here =
        JudgeMatrix(*caster_, stage_.screen, truth, kSun, {b, options_.map}, options_.judge);
    ASSERT_THAT(b_here, IsOk());
    EXPECT_LE(flicker->flips_ideal, row.wrong->ideal + b_here->wrong.ideal);
    const LitStage from = Lit(stage_, kSun), to = Lit(next.stage, kSun);
    const absl::StatusOr<Crawl> points =
        MeasureCrawl({from.readback, a, options_.map}, {to.readback, b, options_.map}, from.light);
    ASSERT_THAT(points, IsOk());
    EXPECT_EQ(row.crawl->points.num_points, points->num_points);
    EXPECT_EQ(row.crawl->points.phase_drift_texels, points->phase_drift_texels);
    EXPECT_EQ(row.crawl->points.edge_crawl_px, points->edge_crawl_px);
    EXPECT_GT(points->phase_drift_texels, 0.2);
    EXPECT_GT(points->edge_crawl_px, 0.0);
    EXPECT_NEAR(*IdealFlipShare(*row.crawl),
                static_cast<double>(flicker->flips_ideal) / flicker->judged,
                1e-12);
  }
}

TEST_F(CrawlTest, AMatrixThatIsKeptHasNone) {
  const NextFrame next = NextOf({0.1, 0.0, 0.0, 0.5, 0.0});
  options_.next = nullptr;
  const Eigen::Matrix4d kept = MatrixOf(*CompareMaps(stage_, kSun, options_).Find("lightfit"));
  options_.given = {{"kept", GivenMaps{PlanOfOneMap("", kept, options_.map, Border::kLit)}, {}}};
  const LightComparison comparison = CompareTo(next);
  const ComparedRow& row = *comparison.Find("kept");
  ASSERT_TRUE(row.crawl.has_value()) << row.note;
  EXPECT_EQ(row.crawl->points.phase_drift_texels, 0.0);
  EXPECT_EQ(row.crawl->points.moved_share, 0.0);
  EXPECT_EQ(row.crawl->flicker->flips_ideal, 0);
  EXPECT_EQ(row.crawl->flicker->flips_practical, 0);
  EXPECT_GT(comparison.Find("lightfit")->crawl->points.moved_share, 0.5);
}

// A lamp beyond the floor before the camera's feet, which in the next frame is seen all around it.
TEST_F(CrawlTest, RowsWithoutANextMatrixSayWhy) {
  const CompareStage down = StageOf({3.0, 0.0, 0.0, 0.0, -70.0});
  const absl::StatusOr<NextFrame> next = MakeNextFrame(down, StageOf({}));
  ASSERT_THAT(next, IsOk());
  options_.next = &*next;
  options_.fit.cover = Cover::kReceivers;
  const LightComparison comparison =
      CompareMaps(down, Light::Point("lamp", {0.0, 1.0, 0.0}), options_);
  EXPECT_THAT(comparison.lightfit().status, IsOk());
  EXPECT_FALSE(comparison.lightfit().crawl.has_value());
  EXPECT_THAT(comparison.lightfit().note, HasSubstr("no crawl, in the next frame: light \"lamp\""));
}

TEST_F(CrawlTest, WithoutAShadowInTheNextFrameItsMapIsTheFocusedOne) {
  // The next camera looks down at the floor before its feet, where no shadow is.
  const NextFrame next = NextOf({3.0, 0.0, 0.0, 0.0, -70.0});
  std::vector<std::string> begun;
  options_.before_row = [&begun](const std::string& name) { begun.push_back(name); };
  const LightComparison comparison = CompareTo(next);
  EXPECT_THAT(comparison.lightfit().status, IsOk());
  EXPECT_TRUE(comparison.lightfit().crawl.has_value()) << comparison.lightfit().note;
  ASSERT_EQ(begun.size(), 2 * RowNames({}).size());
  EXPECT_EQ(begun.back(), "lightfit, next frame");
}

TEST_F(CrawlTest, WantsBothFramesAlike) {
  const LitStage lit = Lit(stage_, kSun);
  const absl::StatusOr<CompareStage> readback_alone = MakeStage(lit.readback);
  ASSERT_THAT(readback_alone, IsOk());
  EXPECT_THAT(MakeNextFrame(stage_, *readback_alone).status(),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("a scene for both frames")));
}

MapCrawl CrawlOf(int64_t num_points, double drift, int64_t judged, int64_t flips) {
  MapCrawl crawl;
  crawl.points.num_points = num_points;
  crawl.points.phase_drift_texels = drift;
  crawl.points.moved_share = 1.0;
  crawl.flicker = Flicker{judged, flips, 2 * flips};
  return crawl;
}

TEST(PooledCrawl, IsThatOfAllPointsTogether) {
  EXPECT_FALSE(PooledCrawl({}).has_value());
  MapCrawl still = CrawlOf(300, 0.0, 100, 0);
  still.points.moved_share = 0.0;
  const std::optional<MapCrawl> pooled = PooledCrawl({still, CrawlOf(100, 0.4, 300, 4)});
  ASSERT_TRUE(pooled.has_value());
  EXPECT_EQ(pooled->points.num_points, 400);
  EXPECT_DOUBLE_EQ(pooled->points.phase_drift_texels, 0.2);
  EXPECT_DOUBLE_EQ(pooled->points.moved_share, 0.25);
  EXPECT_EQ(pooled->points.num_edge_points, 0);
  EXPECT_DOUBLE_EQ(*IdealFlipShare(*pooled), 0.01);
  EXPECT_EQ(pooled->flicker->flips_practical, 8);
  EXPECT_FALSE(IdealFlipShare(MapCrawl()).has_value());
}

TEST(PooledCrawl, TotalsCountTheLightsThatBothHave) {
  const auto light = [](std::optional<MapCrawl> focused, std::optional<MapCrawl> lightfit) {
    LightComparison comparison;
    comparison.light = kSun;
    for (auto& [name, crawl] : {std::pair("focused", focused), std::pair("lightfit", lightfit)}) {
      comparison.rows.emplace_back();
      comparison.rows.back().name = name;
      comparison.rows.back().crawl = crawl;
    }
    return comparison;
  };
  const MapCrawl crawl = CrawlOf(100, 0.3, 10, 1);
  const std::vector<MethodTotals> totals =
      TotalsOf({light(crawl, crawl), light(crawl, {}), light({}, crawl)});
  EXPECT_EQ(totals[0].num_crawl_lights, 1);
  EXPECT_EQ(totals[0].crawl->points.num_points, 100);
  EXPECT_EQ(totals[1].num_crawl_lights, 2);
}

}  // namespace
}  // namespace lightfit
