// tests/partition/plan_case.h
//
// A light in a random box scene, laid open for tests of plans: its view and its served rays.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "optimizer/light_view.h"
#include "optimizer/readback/surfaces.h"
#include "partition/cell_fit.h"
#include "partition/served_rays.h"
#include "tests/testing/test_scene.h"

namespace lightfit::testing {

// Does not move, as its parts refer to each other.
struct PlanCase {
  TestScene scene;
  Readback readback;
  FitOptions fit;
  Surfaces surfaces;
  Light light;
  LightView view;
  ServedRays rays;

  // Light `index` of a scene of three: a sun, a near lamp, a far one.
  PlanCase(uint64_t seed, int index, Border border = Border::kLit, const FitOptions& options = {})
      : scene(seed, 3, 120, 90),
        readback(scene.readback.ViewWithFacing()),
        fit(Automatic(options)),
        surfaces(*FindSurfaces(readback, 0x7, fit.samples)),
        light(scene.lights[index]),
        view(*ViewLight(surfaces, light, border, fit)),
        rays(*FindServedRays(view, fit)) {}
  PlanCase(const PlanCase&) = delete;

  CellFitter Fitter() const { return CellFitter(rays, light, fit); }

  std::vector<int> AllBins() const {
    std::vector<int> bins;
    for (size_t i = 0; i < rays.bins.size(); ++i) bins.push_back(static_cast<int>(i));
    return bins;
  }

 private:
  static FitOptions Automatic(FitOptions options) {
    options.border = BorderChoice::kAutomatic;
    return options;
  }
};

// Whether there are shadows enough for a plan.
inline bool HasShadows(const PlanCase& at) {
  return at.rays.num_covered > 200 && at.rays.num_boundary > 50;
}

}  // namespace lightfit::testing
