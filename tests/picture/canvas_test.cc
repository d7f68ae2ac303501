// Lines, dots, rectangles and images on a page.

#include "picture/canvas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace lightfit {
namespace {

constexpr double kStep = 1.0 / 255;  // of a pixel's value

float Sum(const Canvas& canvas) {
  const Image image = canvas.ToImage();
  float sum = 0;
  for (const Rgb& pixel : image.pixels()) sum += pixel.r;
  return sum;
}

TEST(Canvas, ALineCoversItsArea) {
  Canvas canvas(100, 100, {});
  const Eigen::Vector2d from(20, 30), to(80, 65);
  canvas.DrawLine(from, to, 3, {1, 1, 1});
  // Length times width, and two round ends of radius 1.5.
  EXPECT_NEAR(Sum(canvas), 3 * (to - from).norm() + M_PI * 1.5 * 1.5, 3);
}

TEST(Canvas, ADotCoversItsArea) {
  for (const double radius : {0.8, 2.0, 4.5, 12.0}) {
    Canvas canvas(40, 40, {});
    canvas.DrawDot({20.3, 19.6}, radius, {1, 1, 1});
    EXPECT_NEAR(Sum(canvas), M_PI * radius * radius, 0.03 * M_PI * radius * radius) << radius;
  }
}

TEST(Canvas, ClipsWhatLiesOutside) {
  Canvas canvas(10, 10, {});
  canvas.DrawLine({-1000, 5}, {1000, 5}, 1, {1, 1, 1});
  // Twice ten half pixels, each rounded to a step.
  EXPECT_NEAR(Sum(canvas), 10, 20 * kStep);
  const float before = Sum(canvas);
  canvas.DrawDot({-50, -50}, 4, {1, 1, 1});
  canvas.DrawDot({NAN, 1}, 4, {1, 1, 1});
  canvas.DrawLine({NAN, 1}, {5, INFINITY}, 4, {1, 1, 1});
  canvas.FillRectangle(20, 20, 5, 5, {1, 1, 1});
  canvas.DrawImage(-7, 3, Image(5, 5, {1, 1, 1}));
  canvas.DrawImage(3, 12, Image(5, 5, {1, 1, 1}));
  EXPECT_EQ(Sum(canvas), before);
  canvas.DrawImage(8, -3, Image(5, 5, {1, 1, 1}));
  EXPECT_NEAR(Sum(canvas), before + 4, kStep);
}

// Hulls in maps reach far beyond the panel: Cairo's own coordinates would wrap around.
TEST(Canvas, DrawsTheVisiblePartOfVeryLongLines) {
  for (const double far : {1e5, 1e8, 1e12}) {
    Canvas canvas(10, 10, {});
    canvas.DrawLine({-far, 5}, {far, 5}, 1, {1, 1, 1});
    EXPECT_NEAR(Sum(canvas), 10, 20 * kStep) << far;
    Canvas apart(10, 10, {});
    apart.DrawPolygon({{-far, -far}, {far, -far}, {far, far}}, 1, {1, 1, 1});
    // The third side is the diagonal through the page.
    EXPECT_GT(apart.At(5, 5).r, 0.5f) << far;
    EXPECT_EQ(apart.At(0, 9).r, 0) << far;
  }
  Canvas canvas(10, 10, {});
  for (const double far : {1e17, 1e200, 1.7e308}) {
    canvas.DrawLine({-far, 0.3 * far}, {far, -0.2 * far}, 1, {1, 1, 1});
  }
  EXPECT_EQ(cairo_status(canvas.context()), CAIRO_STATUS_SUCCESS);
}

TEST(Canvas, APolygonCoversItsCornersOnce) {
  Canvas canvas(40, 40, {});
  canvas.DrawPolygon({{10, 10}, {30, 10}, {30, 30}, {10, 30}}, 4, {1, 1, 1}, 0.5f);
  EXPECT_NEAR(canvas.At(10, 10).r, 0.5, 2 * kStep);
  EXPECT_NEAR(canvas.At(20, 10).r, 0.5, 2 * kStep);
}

TEST(Canvas, KeepsColoursOfRectanglesAndImages) {
  const Rgb color = HexColor(0x9aa3b2);
  Canvas canvas(4, 2, {});
  canvas.FillRectangle(0, 0, 2, 2, color);
  canvas.DrawImage(2, 0, Image(2, 2, color));
  Canvas page(8, 2, {});
  page.DrawCanvas(3, 0, canvas);
  for (int x = 3; x < 7; ++x) {
    EXPECT_EQ(page.At(x, 1).r, color.r);
    EXPECT_EQ(page.At(x, 1).g, color.g);
    EXPECT_EQ(page.At(x, 1).b, color.b);
  }
  EXPECT_EQ(page.At(2, 1).g, 0);
  EXPECT_EQ(page.At(7, 1).g, 0);
  const Canvas moved = std::move(page);
  EXPECT_EQ(moved.At(3, 0).r, color.r);
}

TEST(Canvas, WithoutPixelsIsDrawnOnInVain) {
  Canvas canvas(kMaxCanvasSide + 1, 1, {1, 1, 1});
  canvas.FillRectangle(0, 0, 1, 1, {1, 1, 1});
  canvas.DrawImage(0, 0, Image(1, 1, {1, 1, 1}));
  canvas.DrawDot({0, 0}, 1, {1, 1, 1});
  EXPECT_EQ(canvas.At(0, 0).r, 0);
  EXPECT_EQ(Sum(canvas), 0);
}

}  // namespace
}  // namespace lightfit
