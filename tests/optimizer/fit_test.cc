// The facade on random scenes: what holds for every matrix of every light.
#include "optimizer/fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstring>
#include <thread>

#include "optimizer/figures/footprint_image.h"
#include "optimizer/search/refine_ceres.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::ExpectAllFinite;
using testing::ExpectCovers;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::MatrixNear;
using testing::RelativeError;
using testing::SquaredFootprints;
using testing::StatusIs;
using testing::TestScene;

constexpr MapSize kMap = {1024, 512};

bool SameBytes(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  return std::memcmp(a.data(), b.data(), sizeof(double) * 16) == 0;
}

struct Choice {
  const char* name;
  FitOptions options;
};

std::vector<Choice> Choices() {
  std::vector<Choice> choices = {{"default", {}}, {"published", FitOptions::AsPublished()}};
  choices.back().options.sample_by_sample = false;
  const auto add = [&choices](const char* name, const auto& change) {
    choices.push_back({name, {}});
    change(choices.back().options);
  };
  add("focused", [](FitOptions& o) { o.search = Search::kFocused; });
  add("line search", [](FitOptions& o) { o.search = Search::kRotationLineSearch; });
  add("ceres", [](FitOptions& o) {
    o.search = Search::kRotationLineSearchRefined;
    if (HasCeres()) o.refiner = Refiner::kCeres;
  });
  add("skewed", [](FitOptions& o) { o.affine = Affine::kSkewedRectangle; });
  add("rectangle", [](FitOptions& o) { o.affine = Affine::kMinAreaRectangle; });
  add("squared", [](FitOptions& o) { o = SquaredFootprints(); });
  add("squared across edge", [](FitOptions& o) { o.metric = Metric::kL2AcrossEdge; });
  add("L1", [](FitOptions& o) { o.metric = Metric::kL1; });
  add("all receivers", [](FitOptions& o) { o.cover = Cover::kReceivers; });
  add("margins", [](FitOptions& o) {
    o.margin_percent = 5.0;
    o.margin_texels = 8.0;
  });
  return choices;
}

TEST(FitLight, EverySurfaceToCoverLiesInsideTheMap) {
  for (const Choice& choice : Choices()) {
    SCOPED_TRACE(choice.name);
    int num_fitted = 0;
    for (uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(seed);
      const TestScene scene(seed, 6);
      const auto matrices = FitLights(scene.View(), scene.lights, kMap, choice.options);
      for (size_t i = 0; i < matrices.size(); ++i) {
        const auto& matrix = matrices[i];
        if (!matrix.ok()) {
          EXPECT_EQ(matrix.status().code(), absl::StatusCode::kFailedPrecondition)
              << matrix.status();
          continue;
        }
        ExpectAllFinite(*matrix);
        ExpectCovers(*matrix, scene.View(), scene.lights[i], choice.options.cover);
        EXPECT_LE(matrix->figures.energy, matrix->search.energy_start * (1.0 + 1e-12))
            << matrix->BriefReport();
        ++num_fitted;
      }
    }
    EXPECT_GE(num_fitted, 25);
  }
}

// Handedness: seen from the light, the map is not mirrored.
TEST(FitLight, MapsAreNotMirrored) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TestScene scene(seed, 6);
    for (size_t i = 0; i < scene.lights.size(); ++i) {
      const auto matrix = FitLight(scene.View(), scene.lights[i], kMap);
      if (!matrix.ok()) continue;
      const Light& light = scene.lights[i];
      const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
      Eigen::Matrix<double, 3, 4> rows;
      rows << matrix->map_from_world.topRows<2>(), matrix->map_from_world.row(3);
      // rows = H ray_from_world; H by least squares.
      const Eigen::Matrix3d H = rows * ray_from_world.transpose() *
                                (ray_from_world * ray_from_world.transpose()).inverse();
      EXPECT_GT(H.determinant(), 0.0) << light.name;
    }
  }
}

