// A whole shot of a real renderer: 24 frames of a walk, three lights.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "geometry/affine_depth.h"
#include "geometry/convex_hull.h"
#include "geometry/ray_cone.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "optimizer/energy/summary_total.h"
#include "optimizer/fit.h"
#include "optimizer/light_matrix.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

constexpr int kNumFrames = 24;
constexpr MapSize kMap = {1024, 1024};

class ShotWalk : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string folder = RepositoryPath("../shared/readbacks/shot_walk/");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no read-backs at " << folder;
    const auto lights = ReadLightsFile(folder + "scene.json");
    ASSERT_TRUE(lights.ok()) << lights.status();
    lights_ = *lights;
    for (int i = 1; i <= kNumFrames; ++i) {
      auto frame = ReadReadbackExr(folder + absl::StrFormat("%04d.exr", i), lights_, {});
      ASSERT_TRUE(frame.ok()) << frame.status();
      frames_.push_back(*std::move(frame));
    }
  }

  std::vector<Light> lights_;
  std::vector<ReadbackFile> frames_;
};

// Squared footprints, so that the weights are one and the same however the fit goes.
FitOptions SquaredOptions() {
  FitOptions options;
  options.metric = Metric::kL2AcrossEdge;
  return options;
}

// All frames' samples together, without any summary of a frame: one hull of all shadowed pixels,
// one set of normalised rays, and every frame's samples in those.
struct DirectShot {
  Summary summary;
  std::vector<Samples> samples;
};

DirectShot Together(const std::vector<ReadbackFile>& frames,
                    const Light& light,
                    const FitOptions& options) {
  std::vector<Surfaces> surfaces;
  std::vector<Eigen::Vector3d> rays;
  const uint32_t mask = 1u << light.shadow_bit;
  DepthRange depth = {1e300, -1e300};
  for (const ReadbackFile& frame : frames) {
    const Readback readback = frame.View();
    surfaces.push_back(*FindSurfaces(readback, mask, options.samples));
    const AffineDepth affine_depth(readback.camera, readback.depth_kind);
    const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
    for (int y = 0; y < readback.height(); ++y) {
      for (int x = 0; x < readback.width(); ++x) {
        const size_t pixel = static_cast<size_t>(y) * readback.width() + x;
        const double value = readback.depth[pixel];
        if ((readback.shadow_bits[pixel] & mask) == 0 || !affine_depth.IsSurface(value)) continue;
        const Eigen::Vector4d point =
            world_from_screen *
            Eigen::Vector4d(x + 0.5, y + 0.5, affine_depth.At(x, y, value), 1.0);
        rays.push_back(RayFromWorld(light) * point / point.w());
        depth.near = std::min(depth.near, rays.back().norm());
        depth.far = std::max(depth.far, rays.back().norm());
      }
    }
  }
  DirectShot shot;
  const bool is_point = light.kind == Light::Kind::kPoint;
  const Eigen::Matrix3d frame_from_ray =
      is_point ? FrameAlong(*FeasibleAxis(rays)) : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  std::vector<Eigen::Vector2d> points;
  points.reserve(rays.size());
  for (const Eigen::Vector3d& ray : rays) points.push_back((frame_from_ray * ray).hnormalized());
  RayCover& cover = shot.summary.cover;
  cover.hull = ConvexHull(points);
  cover.normalized_from_ray = *NormalizeRays(frame_from_ray, &cover.hull);
  cover.depth = depth;
  const MetricWeights metric = WeightsOf(options.metric, options.along_edge_share);
  Eigen::Matrix<double, 6, 6> tensor = Eigen::Matrix<double, 6, 6>::Zero();
  for (const Surfaces& frame : surfaces) {
    shot.samples.push_back(
        SelectSamples(frame, light, frame.options, cover.normalized_from_ray, true));
    const Summary summary = SummarizeSamples(shot.samples.back(), cover, metric);
    tensor += summary.tensor.entries();
    shot.summary.total_weight += summary.total_weight;
    shot.summary.counts.used += summary.counts.used;
  }
  shot.summary.metric = metric;
  shot.summary.tensor = EnergyTensor(tensor);
  return shot;
}

