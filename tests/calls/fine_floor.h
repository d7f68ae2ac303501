// tests/calls/fine_floor.h
//
// A floor with a shadow under a lamp, and a finer image of it whose shadow reaches further.
#pragma once

#include <vector>

#include "geometry/light.h"
#include "optimizer/readback/fine_cover.h"
#include "tests/testing/plane_readback.h"

namespace lightfit::testing {

// `cover` refers to `fine`: not to be copied.
struct ShadowReachesFurther {
  PlaneReadback floor = FloorReadback();
  PlaneReadback fine = FloorReadback(FloorCamera(3 * floor.camera.width, 3 * floor.camera.height));
  FineCover cover;
  std::vector<Light> lights = {Light::Point("lamp", {1.0, 2.0, 5.0}, 0)};

  ShadowReachesFurther() {
    floor.Cast(0, [](int x, int y) { return x > 12 && x < 25 && y > 8 && y < 20; });
    fine.Cast(0, [](int x, int y) { return x > 30 && x < 95 && y > 21 && y < 60; });
    cover.columns = fine.camera.width;
    cover.rows = fine.camera.height;
    cover.nearest = fine.depth;
    cover.shadow_bits = fine.shadow_bits;
  }
  ShadowReachesFurther(const ShadowReachesFurther&) = delete;
  ShadowReachesFurther& operator=(const ShadowReachesFurther&) = delete;
};

}  // namespace lightfit::testing