// light_matrix.h: w is 1 in the middle of the rays of a directional light.
TEST(FitLight, WIsOfTheOrderOfOneOrOfTheDistance) {
  const TestScene scene(3, 6);
  const auto positions = *ReceiverPositions(scene.View());
  for (const Light& light : scene.lights) {
    const auto matrix = FitLight(scene.View(), light, kMap, SquaredFootprints());
    if (!matrix.ok()) continue;
    double low = 1e300, high = 0.0;
    for (const Eigen::Vector3d& position : positions) {
      const double unit =
          light.kind == Light::Kind::kPoint ? (position - light.position).norm() : 1.0;
      const double w = matrix->map_from_world.row(3).dot(position.homogeneous()) / unit;
      low = std::min(low, w);
      high = std::max(high, w);
    }
    EXPECT_LE(low, 1.0 + 1e-9) << light.name;
    EXPECT_GE(high, 0.2) << light.name;
  }
}

TEST(FitLight, SameInputGivesTheSameBytes) {
  const TestScene scene(4, 6);
  for (const Choice& choice : Choices()) {
    for (const Light& light : scene.lights) {
      const auto first = FitLight(scene.View(), light, kMap, choice.options);
      const auto second = FitLight(scene.View(), light, kMap, choice.options);
      ASSERT_EQ(first.ok(), second.ok());
      if (!first.ok()) continue;
      EXPECT_TRUE(SameBytes(first->map_from_world, second->map_from_world)) << choice.name;
      EXPECT_EQ(first->figures.energy, second->figures.energy);
      EXPECT_EQ(first->figures.footprint.worst, second->figures.footprint.worst);
    }
  }
}

TEST(FitLights, EqualsFitLightOneByOne) {
  for (const Choice& choice : Choices()) {
    const TestScene scene(5, 6);
    const auto together = FitLights(scene.View(), scene.lights, kMap, choice.options);
    ASSERT_EQ(together.size(), scene.lights.size());
    for (size_t i = 0; i < together.size(); ++i) {
      const auto alone = FitLight(scene.View(), scene.lights[i], kMap, choice.options);
      ASSERT_EQ(together[i].ok(), alone.ok());
      if (!alone.ok()) {
        EXPECT_EQ(together[i].status(), alone.status());
        continue;
      }
      EXPECT_EQ(std::string_view(together[i]->light_name), scene.lights[i].name);
      EXPECT_TRUE(SameBytes(together[i]->map_from_world, alone->map_from_world)) << choice.name;
    }
  }
}

TEST(FitLights, ServesThirtyTwoLights) {
  const TestScene scene(6, 32, 160, 100);
  const auto matrices = FitLights(scene.View(), scene.lights, kMap);
  ASSERT_EQ(matrices.size(), 32u);
  int num_fitted = 0;
  for (size_t i = 0; i < matrices.size(); ++i) {
    if (!matrices[i].ok()) continue;
    ExpectCovers(*matrices[i], scene.View(), scene.lights[i]);
    ++num_fitted;
  }
  EXPECT_GE(num_fitted, 28);
}

TEST(FitLights, OfNoLightsIsEmpty) {
  const TestScene scene(1, 1);
  EXPECT_TRUE(FitLights(scene.View(), {}, kMap).empty());
}