TEST_F(ShotWalk, SumOfSummariesIsTheDirectFitOfAllFrames) {
  const FitOptions options = SquaredOptions();
  for (const Light& light : lights_) {
    std::vector<Summary> summaries;
    for (const ReadbackFile& frame : frames_) {
      const auto summary = Summarize(frame.View(), light, options);
      ASSERT_TRUE(summary.ok()) << summary.status();
      summaries.push_back(*summary);
    }
    const auto merged = MergeSummaries(summaries, light);
    ASSERT_TRUE(merged.ok()) << merged.status();
    const auto from_sum = Fit(*merged, light, kMap, options);
    ASSERT_TRUE(from_sum.ok()) << from_sum.status();

    const DirectShot direct = Together(frames_, light, options);
    EXPECT_EQ(direct.summary.counts.used, merged->counts.used);
    const auto from_all = Fit(direct.summary, light, kMap, options);
    ASSERT_TRUE(from_all.ok()) << from_all.status();
    EXPECT_NEAR(from_sum->figures.energy / from_all->figures.energy, 1.0, 1e-9) << light.name;

    // And both are what the samples say one by one.
    const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
    Eigen::Matrix<double, 3, 4> rows;
    rows << from_sum->map_from_world.topRows<2>(), from_sum->map_from_world.row(3);
    const Eigen::Matrix3d map_from_normalized =
        rows * ray_from_world.transpose() *
        (ray_from_world * ray_from_world.transpose()).inverse() *
        direct.summary.cover.normalized_from_ray.inverse();
    double sum = 0.0;
    for (const Samples& samples : direct.samples) {
      sum += Energy(map_from_normalized, samples, direct.summary.metric);
    }
    EXPECT_NEAR(from_sum->figures.energy / sum, 1.0, 1e-9) << light.name;
    std::printf("%s: sum of summaries / direct fit - 1 = %.1e, / sample by sample - 1 = %.1e\n",
                light.name.c_str(),
                from_sum->figures.energy / from_all->figures.energy - 1.0,
                from_sum->figures.energy / sum - 1.0);
  }
}

TEST_F(ShotWalk, AddsUpToTheSameBitsInAnyOrderAndGrouping) {
  const FitOptions options;
  constexpr uint32_t kSeed = 20240611;
  std::mt19937 random(kSeed);
  std::printf("seed %u\n", kSeed);
  for (const Light& light : lights_) {
    std::vector<SummaryTotal> totals;
    for (const ReadbackFile& frame : frames_) {
      const auto summary = Summarize(frame.View(), light, options);
      ASSERT_TRUE(summary.ok()) << summary.status();
      totals.push_back(TotalOf(*summary, light));
    }
    std::optional<Eigen::Matrix4d> first;
    for (int round = 0; round < 10; ++round) {
      std::vector<SummaryTotal> parts = totals;
      while (parts.size() > 1) {
        std::swap(parts[random() % parts.size()], parts.back());
        const SummaryTotal taken = std::move(parts.back());
        parts.pop_back();
        ASSERT_TRUE(AddToTotal(taken, &parts[random() % parts.size()]).ok());
      }
      EXPECT_EQ(parts.front().num_frames, kNumFrames);
      const auto summary = SummaryOfTotal(parts.front());
      ASSERT_TRUE(summary.ok()) << summary.status();
      const auto matrix = Fit(*summary, light, kMap, options);
      ASSERT_TRUE(matrix.ok()) << matrix.status();
      if (!first.has_value()) first = matrix->map_from_world;
      EXPECT_EQ(std::memcmp(first->data(), matrix->map_from_world.data(), 16 * sizeof(double)), 0);
    }
  }
}

}  // namespace
}  // namespace lightfit
