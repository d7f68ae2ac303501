// tests/testing/fit_station.h
//
// The stations of the fit laid open: a light's samples, summary and affine problem, for tests of
// the searches.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "optimizer/energy/summary.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "optimizer/search/affine.h"
#include "optimizer/search/axis_evaluator.h"
#include "tests/testing/test_scene.h"

namespace lightfit::testing {

inline constexpr double kMinW = 1e-3;

struct FitStation {
  Light light;
  Samples samples;
  Summary summary;
  AffineProblem problem;

  // At the receivers' mean, or in the middle of their cone.
  AffineFit Start(AxisEvaluator& evaluator) const {
    const Eigen::Vector3d mean =
        summary.cover.normalized_from_ray.inverse().transpose() * summary.cover.mean_ray;
    std::optional<AffineFit> start = evaluator.Evaluate(mean);
    if (!start.has_value()) start = evaluator.Evaluate(Eigen::Vector3d::UnitZ());
    EXPECT_TRUE(start.has_value()) << light.name;
    return *start;
  }
  AffineFit Start() const {
    SummaryEvaluator evaluator(summary, problem, kMinW);
    return Start(evaluator);
  }
};

// One station for each light of some random scenes that has samples enough.
inline std::vector<FitStation> FitStations(int num_scenes,
                                           Affine affine,
                                           RaySpace ray_space = RaySpace::kNormalized) {
  std::vector<FitStation> stations;
  for (int seed = 1; seed <= num_scenes; ++seed) {
    const TestScene scene(seed, 6);
    const Surfaces surfaces = *FindSurfaces(scene.View(), 0x3f, SquaredFootprints().samples);
    for (const Light& light : scene.lights) {
      const absl::StatusOr<RayCover> cover = CoverReceivers(surfaces, light);
      EXPECT_TRUE(cover.ok()) << cover.status();
      if (!cover.ok()) continue;
      FitStation station;
      station.light = light;
      station.samples =
          SelectSamples(surfaces, light, surfaces.options, cover->normalized_from_ray, false);
      if (station.samples.size() < 8) continue;
      station.summary = SummarizeSamples(station.samples, *cover, {0.0, 1.0});
      station.problem.map = {1024, 512};
      station.problem.affine = affine;
      station.problem.ray_space = ray_space;
      station.problem.normalized_from_ray = cover->normalized_from_ray;
      station.problem.margin_percent = 1.0;
      stations.push_back(station);
    }
  }
  return stations;
}

}  // namespace lightfit::testing
