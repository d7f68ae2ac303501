// tests/optimizer/tracking/hanging_lamp.h
//
// A lamp so close to what it lights that tiles of pixels reach around it, and pixels do not.
// In:   size of the image.
// Out:  a bumpy floor, half of it in the lamp's shadow.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/light.h"
#include "tests/testing/plane_readback.h"

namespace lightfit::testing {

struct HangingLamp {
  PlaneReadback readback;
  Light light;

  // The lamp hangs between the highs and lows of the floor, in the column of tiles that begins in
  // the middle of the image. Its shadow is a wedge to the right of it: with a side of 71 degrees to
  // both sides of the row there is room for an axis. `gap` of 1 ... 6: pixels from the lamp to its
  // shadow, more is less close.
  HangingLamp(int width, int height, int gap = 5)
      : readback(FloorReadback(FloorCamera(width, height))) {
    constexpr int kTile = 16;  // no side of a tile is longer
    constexpr double kBump = 0.03, kWedge = 3.0;
    const int column = width / 2 / kTile * kTile + 1, row = height / 2;
    const double depth = readback.depth[readback.Index(column, row)];
    const Eigen::Vector4d screen(column, row + 0.5, 1.0 / depth, 1.0);
    light = Light::Point("lamp", (readback.camera.WorldFromScreen() * screen).hnormalized(), 3);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        readback.depth[readback.Index(x, y)] *=
            static_cast<float>((x + y) % 2 == 0 ? 1.0 - kBump : 1.0 + kBump);
      }
    }
    readback.Cast(3, [&](int x, int y) {
      return x >= column + gap && std::abs(y - row) < kWedge * (x - column);
    });
  }

  // Leaves the shadow alone in the picture.
  void RemoveLitFloor() {
    constexpr float kSky = 1e10f;
    for (size_t i = 0; i < readback.depth.size(); ++i) {
      if (readback.shadow_bits[i] == 0) readback.depth[i] = kSky;
    }
  }
};

}  // namespace lightfit::testing
