// The pieces of the picture: images, colours, scales and the view of a map.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "picture/color_map.h"
#include "picture/image.h"
#include "picture/map_panel.h"
#include "picture/text.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;

TEST(Image, MagnifyingAndReducingGiveThePictureBack) {
  Image image(3, 2, {});
  image.Blend(1, 0, {0.25f, 0.5f, 0.75f});
  const Image back = Reduced(Magnified(image, 4), 4);
  ASSERT_EQ(back.width(), 3);
  ASSERT_EQ(back.height(), 2);
  EXPECT_NEAR(back.At(1, 0).g, 0.5, 1e-6);
  EXPECT_NEAR(back.At(2, 1).g, 0, 1e-6);
}

TEST(LogScale, RunsFromTickToTickAndPassesOne) {
  std::vector<float> values;
  for (int i = 0; i <= 1000; ++i) values.push_back(0.03f * std::pow(100.0f, i / 1000.0f));
  values.insert(values.end(), 500, 0.0f);  // pixels without a footprint
  const LogScale scale = ScaleFor(values);
  EXPECT_DOUBLE_EQ(scale.min, 0.02);
  EXPECT_DOUBLE_EQ(scale.max, 5);
  EXPECT_NEAR(scale.Position(scale.min), 0, 1e-12);
  EXPECT_NEAR(scale.Position(scale.max), 1, 1e-12);
  EXPECT_NEAR(scale.Position(1e9), 1, 1e-12);
  EXPECT_NEAR(scale.Position(0), 0, 1e-12);
  std::vector<std::string> labels;
  for (const double tick : scale.Ticks()) labels.push_back(TickLabel(tick));
  EXPECT_THAT(labels, ElementsAre("0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5"));
}

TEST(LogScale, IsDefinedForNoValuesAndForOne) {
  const LogScale empty = ScaleFor({});
  EXPECT_LT(empty.min, empty.max);
  const std::vector<float> same(10, 1.0f);
  const LogScale one = ScaleFor(same);
  EXPECT_LT(one.min, one.max);
  EXPECT_GT(one.min, 0);
}

// The colours must be told apart: neighbours along the scale differ, the ends most of all.
TEST(HeatColor, ChangesAlongTheScale) {
  const auto distance = [](Rgb a, Rgb b) {
    return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
  };
  for (double t = 0; t < 1; t += 0.05) {
    EXPECT_GT(distance(HeatColor(t), HeatColor(t + 0.05)), 0.02f) << t;
  }
  EXPECT_GT(distance(HeatColor(0), HeatColor(1)), 0.5f);
}

// Whatever the footprints are: 1 is the middle, and both ends are as far from it.
TEST(FootprintScale, HasOneInTheMiddle) {
  const struct {
    float finest, coarsest;
    double end;
  } cases[] = {
      {0.5F, 2.0F, 5}, {0.01F, 0.02F, 50}, {3.0F, 9.0F, 10}, {0.06F, 3.0F, 20}, {1e-5F, 1e5F, 50}};
  for (const auto& of : cases) {
    std::vector<float> values(500, 0.0F);  // pixels without a footprint
    values.insert(values.end(), 500, of.finest);
    values.insert(values.end(), 500, of.coarsest);
    const LogScale scale = FootprintScaleFor(values);
    EXPECT_DOUBLE_EQ(scale.max, of.end);
    EXPECT_DOUBLE_EQ(scale.min, 1.0 / of.end);
    EXPECT_NEAR(scale.Position(1.0), 0.5, 1e-12);
    EXPECT_THAT(scale.Ticks(), ::testing::Contains(::testing::DoubleNear(1.0, 1e-12)));
  }
  const LogScale empty = FootprintScaleFor({});
  EXPECT_NEAR(empty.Position(1.0), 0.5, 1e-12);
}

// A few outliers do not widen the scale.
TEST(FootprintScale, LeavesOutliersOut) {
  std::vector<float> values(10000, 1.5F);
  values.insert(values.end(), 10, 1e6F);
  values.insert(values.end(), 10, 1e-6F);
  EXPECT_DOUBLE_EQ(FootprintScaleFor(values).max, 5.0);
}

