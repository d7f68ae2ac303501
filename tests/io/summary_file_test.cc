// Summary files: what was written comes back to the last bit, sums do not depend on order and
// grouping, and nothing that is wrong with a file goes unnoticed.

#include "io/summary_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <iostream>
#include <limits>

#include "optimizer/fit.h"
#include "optimizer/light_matrix.h"
#include "tests/io/summary_examples.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using testing::BytesOf;
using testing::FileAround;
using testing::FitsOrSaysWhy;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::kMap;
using testing::kWriter;
using testing::SetOf;
using testing::StatusIs;
using testing::Yard;
using testing::YardBytes;
using testing::YardProto;

TEST(SummaryFile, ReadsBackWhatWasWritten) {
  const testing::TemporaryFolder folder;
  const SummarySet set = SetOf(Yard().file, "yard.exr");
  ASSERT_THAT(WriteSummaryFile(folder.File("yard.summary"), set, kWriter), IsOk());
  EXPECT_EQ(folder.num_files(), 1u);
  const absl::StatusOr<SummarySet> read = ReadSummaryFile(folder.File("yard.summary"));
  ASSERT_THAT(read, IsOk());
  ASSERT_EQ(read->lights.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    const SummaryTotal &a = set.lights[i].total, &b = read->lights[i].total;
    EXPECT_EQ(a.light.name, b.light.name);
    EXPECT_EQ(a.light.position, b.light.position);
    EXPECT_EQ(a.light.direction, b.light.direction);
    EXPECT_EQ(b.num_frames, 1);
    const absl::StatusOr<Summary> before = SummaryOfTotal(a), after = SummaryOfTotal(b);
    ASSERT_THAT(before, IsOk());
    ASSERT_THAT(after, IsOk());
    EXPECT_EQ(before->tensor.entries(), after->tensor.entries());
    EXPECT_EQ(before->metric.across_edge, after->metric.across_edge);
    EXPECT_EQ(before->total_weight, after->total_weight);
    EXPECT_EQ(before->footprint_sum, after->footprint_sum);
    EXPECT_EQ(before->cover.hull, after->cover.hull);
    EXPECT_EQ(before->cover.depth.near, after->cover.depth.near);
    EXPECT_EQ(before->cover.depth.far, after->cover.depth.far);
    EXPECT_EQ(before->cover.mean_ray, after->cover.mean_ray);
    const absl::StatusOr<LightMatrix> fit_before = Fit(*before, a.light, kMap, set.options);
    const absl::StatusOr<LightMatrix> fit_after = Fit(*after, b.light, kMap, read->options);
    ASSERT_THAT(fit_before, IsOk());
    ASSERT_THAT(fit_after, IsOk());
    EXPECT_EQ(fit_before->map_from_world, fit_after->map_from_world);
    EXPECT_EQ(fit_before->figures.energy, fit_after->figures.energy);
  }
  EXPECT_EQ(BytesOf(*read), testing::Bytes(folder.File("yard.summary")));
}

// The tensor alone is 36 sums of three doubles.
TEST(SummaryFile, TakesAboutAKilobytePerLight) {
  for (const LightSummary& light : SetOf(Yard().file, "yard.exr").lights) {
    std::cout << light.name() << ": " << SummaryBytes(light) << " bytes\n";
    EXPECT_GT(SummaryBytes(light), 500);
    EXPECT_LT(SummaryBytes(light), 3000);
  }
}

TEST(SummaryFile, EveryMetricAndCoverComesBack) {
  for (const Metric metric :
       {Metric::kL2, Metric::kL2AcrossEdge, Metric::kL1, Metric::kL1AcrossEdge}) {
    for (const Cover cover : {Cover::kReceivers, Cover::kShadowed}) {
      FitOptions options;
      options.metric = metric;
      options.cover = cover;
      const std::string bytes = BytesOf(SetOf(Yard().file, "yard.exr", options));
      const absl::StatusOr<SummarySet> read = ParseSummarySet(bytes);
      ASSERT_THAT(read, IsOk());
      EXPECT_EQ(read->options.metric, metric);
      EXPECT_EQ(read->options.cover, cover);
      for (const LightSummary& light : read->lights) {
        EXPECT_TRUE(FitsOrSaysWhy(light, read->options)) << light.name();
      }
      EXPECT_EQ(BytesOf(*read), bytes);
    }
  }
}

