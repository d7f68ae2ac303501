// The pieces of the picture: colours, scales, lines and the view of a map.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "picture/canvas.h"
#include "picture/color_map.h"
#include "picture/map_panel.h"
#include "picture/text.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;

float Sum(const Canvas& canvas) {
  float sum = 0;
  for (const Rgb& pixel : canvas.pixels()) sum += pixel.r;
  return sum;
}

TEST(Canvas, ALineCoversItsArea) {
  Canvas canvas(100, 100, {});
  const Eigen::Vector2d from(20, 30), to(80, 65);
  canvas.DrawLine(from, to, 3, {1, 1, 1});
  // Length times width, and two round ends of radius 1.5.
  EXPECT_NEAR(Sum(canvas), 3 * (to - from).norm() + M_PI * 1.5 * 1.5, 3);
}

TEST(Canvas, ClipsWhatLiesOutside) {
  Canvas canvas(10, 10, {});
  canvas.DrawLine({-1000, 5}, {1000, 5}, 1, {1, 1, 1});
  EXPECT_NEAR(Sum(canvas), 10, 1e-4);
  canvas.DrawDot({-50, -50}, 4, {1, 1, 1});
  canvas.DrawDot({NAN, 1}, 4, {1, 1, 1});
  canvas.FillRectangle(20, 20, 5, 5, {1, 1, 1});
  EXPECT_NEAR(Sum(canvas), 10, 1e-4);
}

TEST(Canvas, MagnifyingAndReducingGiveThePictureBack) {
  Canvas canvas(3, 2, {});
  canvas.Blend(1, 0, {0.25f, 0.5f, 0.75f});
  const Canvas back = Reduced(Magnified(canvas, 4), 4);
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

TEST(Typeface, DrawsWhatItMeasures) {
  const Typeface typeface = Typeface::Find();
  if (!typeface.found()) GTEST_SKIP() << "no typeface on this machine (fonts-dejavu-core)";
  Canvas canvas(200, 40, {});
  const TextStyle style = {.size_px = 16, .color = {1, 1, 1}};
  const int width = typeface.Width("read-back", style);
  EXPECT_GT(width, 50);
  EXPECT_LT(width, 120);
  typeface.Draw(10, 25, "read-back", style, &canvas);
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      if (canvas.At(x, y).r > 0.1f) {
        ASSERT_GE(x, 9);
        ASSERT_LE(x, 11 + width);
      }
    }
  }
  EXPECT_GT(Sum(canvas), 100);
}

}  // namespace
}  // namespace lightfit
