// A plan as it is drawn: who asks which map, in colours that can be told apart.
#include "picture/plan_panel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "geometry/affine_depth.h"
#include "jobs/fit_comparison.h"
#include "optimizer/figures/footprint_image.h"
#include "partition/fit_plan.h"
#include "picture/fit_page.h"
#include "picture/heat_panel.h"
#include "picture/theme.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::StatusIs;
using testing::TestScene;

constexpr double kStep = 1.0 / 255.0 + 1e-6;  // a page has 8 bits for each colour

bool IsNear(Rgb a, Rgb b) {
  return std::abs(a.r - b.r) <= kStep && std::abs(a.g - b.g) <= kStep &&
         std::abs(a.b - b.b) <= kStep;
}

// As style guides for pages on the web have it: 1 for equal ones, 21 for black and white.
double Contrast(Rgb a, Rgb b) {
  const auto linear = [](double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const auto luminance = [&](Rgb c) {
    return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
  };
  const double la = luminance(a), lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

struct Planned {
  TestScene scene = TestScene(/*seed=*/7, /*num_lights=*/1);
  Surfaces surfaces = *FindSurfaces(scene.View(), 0x1, SampleOptions());
  const Light& sun = scene.lights[0];
  PlanOptions options;
  Plan plan;
  std::vector<uint8_t> samples;

  explicit Planned(double guard_texels = 0.0) {
    options.texels = 90000;
    options.guard_texels = guard_texels;
    plan = PlanOf(*FitPlan(surfaces, sun, options));
    samples = *SampleImage(surfaces, sun, SampleOptions());
  }
  Planned(const Planned&) = delete;
};

TEST(MapColor, StandsOutAndDiffersFromThoseBefore) {
  for (int k = 0; k < kMaxPlanMaps; ++k) {
    SCOPED_TRACE(k);
    const double least = k < 14 ? 3.0 : 1.3;  // darker ones later on, which have numbers too
    EXPECT_GT(Contrast(MapColor(k), kPanelColor), least);
    for (int other = 0; other < std::min(k, 28); ++other) {
      if (k >= 28) break;  // four turns of seven hues
      EXPECT_FALSE(IsNear(MapColor(k), MapColor(other))) << other;
    }
  }
}

TEST(PlanView, AgreesWithTheLookUpAtEveryPixel) {
  for (const double guard : {0.0, 2.0}) {
    const Planned at(guard);
    const Readback readback = at.scene.View();
    const absl::StatusOr<PlanView> view = ViewPlan(readback, at.sun, at.plan, guard, at.samples);
    ASSERT_THAT(view, IsOk());
    const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(at.plan, at.sun, guard);
    ASSERT_THAT(look_up, IsOk());
    const absl::StatusOr<std::vector<Eigen::Vector3d>> receivers = ReceiverPositions(readback);
    ASSERT_THAT(receivers, IsOk());
    std::vector<size_t> num_asking(at.plan.maps.size(), 0);
    size_t next = 0, num_outside = 0;
    for (size_t pixel = 0; pixel < view->maps.size(); ++pixel) {
      if (view->maps[pixel] == PlanView::kNoSurface) continue;
      ASSERT_LT(next, receivers->size());
      const int asked = look_up->At((*receivers)[next++]).map;
      EXPECT_EQ(view->maps[pixel], asked < 0 ? PlanView::kOutside : asked);
      if (asked < 0) {
        ++num_outside;
      } else {
        ++num_asking[asked];
      }
    }
    EXPECT_EQ(next, receivers->size());
    EXPECT_DOUBLE_EQ(view->outside_share, static_cast<double>(num_outside) / next);
    for (size_t k = 0; k < num_asking.size(); ++k) {
      EXPECT_EQ(view->views[k].receivers.size(), num_asking[k]);
    }
  }
}

TEST(CellsPanel, HasTheColourOfTheMapThatIsAsked) {
  const Planned at;
  const Readback readback = at.scene.View();
  const absl::StatusOr<PlanView> view = ViewPlan(readback, at.sun, at.plan, 0.0, at.samples);
  ASSERT_THAT(view, IsOk());
  // Without a typeface no number is written, but its dot is drawn.
  const Canvas canvas = DrawCellsPanel(readback, at.sun, *view, at.samples, Typeface());
  const PanelSize size = HeatPanelSize(readback);
  EXPECT_EQ(canvas.width(), size.width);
  EXPECT_EQ(canvas.height(), size.height);
  const int zoom = size.width / readback.width();
  ASSERT_GE(zoom, 2);
  int num_right = 0, num_looked_at = 0;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t pixel = readback.Index(x, y);
      if (view->maps[pixel] < 0) continue;
      const bool is_shadowed = (readback.shadow_bits[pixel] & 1u) != 0;
      const Rgb color = MapColor(view->maps[pixel]);
      ++num_looked_at;
      num_right +=
          IsNear(canvas.At(zoom * x, zoom * y), is_shadowed ? Mix(color, {}, 0.4f) : color) ? 1 : 0;
    }
  }
  EXPECT_GT(num_looked_at, 500);
  EXPECT_GT(num_right, 0.9 * num_looked_at);  // the others lie under numbers
}