TEST(SummaryFile, HeadersThatAreNotOursSaySo) {
  const std::string& whole = YardBytes();
  const auto refused = [](const std::string& bytes, const std::string& words) {
    EXPECT_THAT(ParseSummarySet(bytes),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  refused("", "is empty");
  refused("this is text, and long enough for a header", "is no summary file");
  refused(whole.substr(0, 10), "cut short");
  refused(whole.substr(0, 100), "has 100 bytes, and should have");
  refused(whole + "x", "and should have");
  std::string bytes = whole;
  bytes[8] = 3;
  refused(bytes, "has format version 3, this lightfit reads 1: update lightfit");
  bytes[8] = 0;
  refused(bytes, "has format version 0, this lightfit reads 1: summarise");
  bytes = whole;
  bytes[500] ^= 1;
  refused(bytes, "checksum");
  // What a transfer in text mode makes of it.
  bytes = whole;
  bytes.erase(bytes.find('\r'), 1);
  refused(bytes, "is no summary file");
}

TEST(SummaryFile, MissingFilesAndFoldersAreNamed) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(ReadSummaryFile(folder.File("none.summary")),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("none.summary")));
  EXPECT_THAT(ReadSummaryFile(folder.File("")),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("folder")));
  EXPECT_THAT(ReadSummaryFile(folder.Write("text.summary", "text")),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       AllOf(HasSubstr("text.summary"), HasSubstr("no summary"))));
}

TEST(SummaryFile, IsKnownByItsFirstBytesOrItsName) {
  const testing::TemporaryFolder folder;
  EXPECT_TRUE(IsSummaryFile(folder.Write("renamed.dat", YardBytes())));
  EXPECT_TRUE(IsSummaryFile(folder.Write("empty.summary", "")));
  EXPECT_FALSE(IsSummaryFile(folder.Write("text.exr", "text")));
  EXPECT_FALSE(IsSummaryFile(folder.File("none.exr")));
  EXPECT_FALSE(IsSummaryFile(testing::RepositoryFile("examples/yard_180/0001.exr")));
}

// Fields of a later version may mean what we do not know.
TEST(SummaryFile, UnknownFieldsAreRefusedWhereverTheyAre) {
  const std::vector<std::function<google::protobuf::Message*(v1::SummaryFile&)>> places = {
      [](v1::SummaryFile& p) { return &p; },
      [](v1::SummaryFile& p) { return p.mutable_options()->mutable_samples(); },
      [](v1::SummaryFile& p) { return p.mutable_lights(2); },
      [](v1::SummaryFile& p) { return p.mutable_lights(0)->mutable_light(); },
      [](v1::SummaryFile& p) { return p.mutable_lights(1)->mutable_total()->mutable_tensor(35); },
      [](v1::SummaryFile& p) { return p.mutable_lights(1)->mutable_total()->mutable_cover(); }};
  for (const auto& place : places) {
    v1::SummaryFile proto = YardProto();
    google::protobuf::Message* message = place(proto);
    message->GetReflection()->MutableUnknownFields(message)->AddVarint(999, 1);
    EXPECT_THAT(
        ParseSummarySet(FileAround(proto.SerializeAsString())),
        StatusIs(absl::StatusCode::kInvalidArgument,
                 AllOf(HasSubstr("field 999"), HasSubstr(kWriter), HasSubstr("update lightfit"))));
  }
}

// Those from before there was a choice, when look-ups outside the map found light.
TEST(SummaryFile, FilesWithoutABorderHaveALitOne) {
  v1::SummaryFile proto = YardProto();
  const absl::StatusOr<SummarySet> with = ParseSummarySet(FileAround(proto.SerializeAsString()));
  ASSERT_THAT(with, IsOk());
  proto.mutable_options()->clear_border();
  const absl::StatusOr<SummarySet> without = ParseSummarySet(FileAround(proto.SerializeAsString()));
  ASSERT_THAT(without, IsOk());
  EXPECT_EQ(without->options.border, BorderChoice::kLit);
  EXPECT_TRUE(BytesOf(*without) == BytesOf(*with));
}