TEST(FitLights, RunsFromSeveralThreadsAtOnce) {
  const TestScene scene(7, 6);
  const auto expected = FitLights(scene.View(), scene.lights, kMap);
  std::vector<LightMatrices> results(4);
  std::vector<std::thread> threads;
  for (auto& result : results) {
    threads.emplace_back([&] { result = FitLights(scene.View(), scene.lights, kMap); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : results) {
    ASSERT_EQ(result.size(), expected.size());
    for (size_t i = 0; i < result.size(); ++i) {
      ASSERT_EQ(result[i].ok(), expected[i].ok());
      if (!result[i].ok()) continue;
      EXPECT_TRUE(SameBytes(result[i]->map_from_world, expected[i]->map_from_world));
    }
  }
}

// The squared metrics; for the others see fit_l1_test.cc.
// The focused map is the same to the last bit; a search from a summary goes on where that of a
// frame leaves off, within the tolerance of Polish::kThorough.
TEST(Fit, FromTheSummaryEqualsFitLight) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TestScene scene(seed, 6);
    for (const Light& light : scene.lights) {
      FitOptions options = SquaredFootprints();
      const auto summary = Summarize(scene.View(), light, options);
      ASSERT_THAT(summary, IsOk());
      for (const Search search : {Search::kFocused, Search::kGlobal}) {
        options.search = search;
        const auto whole = FitLight(scene.View(), light, kMap, options);
        const auto from_summary = Fit(*summary, light, kMap, options);
        ASSERT_EQ(whole.ok(), from_summary.ok());
        if (!whole.ok()) continue;
        EXPECT_EQ(from_summary->figures.footprint.worst, 0.0);
        if (search == Search::kFocused) {
          EXPECT_TRUE(SameBytes(whole->map_from_world, from_summary->map_from_world));
          EXPECT_EQ(whole->figures.energy, from_summary->figures.energy);
          EXPECT_LE(
              RelativeError(whole->figures.footprint.rms, from_summary->figures.footprint.rms),
              1e-9);
        } else {
          EXPECT_LE(from_summary->figures.energy, whole->figures.energy);
          EXPECT_GE(from_summary->figures.energy, whole->figures.energy * (1.0 - 1e-3));
        }
      }
    }
  }
}

TEST(Fit, RefusesAMetricThatTheSummaryWasNotSummedWith) {
  constexpr Metric kMetrics[] = {
      Metric::kL2, Metric::kL2AcrossEdge, Metric::kL1, Metric::kL1AcrossEdge};
  const TestScene scene(1, 6);
  for (const Metric summed : kMetrics) {
    FitOptions options;
    options.metric = summed;
    const auto summary = Summarize(scene.View(), scene.lights[0], options);
    ASSERT_THAT(summary, IsOk());
    for (const Metric asked_for : kMetrics) {
      options.metric = asked_for;
      const auto matrix = Fit(*summary, scene.lights[0], kMap, options);
      if (asked_for == summed) {
        EXPECT_THAT(matrix, IsOk());
      } else {
        EXPECT_THAT(matrix,
                    StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("options.metric")));
      }
    }
  }
}

// math.md (3): energy = 2 used rms^2, with the footprint's definition in light_matrix.h.
TEST(FitLight, RmsFollowsFromTheEnergy) {
  const TestScene scene(8, 6);
  for (const Light& light : scene.lights) {
    const auto matrix = FitLight(scene.View(), light, kMap, SquaredFootprints());
    if (!matrix.ok()) continue;
    const double from_energy =
        std::sqrt(0.5 * matrix->figures.energy / matrix->figures.samples.used);
    EXPECT_LE(RelativeError(matrix->figures.footprint.rms, from_energy), 1e-9);
    EXPECT_LE(matrix->figures.footprint.median, matrix->figures.footprint.p99);
    EXPECT_LE(matrix->figures.footprint.p99, matrix->figures.footprint.worst);
    EXPECT_LE(matrix->figures.footprint.rms, matrix->figures.footprint.worst);
    FitOptions quick = SquaredFootprints();
    quick.compute_statistics = false;
    const auto without = FitLight(scene.View(), light, kMap, quick);
    ASSERT_THAT(without, IsOk());
    EXPECT_LE(RelativeError(without->figures.footprint.rms, from_energy), 1e-9);
    EXPECT_EQ(without->figures.footprint.worst, 0.0);
  }
}

TEST(LightMatrix, BriefReportNamesLightSizeAndOutcome) {
  const TestScene scene(1, 1);
  const auto matrix = FitLight(scene.View(), scene.lights[0], kMap);
  ASSERT_THAT(matrix, IsOk());
  EXPECT_THAT(matrix->BriefReport(), ::testing::StartsWith("sun0: 1024x512, energy "));
  EXPECT_THAT(matrix->BriefReport(),
              ::testing::EndsWith(StopReasonName(matrix->search.stop_reason)));
}

}  // namespace
}  // namespace lightfit
