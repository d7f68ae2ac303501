// A view of a light answers for the options it was made with, and refuses all others.
#include "optimizer/light_view.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "optimizer/evaluate.h"
#include "optimizer/fit.h"
#include "optimizer/sizing/tolerance.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::SquaredFootprints;
using testing::StatusIs;
using testing::TestScene;

constexpr MapSize kMap = {256, 256};

// What is asked of a view in the metric of the options.
std::vector<absl::Status> AskInMetric(const LightView& view, const FitOptions& options) {
  const absl::StatusOr<LightMatrix> matrix = FitLight(view, kMap, options);
  const Eigen::Matrix4d anybodys =
      matrix.ok() ? matrix->map_from_world : Eigen::Matrix4d::Identity();
  return {matrix.status(),
          Summarize(view, options).status(),
          SummarizeInMap(view, anybodys, options).status(),
          EvaluateMatrix(view, anybodys, kMap, options).status()};
}

// And what has a metric of its own.
std::vector<absl::Status> AskAll(const LightView& view, const FitOptions& options) {
  std::vector<absl::Status> answers = AskInMetric(view, options);
  answers.push_back(MeetTolerance(view, Tolerance(), MapSizeRules(), options).status());
  return answers;
}

TEST(LightView, AnswersForItsOwnOptionsAlone) {
  const TestScene scene(1, 1);
  const Light& light = scene.lights[0];
  const FitOptions made_with = SquaredFootprints();
  const auto surfaces =
      FindSurfaces(scene.View(), uint32_t{1} << light.shadow_bit, made_with.samples);
  ASSERT_THAT(surfaces, IsOk());
  const auto view = ViewLight(*surfaces, light, made_with);
  ASSERT_THAT(view, IsOk());
  ASSERT_GT(view->samples.size(), 0);
  for (const absl::Status& status : AskAll(*view, made_with)) EXPECT_THAT(status, IsOk());

  FitOptions across_edges = made_with;
  across_edges.metric = Metric::kL1AcrossEdge;
  for (const absl::Status& status : AskInMetric(*view, across_edges)) {
    EXPECT_THAT(status,
                StatusIs(absl::StatusCode::kInvalidArgument,
                         AllOf(HasSubstr(light.name), HasSubstr("options.metric"))));
  }
  FitOptions other_samples = made_with;
  other_samples.samples.min_cos_light *= 2.0;
  for (const absl::Status& status : AskAll(*view, other_samples)) {
    EXPECT_THAT(status,
                StatusIs(absl::StatusCode::kInvalidArgument,
                         AllOf(HasSubstr(light.name), HasSubstr("options.samples"))));
  }
}

TEST(LightView, HowManySamplesAreEnoughIsAskedLater) {
  const TestScene scene(2, 1);
  const Light& light = scene.lights[0];
  FitOptions options = SquaredFootprints();
  const auto surfaces =
      FindSurfaces(scene.View(), uint32_t{1} << light.shadow_bit, options.samples);
  ASSERT_THAT(surfaces, IsOk());
  const auto view = ViewLight(*surfaces, light, options);
  ASSERT_THAT(view, IsOk());
  options.samples.min_samples = view->samples.size() + 1;
  const auto few = FitLight(*view, kMap, options);
  ASSERT_THAT(few, IsOk());
  EXPECT_EQ(few->search.stop_reason, StopReason::kTooFewSamples);
}

TEST(LightView, IsOfSurfacesFoundForItsSamples) {
  const TestScene scene(1, 1);
  const Light& light = scene.lights[0];
  FitOptions options;
  const auto surfaces =
      FindSurfaces(scene.View(), uint32_t{1} << light.shadow_bit, options.samples);
  ASSERT_THAT(surfaces, IsOk());
  options.samples.max_depth_bend *= 2.0;
  EXPECT_THAT(ViewLight(*surfaces, light, options).status(),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("max_depth_bend")));
}

}  // namespace
}  // namespace lightfit