TEST(PlanMaps, AreDrawnWhateverTheirNumberAndTheRoom) {
  const Planned at;
  Plan plan = at.plan;
  while (plan.maps.size() < static_cast<size_t>(kMaxPlanMaps)) {
    const absl::StatusOr<PlanView> view = ViewPlan(at.scene.View(), at.sun, plan, 0.0, at.samples);
    ASSERT_THAT(view, IsOk());
    for (const auto& [width, height] :
         {std::pair(540, 540), std::pair(30, 20), std::pair(900, 90)}) {
      const Canvas canvas = DrawPlanMaps(*view, plan, width, height, Typeface());
      EXPECT_EQ(canvas.width(), width);
      EXPECT_EQ(canvas.height(), height);
    }
    const Canvas canvas = DrawPlanMaps(*view, plan, 540, 540, Typeface());
    for (size_t k = 0; k < plan.maps.size(); ++k) {
      int num_pixels = 0;  // of its outline
      for (int y = 0; y < 540; ++y) {
        for (int x = 0; x < 540; ++x) {
          num_pixels += IsNear(canvas.At(x, y), MapColor(static_cast<int>(k))) ? 1 : 0;
        }
      }
      EXPECT_GT(num_pixels, 20) << k << " of " << plan.maps.size();
    }
    plan.maps.insert(plan.maps.end(), at.plan.maps.begin(), at.plan.maps.end());
    plan.maps.insert(plan.maps.end(), at.plan.maps.begin(), at.plan.maps.end());
    plan.maps.insert(plan.maps.end(), at.plan.maps.begin(), at.plan.maps.end());
  }
}

TEST(PlanMaps, OfNoMapsAreAnEmptyPage) {
  EXPECT_EQ(DrawPlanMaps(PlanView(), Plan(), 100, 50, Typeface()).width(), 100);
}

TEST(PlanMaps, OfAnotherLightAreRefused) {
  const Planned at;
  const Light lamp = Light::Point("lamp", {0.0, 0.0, 5.0});
  EXPECT_FALSE(ViewPlan(at.scene.View(), lamp, at.plan, 0.0, at.samples).ok());
}

TEST(FitPage, HasRowsOfPlansAndOfLightsWithoutAnAnswer) {
  const Planned at;
  std::vector<FitComparison> lights = {ComparePlan(at.surfaces, at.sun, at.options)};
  PictureOptions options;
  options.maps = "up to 4 maps";
  options.has_plans = true;
  const absl::StatusOr<Canvas> one = DrawPicture(at.surfaces, lights, options, Typeface::Find());
  ASSERT_THAT(one, IsOk());
  lights.push_back(FailedFitComparison(Light::Directional("rim", {0, 0, -1}),
                                       absl::FailedPreconditionError("no shadow")));
  const absl::StatusOr<Canvas> two = DrawPicture(at.surfaces, lights, options, Typeface::Find());
  ASSERT_THAT(two, IsOk());
  EXPECT_EQ(two->width(), one->width());
  EXPECT_GT(two->height(), one->height());
  EXPECT_LT(two->height(), one->height() + 200);
  // Three panels of the screen, the bar between them, and the maps.
  EXPECT_GT(one->width(), 3 * HeatPanelSize(at.scene.View()).width + 420);
}

}  // namespace
}  // namespace lightfit
