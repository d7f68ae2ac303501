#include "io/camera_convention.h"

#include <gtest/gtest.h>

#include "tests/io/testing.h"

namespace lightfit {
namespace {

TEST(CameraConvention, EmptyWordsAreTheStandard) {
  const auto convention = ParseCameraConvention("");
  ASSERT_TRUE(convention.ok()) << convention.status();
  EXPECT_EQ(*convention, CameraConvention::OpenExr());
  EXPECT_EQ(CameraConventionWords(*convention), "");
}

TEST(CameraConvention, WordsReadBackForAllConventions) {
  for (int bits = 0; bits < 64; ++bits) {
    CameraConvention convention;
    convention.layout = static_cast<CameraConvention::Layout>(bits & 1);
    convention.ndc_range = static_cast<CameraConvention::NdcRange>(bits >> 1 & 1);
    convention.ndc_y = static_cast<CameraConvention::NdcY>(bits >> 2 & 1);
    convention.view_axis = static_cast<CameraConvention::ViewAxis>(bits >> 3 & 1);
    convention.ndc_w = static_cast<CameraConvention::NdcW>(bits >> 4 & 1);
    convention.ndc_span = static_cast<CameraConvention::NdcSpan>(bits >> 5 & 1);
    const std::string words = CameraConventionWords(convention);
    const auto read = ParseCameraConvention(words);
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(*read, convention) << words;
  }
}

TEST(CameraConvention, PresetsAndWordsCombineAndLaterOnesWin) {
  const auto convention = ParseCameraConvention(" pbrt , row-vectors,y-up, y-down");
  ASSERT_TRUE(convention.ok()) << convention.status();
  CameraConvention expected = CameraConvention::Pbrt();
  expected.layout = CameraConvention::Layout::kRowVectors;
  expected.ndc_y = CameraConvention::NdcY::kDown;
  EXPECT_EQ(*convention, expected);
  EXPECT_EQ(CameraConventionWords(expected), "shorter-side");
  EXPECT_EQ(CameraConventionWords({}, expected), "whole-frame");
}

TEST(CameraConvention, NamesTheUnknownWordAndTheKnownOnes) {
  const auto convention = ParseCameraConvention("mantra,sideways");
  ASSERT_EQ(convention.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(testing::HasAll(convention.status().message(),
                              {"\"sideways\"", "column-vectors", "w-negative", "pbrt"}));
}

}  // namespace
}  // namespace lightfit