// One change each to a good file, and the word of the field that is to be named.
TEST(SummaryFile, ValuesThatNoSumHasAreNamed) {
  const auto refused = [](const std::function<void(v1::SummaryFile&, v1::LightSummary&)>& change,
                          const std::string& words) {
    v1::SummaryFile proto = YardProto();
    change(proto, *proto.mutable_lights(0));
    EXPECT_THAT(ParseSummarySet(FileAround(proto.SerializeAsString())),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  };
  using File = v1::SummaryFile;
  using L = v1::LightSummary;
  EXPECT_THAT(ParseSummarySet(FileAround(YardProto().SerializeAsString())), IsOk());
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  const double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInfinity, -kInfinity, 1e200, 0.0}) {
    refused([=](File&, L& l) { l.mutable_total()->mutable_tensor(7)->set_parts(0, bad); },
            "tensor[7]");
    refused([=](File&, L& l) { l.mutable_total()->mutable_total_weight()->add_parts(bad); },
            "total_weight");
    refused([=](File&, L& l) { l.mutable_total()->mutable_footprint_sum()->add_parts(bad); },
            "footprint_sum");
    refused([=](File&,
                L& l) { l.mutable_total()->mutable_cover()->mutable_mean_ray(1)->add_parts(bad); },
            "cover.mean_ray[1]");
    refused([=](File&, L& l) { l.mutable_total()->mutable_cover()->set_near(bad); }, "cover.near");
  }
  // Parts that overlap, or in the wrong order, say the same number in other bytes.
  refused(
      [](File&, L& l) {
        v1::ExactSum& sum = *l.mutable_total()->mutable_total_weight();
        const double part = sum.parts(0);
        sum.clear_parts();
        sum.add_parts(0.5 * part);
        sum.add_parts(0.5 * part);
      },
      "each part the nearest");
  refused(
      [](File&, L& l) {
        for (int i = 0; i < 100; ++i) l.mutable_total()->mutable_total_weight()->add_parts(1.0);
      },
      "at most 40");
  refused([](File&, L& l) { l.mutable_total()->mutable_tensor()->RemoveLast(); },
          "35 sums, want 36");
  refused([](File&, L& l) { l.mutable_total()->clear_tensor(); }, "tensor has 0 sums");
  refused([](File&, L& l) { l.mutable_total()->clear_total_weight(); }, "total_weight = 0");
  refused([](File&, L& l) { l.mutable_total()->clear_footprint_sum(); }, "footprint_sum = 0");
  refused([](File&, L& l) { l.mutable_total()->mutable_counts()->set_used(-1); }, "counts = -1");
  refused([](File&, L& l) { l.mutable_total()->mutable_counts()->set_used(1LL << 60); }, "counts");
  refused([](File&, L& l) { l.mutable_total()->mutable_counts()->set_candidates(1); },
          "counts.used");
  refused([](File&, L& l) { l.mutable_total()->set_num_frames(0); }, "num_frames = 0");
  refused([](File&, L& l) { l.mutable_total()->set_num_frames(2); }, "want the same frames");
  refused([](File&, L& l) { l.set_num_frames_without(1); }, "failure");
  refused([](File&, L& l) { l.mutable_failure()->set_code(9); }, "failure");
  refused(
      [](File&, L& l) {
        l.set_num_frames_without(1);
        l.mutable_failure()->set_code(99);
      },
      "failure.code = 99");
  refused([](File&, L& l) { l.mutable_weighed_in()->add_m(1.0); }, "weighed_in");
  refused([](File&, L& l) { l.mutable_total()->mutable_cover()->add_hull(1.0); }, "cover.hull has");
  refused([](File&, L& l) { l.mutable_total()->mutable_cover()->set_hull(4, 0.9); },
          "cover.hull[1]");
  refused([](File&, L& l) { l.mutable_total()->mutable_cover()->set_hull(0, NAN); },
          "cover.hull[0]");
  refused(
      [](File&, L& l) {
        for (int i = 0; i < 3 * 5000; ++i) l.mutable_total()->mutable_cover()->add_hull(1.0);
      },
      "at most 4096 rays");
  // The first two rays the other way round: no longer counter-clockwise.
  refused(
      [](File&, L& l) {
        auto* hull = l.mutable_total()->mutable_cover()->mutable_hull();
        for (int i = 0; i < 3; ++i) hull->SwapElements(i, i + 3);
      },
      "no convex hull");
  refused(
      [](File&, L& l) {
        v1::CoveredRays& cover = *l.mutable_total()->mutable_cover();
        cover.set_near(cover.far() + 1.0);
      },
      "cover.near");
  refused([](File&, L& l) { l.mutable_light()->clear_name(); }, "name is empty");
  refused([](File&, L& l) { l.mutable_light()->add_position(1.0); }, "position");
  refused([](File& f, L&) { f.clear_lights(); }, "lights: none");
  refused([](File& f, L&) { f.mutable_lights()->SwapElements(0, 1); }, "order");
  refused([](File& f, L& l) { f.mutable_lights(1)->CopyFrom(l); }, "taken");
  refused([](File& f, L&) { f.clear_options(); }, "not set");
  refused([](File& f, L&) { f.mutable_options()->clear_min_w(); }, "not set");
  refused([](File& f, L&) { f.mutable_options()->set_metric(static_cast<v1::Metric>(8)); },
          "metric");
  refused([](File& f, L&) { f.mutable_options()->set_metric(v1::METRIC_L2); }, "footprint_sum");
}

TEST(SummaryFile, WhatCouldNotBeReadIsNotWritten) {
  const testing::TemporaryFolder folder;
  SummarySet set = SetOf(Yard().file, "yard.exr");
  set.lights[0].total.depth.far = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(WriteSummaryFile(folder.File("a.summary"), set, kWriter),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("a.summary")));
  EXPECT_EQ(folder.num_files(), 0u);
}

}  // namespace
}  // namespace lightfit