// Red means coarser than a pixel and blue finer, and neither is the middle, by a margin.
TEST(FootprintColor, DivergesAtOne) {
  const LogScale scale = FootprintScaleFor({});
  constexpr float kPlain = 0.25F;
  for (const double factor : {1.6, 2.0, 3.0, 5.0, 100.0}) {
    const Rgb coarse = scale.ColorOf(factor), fine = scale.ColorOf(1.0 / factor);
    EXPECT_GT(coarse.r, coarse.b + kPlain) << factor;
    EXPECT_GT(fine.b, fine.r + kPlain) << factor;
  }
  const Rgb one = scale.ColorOf(1.0);
  EXPECT_LT(std::abs(one.r - one.b), 0.2F);
  EXPECT_LT(std::abs(one.r - one.g), 0.05F);
  for (double t = 0; t < 1; t += 0.05) {
    const Rgb a = FootprintColor(t), b = FootprintColor(t + 0.05);
    EXPECT_GT(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b), 0.02F) << t;
  }
}

TEST(Exposure, BrightensADarkSceneToAMiddleGreyAndLeavesABrightOne) {
  std::vector<Rgb> dark(100, Rgb{0.2F, 0.2F, 0.2F});
  dark.resize(140, Rgb{0.9F, 0.9F, 0.9F});
  const Exposure exposure = Exposure::For(dark);
  EXPECT_NEAR(exposure({0.2F, 0.2F, 0.2F}).g, 0.4F, 1e-5F);
  EXPECT_GT(exposure({0.9F, 0.9F, 0.9F}).g, 0.9F);
  EXPECT_LE(exposure({0.9F, 0.9F, 0.9F}).g, 1.0F);
  EXPECT_EQ(exposure({0.0F, 0.0F, 0.0F}).g, 0.0F);
  EXPECT_EQ(exposure({1.0F, 1.0F, 1.0F}).g, 1.0F);
  const std::vector<Rgb> bright(100, Rgb{0.5F, 0.5F, 0.5F});
  EXPECT_EQ(Exposure::For(bright)({0.2F, 0.3F, 0.4F}).b, 0.4F);
  EXPECT_EQ(Exposure::For({})({0.2F, 0.3F, 0.4F}).b, 0.4F);
  // Never more than a curve that leaves surfaces their form.
  const std::vector<Rgb> black(100, Rgb{});
  EXPECT_LT(Exposure::For(black)({0.1F, 0.1F, 0.1F}).g, 0.4F);
}

TEST(MapView, CountsTheHullsShareOfTheMap) {
  // A square of 50 texels in a map of 100 by 50, under a matrix that only scales by 50.
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();
  map_from_world(0, 0) = map_from_world(1, 1) = 50;
  const std::vector<Eigen::Vector3d> receivers = {
      {0, 0, 3}, {1, 0, 3}, {1, 1, 3}, {0, 1, 3}, {7, 7, 3}};
  const std::vector<ReceiverRole> roles = {
      {true, false}, {true, false}, {true, true}, {true, false}, {false, false}};
  const MapView view = ViewMap(receivers, roles, map_from_world, {100, 50});
  EXPECT_EQ(view.receivers.size(), 5u);
  EXPECT_THAT(view.samples, ElementsAre(Eigen::Vector2d(50, 50)));
  EXPECT_NEAR(view.hull_share, 0.5, 1e-12);
  EXPECT_EQ(DrawMapPanel(view, {100, 50}, 420, Typeface()).width(), 420);
}

// One receiver in a crowd gives less than one of 255 steps; together they must show.
TEST(MapPanel, ShowsManyFaintReceivers) {
  MapView view;
  for (int i = 0; i < 100000; ++i) view.receivers.emplace_back(i % 50, i / 50 % 50);
  view.receivers.emplace_back(1e300, -1e300);
  view.samples.emplace_back(NAN, 1);
  const MapView empty;
  const auto sum = [](const MapView& map) {
    const Image panel = DrawMapPanel(map, {100, 100}, 420, Typeface()).ToImage();
    double blue = 0;
    for (const Rgb& pixel : panel.pixels()) blue += pixel.b;
    return blue;
  };
  EXPECT_GT(sum(view), 1.2 * sum(empty));
}

}  // namespace
}  // namespace lightfit
