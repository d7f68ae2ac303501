// FitOptions and their message: there and back, defaults for what is absent, words that are not
// known.

#include "wire/options_proto.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

// No field at its default.
FitOptions OtherOptions() {
  FitOptions options;
  options.samples.max_depth_bend = 0.25;
  options.samples.depth_noise = 1e-4;
  options.samples.use_outlines = false;
  options.samples.use_terminators = true;
  options.samples.min_cos_light = 0.125;
  options.samples.min_cos_eye = 0.0625;
  options.samples.min_samples = 21;
  options.samples.edge_window = 3;
  options.metric = Metric::kL2AcrossEdge;
  options.cover = Cover::kReceivers;
  options.border = BorderChoice::kAutomatic;
  options.search = Search::kRotationLineSearch;
  options.affine = Affine::kSkewedRectangle;
  options.ray_space = RaySpace::kLightSpace;
  options.refiner = Refiner::kCeres;
  options.margin_percent = 2.5;
  options.margin_texels = 1.5;
  options.min_w = 1e-2;
  options.along_edge_share = 0.75;
  options.reweighting_rounds = 7;
  options.line_search_rounds = 4;
  options.grid_directions = 5;
  options.sample_by_sample = true;
  options.compute_statistics = false;
  options.use_fine_cover = false;
  return options;
}

// Every field of the schema is written and comes back, so that a new one cannot be forgotten.
TEST(OptionsProto, EveryFieldComesBack) {
  const v1::FitOptions defaults = FitOptionsToProto({});
  const v1::FitOptions others = FitOptionsToProto(OtherOptions());
  for (const auto& [here, other] :
       {std::pair<const google::protobuf::Message&, const google::protobuf::Message&>(defaults,
                                                                                      others),
        {defaults.samples(), others.samples()}}) {
    for (int i = 0; i < here.GetDescriptor()->field_count(); ++i) {
      const google::protobuf::FieldDescriptor* field = here.GetDescriptor()->field(i);
      SCOPED_TRACE(field->name());
      EXPECT_TRUE(here.GetReflection()->HasField(here, field));
      EXPECT_TRUE(other.GetReflection()->HasField(other, field));
      std::string value_here, value_other;
      google::protobuf::TextFormat::PrintFieldValueToString(here, field, -1, &value_here);
      google::protobuf::TextFormat::PrintFieldValueToString(other, field, -1, &value_other);
      EXPECT_NE(value_here, value_other);
    }
  }
  for (const v1::FitOptions& proto : {defaults, others}) {
    const absl::StatusOr<FitOptions> options = FitOptionsFromProto(proto);
    ASSERT_THAT(options, IsOk());
    EXPECT_EQ(FitOptionsToProto(*options).SerializeAsString(), proto.SerializeAsString());
  }
}

TEST(OptionsProto, EveryWordComesBack) {
  for (const Metric metric :
       {Metric::kL2, Metric::kL2AcrossEdge, Metric::kL1, Metric::kL1AcrossEdge}) {
    for (const Search search : {Search::kFocused,
                                Search::kRotationLineSearch,
                                Search::kRotationLineSearchRefined,
                                Search::kGlobal}) {
      for (const Affine affine :
           {Affine::kMinAreaRectangle, Affine::kSkewedRectangle, Affine::kMinEnergyParallelogram}) {
        FitOptions options;
        options.metric = metric;
        options.search = search;
        options.affine = affine;
        const absl::StatusOr<FitOptions> back = FitOptionsFromProto(FitOptionsToProto(options));
        ASSERT_THAT(back, IsOk());
        EXPECT_EQ(back->metric, metric);
        EXPECT_EQ(back->search, search);
        EXPECT_EQ(back->affine, affine);
      }
    }
  }
}

TEST(OptionsProto, EveryBorderComesBack) {
  for (const BorderChoice border :
       {BorderChoice::kLit, BorderChoice::kDark, BorderChoice::kAutomatic}) {
    FitOptions options;
    options.border = border;
    const absl::StatusOr<FitOptions> back = FitOptionsFromProto(FitOptionsToProto(options));
    ASSERT_THAT(back, IsOk());
    EXPECT_EQ(back->border, border);
  }
}

// Who does not look at a result's border must find light outside the map.
TEST(OptionsProto, AnAbsentBorderIsLit) {
  EXPECT_EQ(FitOptionsFromProto({})->border, BorderChoice::kLit);
}

TEST(OptionsProto, WhatIsAbsentHasItsDefault) {
  const absl::StatusOr<FitOptions> options = FitOptionsFromProto({});
  ASSERT_THAT(options, IsOk());
  EXPECT_EQ(FitOptionsToProto(*options).SerializeAsString(),
            FitOptionsToProto({}).SerializeAsString());
}

TEST(OptionsProto, UnknownWordsAndWrongValuesAreNamed) {
  const auto refused = [](const auto& change, const std::string& words) {
    v1::FitOptions proto = FitOptionsToProto({});
    change(proto);
    EXPECT_THAT(FitOptionsFromProto(proto),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  refused([](v1::FitOptions& p) { p.set_metric(static_cast<v1::Metric>(17)); },
          "options.metric = 17, want one of METRIC_L2, ");
  refused([](v1::FitOptions& p) { p.set_cover(static_cast<v1::Cover>(-1)); }, "options.cover = -1");
  refused([](v1::FitOptions& p) { p.set_border(static_cast<v1::BorderChoice>(4)); },
          "options.border = 4, want one of BORDER_CHOICE_LIT, ");
  refused([](v1::FitOptions& p) { p.set_search(static_cast<v1::Search>(9)); }, "SEARCH_GLOBAL");
  refused([](v1::FitOptions& p) { p.set_affine(static_cast<v1::Affine>(9)); }, "options.affine");
  refused([](v1::FitOptions& p) { p.set_ray_space(static_cast<v1::RaySpace>(9)); }, "ray_space");
  refused([](v1::FitOptions& p) { p.set_refiner(static_cast<v1::Refiner>(9)); }, "REFINER_CERES");
  refused([](v1::FitOptions& p) { p.set_min_w(std::nan("")); }, "options.min_w = nan");
  refused([](v1::FitOptions& p) { p.mutable_samples()->set_edge_window(99); }, "edge_window = 99");
}

}  // namespace
}  // namespace lightfit
