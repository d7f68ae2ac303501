#include "optimizer/search/axis_evaluator.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "optimizer/light_view.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::FloorCamera;
using testing::FloorReadback;
using testing::IsOk;
using testing::PlaneReadback;
using testing::Random;

// Whether the rays of a read-back are kept depends on how many they are. They are the same rays.
TEST(SampleEvaluator, GivesTheSameFromReceiversAsFromTheirRays) {
  Random random(101);
  const FitOptions options = FitOptions::AsPublished();
  const Light lamp = Light::Point("lamp", {0.3, 0.5, 2.0});
  for (const int width : {64, 1024}) {
    SCOPED_TRACE(width);
    PlaneReadback readback = FloorReadback(FloorCamera(width, width * 9 / 16));
    readback.Cast(0, [width](int x, int y) { return x > width / 3 && y > width / 4; });
    const Surfaces surfaces = *FindSurfaces(readback.View(), 1u, options.samples);
    const absl::StatusOr<LightView> prepared = ViewLight(surfaces, lamp, options);
    ASSERT_THAT(prepared, IsOk());
    const Samples& samples = prepared->samples;
    std::vector<Eigen::Vector3d> rays;
    ForEachSurface(
        surfaces.readback,
        surfaces.affine_depth,
        {},
        {0, 0, readback.camera.width, readback.camera.height, 0.0, 0.0, 1},
        [&](int x, int y, double d) {
          rays.push_back(samples.ray_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0));
        });
    EXPECT_EQ(rays.size(), readback.depth.size());
    AffineProblem problem;
    problem.map = {1024, 1024};
    problem.affine = options.affine;
    problem.normalized_from_ray = prepared->normalized_from_ray();
    const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
    SampleEvaluator from_receivers(samples, surfaces, metric, problem, options.min_w);
    SampleEvaluator from_rays(samples, rays, metric, problem, options.min_w);
    int num_usable = 0;
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d axis(
          random.Uniform(-0.5, 0.5), random.Uniform(-0.5, 0.5), random.Uniform(0.8, 2.0));
      const std::optional<AffineFit> a = from_receivers.Evaluate(axis);
      const std::optional<AffineFit> b = from_rays.Evaluate(axis);
      ASSERT_EQ(a.has_value(), b.has_value()) << i;
      if (!a.has_value()) continue;
      ++num_usable;
      EXPECT_NEAR(a->energy, b->energy, 1e-9 * b->energy) << i;
      EXPECT_LT((a->map_from_ray - b->map_from_ray).norm(), 1e-9 * b->map_from_ray.norm()) << i;
    }
    EXPECT_GE(num_usable, 2);
    EXPECT_EQ(from_receivers.num_evaluations(), num_usable);
  }
}

}  // namespace
}  // namespace lightfit
