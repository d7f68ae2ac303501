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
