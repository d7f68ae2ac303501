// optimizer/figures/forecast_places.h
//
// Where forecasts look: which pixels, which places of a texel's centre, what is seen there.
// In:   Readback, a place on the screen, a pixel's plane.
// Out:  pixels and their bilinear weights; whether a pixel lies on another one's surface.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "optimizer/readback/readback.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// Every how many pixels, along x and y, one is looked at: large read-backs on a grid of about 2^16.
inline int ForecastStride(const Readback& readback) {
  constexpr double kMostPixels = 1 << 16;
  const double num_pixels = static_cast<double>(readback.width()) * readback.height();
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(num_pixels / kMostPixels))));
}

// The mean of value(delta) over places of the centre within the texel, evenly spread, delta in
// [-1/2, 1/2]^2.   math.md (13)
template <typename Value>
double MeanOverPlaces(const Value& value) {
  constexpr int kPlaces = 3;  // in each direction
  double sum = 0.0;
  for (int j = 0; j < kPlaces; ++j) {
    for (int i = 0; i < kPlaces; ++i) {
      sum += value(Eigen::Vector2d((i + 0.5) / kPlaces - 0.5, (j + 0.5) / kPlaces - 0.5));
    }
  }
  return sum / (kPlaces * kPlaces);
}

// Calls visit(x, y, weight) for the pixels that have a bilinear weight at a place of the screen.
// Outside the image its edge continues.
template <typename Visitor>
void ForEachPixelAround(const Readback& readback,
                        const Eigen::Vector2d& place,
                        const Visitor& visit) {
  const double column = std::clamp(place.x() - 0.5, 0.0, readback.width() - 1.0);
  const double row = std::clamp(place.y() - 0.5, 0.0, readback.height() - 1.0);
  const int left = std::min(static_cast<int>(column), readback.width() - 2);
  const int top = std::min(static_cast<int>(row), readback.height() - 2);
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const double weight = (i == 1 ? column - left : 1.0 - (column - left)) *
                            (j == 1 ? row - top : 1.0 - (row - top));
      if (weight > 0.0) visit(left + i, top + j, weight);
    }
  }
}

// A pixel (x, y) and the plane that its depth tells.
struct PixelPlane {
  int x, y;
  DepthGradient gradient;

  // How much deeper than there the plane is at another pixel.
  double RiseTo(int px, int py) const { return (px - x) * gradient.d_x + (py - y) * gradient.d_y; }
};

// Whether a pixel of affine depth d belongs to the surface of that one: off its plane by less than
// a share of the difference, or of the slope, or of the depth.
inline bool IsOnSurface(int px, int py, double d, const PixelPlane& plane) {
  constexpr double kMostBend = 0.3, kDepthTolerance = 1e-3;
  const DepthGradient& gradient = plane.gradient;
  const double rise = d - gradient.d;
  const double slope = std::abs(gradient.d_x) + std::abs(gradient.d_y);
  return std::abs(rise - plane.RiseTo(px, py)) <=
         kMostBend * std::max(std::abs(rise), slope) + kDepthTolerance * std::abs(gradient.d);
}

}  // namespace lightfit
