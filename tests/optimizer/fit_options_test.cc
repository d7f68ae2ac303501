#include "optimizer/fit_options.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void ExpectRejected(const char* field, const std::function<void(FitOptions&)>& change) {
  FitOptions options;
  change(options);
  EXPECT_THAT(ValidateFitOptions(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(field)));
}

TEST(ValidateFitOptions, AcceptsDefaultsAndAsPublished) {
  EXPECT_THAT(ValidateFitOptions(FitOptions()), IsOk());
  EXPECT_THAT(ValidateFitOptions(FitOptions::AsPublished()), IsOk());
}

TEST(FitOptions, DefaultsAreFootprintsAcrossTheEdgeWithTheShadowsInTheMap) {
  const FitOptions options;
  EXPECT_EQ(options.metric, Metric::kL1AcrossEdge);
  EXPECT_EQ(options.cover, Cover::kShadowed);
  EXPECT_EQ(options.search, Search::kGlobal);
  EXPECT_EQ(options.affine, Affine::kMinEnergyParallelogram);
  EXPECT_TRUE(options.samples.use_outlines);
}

TEST(IsL1, TellsFootprintsFromSquaredOnes) {
  EXPECT_TRUE(IsL1(Metric::kL1));
  EXPECT_TRUE(IsL1(Metric::kL1AcrossEdge));
  EXPECT_FALSE(IsL1(Metric::kL2));
  EXPECT_FALSE(IsL1(Metric::kL2AcrossEdge));
}

TEST(ValidateFitOptions, RejectsSampleOptionsOutOfRange) {
  for (const double bad : {0.0, -1.0, 1.5, kNaN}) {
    ExpectRejected("options.samples.max_depth_bend = ",
                   [bad](FitOptions& o) { o.samples.max_depth_bend = bad; });
  }
  for (const double bad : {-1e-9, kNaN, kInfinity}) {
    ExpectRejected("options.samples.depth_noise = ",
                   [bad](FitOptions& o) { o.samples.depth_noise = bad; });
  }
  for (const double bad : {-0.1, 1.0, kNaN}) {
    ExpectRejected("options.samples.min_cos_light = ",
                   [bad](FitOptions& o) { o.samples.min_cos_light = bad; });
    ExpectRejected("options.samples.min_cos_eye = ",
                   [bad](FitOptions& o) { o.samples.min_cos_eye = bad; });
  }
  ExpectRejected("options.samples.min_samples = 0",
                 [](FitOptions& o) { o.samples.min_samples = 0; });
  for (const int bad : {0, 9}) {
    ExpectRejected("options.samples.edge_window = ",
                   [bad](FitOptions& o) { o.samples.edge_window = bad; });
  }
}

TEST(ValidateFitOptions, RejectsMarginsOutOfRange) {
  for (const double bad : {-0.1, 101.0, kNaN}) {
    ExpectRejected("options.margin_percent = ", [bad](FitOptions& o) { o.margin_percent = bad; });
  }
  for (const double bad : {-0.1, kInfinity, kNaN}) {
    ExpectRejected("options.margin_texels = ", [bad](FitOptions& o) { o.margin_texels = bad; });
  }
}

TEST(ValidateFitOptions, RejectsSearchOptionsOutOfRange) {
  for (const double bad : {0.0, 1.0, -1.0, kNaN}) {
    ExpectRejected("options.min_w = ", [bad](FitOptions& o) { o.min_w = bad; });
  }
  for (const double bad : {0.0, 1.1, kNaN}) {
    ExpectRejected("options.along_edge_share = ",
                   [bad](FitOptions& o) { o.along_edge_share = bad; });
  }
  ExpectRejected("options.reweighting_rounds = 0", [](FitOptions& o) { o.reweighting_rounds = 0; });
  ExpectRejected("options.line_search_rounds = 0", [](FitOptions& o) { o.line_search_rounds = 0; });
  ExpectRejected("options.grid_directions = 2", [](FitOptions& o) { o.grid_directions = 2; });
}

TEST(ValidateFitOptions, RejectsSampleBySampleWithWhatNeedsTheSummary) {
  FitOptions options = FitOptions::AsPublished();
  options.affine = Affine::kMinEnergyParallelogram;
  EXPECT_THAT(ValidateFitOptions(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("parallelogram")));
  for (const Search search : {Search::kGlobal, Search::kRotationLineSearchRefined}) {
    options = FitOptions::AsPublished();
    options.search = search;
    EXPECT_THAT(ValidateFitOptions(options),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("sample_by_sample")));
  }
}

}  // namespace
}  // namespace lightfit
