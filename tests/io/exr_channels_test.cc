// Which channels of multi-part and stereo files are taken, and how they may be named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/exr/channels.h"
#include "io/fine_cover_exr.h"
#include "io/readback_exr.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using testing::ExrPart;
using testing::HasAll;
using testing::TemporaryFolder;

const std::vector<Light> kLights = {Light::Directional("sun", Eigen::Vector3d(0.0, 0.0, -1.0), 0),
                                    Light::Point("key", Eigen::Vector3d(1.0, 2.0, 3.0), 1)};

double DepthValue(int x, int y) { return 2.0 + x + 0.125 * y; }
double NearDepth(int x, int y) { return 1.0 + 0.5 * DepthValue(x, y); }
double NoDepth(int x, int y) { return x - y; }
double SunShadow(int x, int) { return x % 2; }
double KeyShadow(int, int y) { return y % 3 == 0 ? 1.0 : 0.0; }
double NoShadow(int, int) { return 0.0; }

// A part with the standard camera, whose focal length tells cameras apart.
ExrPart Part(const std::string& name,
             std::vector<testing::Channel> channels,
             double focal_heights = 1.2) {
  ExrPart part;
  part.name = name;
  part.channels = std::move(channels);
  const testing::StandardMatrices matrices =
      testing::Standard(part.width, part.height, focal_heights);
  part.matrices = {{"worldToCamera", matrices.world_to_camera},
                   {"worldToNDC", matrices.world_to_ndc}};
  return part;
}

ExrPart WithoutCamera(ExrPart part) {
  part.matrices.clear();
  return part;
}

ExrPart OfView(const std::string& view, ExrPart part) {
  part.view = view;
  return part;
}

class ExrChannels : public ::testing::Test {
 protected:
  absl::StatusOr<ReadbackFile> Read(const std::vector<ExrPart>& parts,
                                    const ReadbackExrOptions& options = {}) const {
    testing::WriteExr(folder_.File("a.exr"), parts);
    return ReadReadbackExr(folder_.File("a.exr"), kLights, options);
  }

  // The file is refused, and why has all of these words.
  void ExpectRefused(const std::vector<ExrPart>& parts,
                     const ReadbackExrOptions& options,
                     const std::vector<std::string>& words) const {
    const auto file = Read(parts, options);
    ASSERT_FALSE(file.ok());
    EXPECT_TRUE(HasAll(file.status().message(), words));
  }

  TemporaryFolder folder_;
};

ReadbackExrOptions OptionsOfView(const std::string& view) {
  ReadbackExrOptions options;
  options.view = view;
  return options;
}

// Left and right eye, with all that differs between them: depth, shadows, camera.
std::vector<ExrPart> StereoParts() {
  return {
      OfView("right", Part("beauty.right", {{"R", Imf::HALF, NoDepth}}, 2.0)),
      OfView("right", WithoutCamera(Part("depth.right", {{"Z", Imf::FLOAT, NearDepth}}))),
      OfView("right",
             WithoutCamera(Part("shadow.right",
                                {{"key", Imf::HALF, NoShadow}, {"sun", Imf::HALF, NoShadow}}))),
      OfView("left", Part("beauty.left", {{"R", Imf::HALF, NoDepth}}, 1.2)),
      OfView("left", WithoutCamera(Part("depth.left", {{"Z", Imf::FLOAT, DepthValue}}))),
      OfView("left",
             WithoutCamera(Part("shadow.left",
                                {{"key", Imf::HALF, KeyShadow}, {"sun", Imf::HALF, SunShadow}})))};
}

void ExpectLeft(const absl::StatusOr<ReadbackFile>& file) {
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->light_status, ElementsAre(absl::OkStatus(), absl::OkStatus()));
  EXPECT_EQ(file->origin.view, "left");
  for (int i = 0; i < 48; ++i) {
    const int x = i % 8, y = i / 8;
    EXPECT_EQ(file->depth[i], static_cast<float>(DepthValue(x, y)));
    EXPECT_EQ(file->shadow_bits[i],
              (SunShadow(x, y) > 0.5 ? 1U : 0U) | (KeyShadow(x, y) > 0.5 ? 2U : 0U));
  }
  EXPECT_LE(testing::LargestScreenDifference(testing::StandardCamera(8, 6), file->camera), 1e-6);
}

TEST_F(ExrChannels, LayersThatArePartsAreNamedByPart) {
  const std::vector<ExrPart> parts = {
      Part("rgba", {{"B", Imf::HALF, NoDepth}, {"red", Imf::HALF, NoShadow}}),
      Part("shadow_sun", {{"blue", Imf::HALF, NoShadow}, {"red", Imf::HALF, SunShadow}}),
      Part("shadow_key", {{"blue", Imf::HALF, NoShadow}, {"red", Imf::HALF, KeyShadow}}),
      Part("depth", {{"Z", Imf::FLOAT, DepthValue}})};
  ReadbackExrOptions options;
  options.shadow_channel_format = "shadow_{light}.red";
  const auto file = Read(parts, options);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->light_status, ElementsAre(absl::OkStatus(), absl::OkStatus()));
  EXPECT_EQ(file->shadow_bits[1], 3U);
  EXPECT_EQ(file->shadow_bits[8 + 1], 1U);
  EXPECT_EQ(file->origin.depth_channel, "Z");
  EXPECT_EQ(file->origin.depth_part, "depth");
  EXPECT_EQ(file->origin.camera_part, "depth");
  EXPECT_THAT(*ListShadowLights(folder_.File("a.exr"), options), ElementsAre("sun", "key"));

  options.shadow_channel_format = "{light}_shadow.red";
  const auto misspelt = Read(parts, options);
  ASSERT_TRUE(misspelt.ok()) << misspelt.status();
  EXPECT_TRUE(HasAll(misspelt->light_status[0].message(),
                     {"sun_shadow.red", "part \"shadow_sun\": \"blue\", \"red\""}));
}

TEST_F(ExrChannels, ANameInSeveralPartsIsRefusedWithThem) {
  const std::vector<ExrPart> parts = {
      Part("depth", {{"Z", Imf::FLOAT, DepthValue}, {"shadow.sun", Imf::HALF, SunShadow}}),
      Part("one", {{"Z", Imf::FLOAT, NoDepth}, {"shadow.key", Imf::HALF, KeyShadow}}),
      Part("two", {{"shadow.key", Imf::HALF, NoShadow}, {"shadow.sun", Imf::HALF, NoShadow}})};
  ReadbackExrOptions options;
  auto file = Read(parts, options);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->light_status[0].ok()) << "the part of the depth comes first";
  EXPECT_TRUE(HasAll(file->light_status[1].message(),
                     {"light \"key\"", "of part \"one\"", "of part \"two\"", "PART.CHANNEL"}));
  options.shadow_channels["key"] = "one.shadow.key";
  file = Read(parts, options);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->light_status[1].ok()) << file->light_status[1];
  EXPECT_EQ(file->shadow_bits[0], 2U);

  options.depth_channel = "Z";
  ExpectRefused(parts, options, {"\"Z\" of part \"depth\"", "\"Z\" of part \"one\""});
  options.depth_channel = "one.Z";
  EXPECT_EQ(Read(parts, options)->origin.depth_part, "one");
}

TEST_F(ExrChannels, OfAStereoFileAllIsOfOneView) {
  ExpectLeft(Read(StereoParts(), OptionsOfView("left")));
  const auto right = Read(StereoParts(), OptionsOfView("right"));
  ASSERT_TRUE(right.ok()) << right.status();
  EXPECT_EQ(right->depth[0], static_cast<float>(NearDepth(0, 0)));
  EXPECT_LE(testing::LargestScreenDifference(testing::StandardCamera(8, 6, 2.0), right->camera),
            1e-6);
  EXPECT_EQ(OriginText(right->origin),
            "depth \"Z\" of part \"depth.right\", camera of part \"beauty.right\", view \"right\"");
}

TEST_F(ExrChannels, TwoViewsAreRefusedUntilOneIsNamed) {
  ExpectRefused(StereoParts(),
                {},
                {"\"right\", \"left\"", "view", "part \"depth.left\"", "part \"depth.right\""});
  ExpectRefused(StereoParts(), OptionsOfView("centre"), {"\"centre\"", "\"right\", \"left\""});
  ExpectRefused({Part("depth", {{"Z", Imf::FLOAT, DepthValue}})},
                OptionsOfView("left"),
                {"no view \"left\"", "none"});
  // A name may say the view, too.
  ReadbackExrOptions options;
  options.depth_channel = "depth.left.Z";
  ExpectLeft(Read(StereoParts(), options));
  options.depth_channel = "depth.Z";
  ExpectRefused(StereoParts(), options, {"\"right\", \"left\""});
}

TEST_F(ExrChannels, TheOnlyViewWithADepthIsTaken) {
  std::vector<ExrPart> parts = StereoParts();
  parts[1].channels[0].name = "G";
  ExpectLeft(Read(parts));
  ExpectRefused(parts, OptionsOfView("right"), {"view \"right\"", "depth_channel"});
}

TEST_F(ExrChannels, WhatTheViewLacksIsNotTakenFromTheOther) {
  std::vector<ExrPart> parts = StereoParts();
  parts[5].channels[0].name = "other";
  const auto file = Read(parts, OptionsOfView("left"));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->light_status[0].ok());
  EXPECT_TRUE(HasAll(file->light_status[1].message(), {"shadow.key", "in the view \"left\""}));

  parts = StereoParts();
  parts[3].matrices.clear();
  ExpectRefused(parts, OptionsOfView("left"), {"worldToCamera", "view \"left\""});
}

TEST_F(ExrChannels, OnePartMayHaveSeveralViews) {
  ExrPart part = Part("all",
                      {{"Z", Imf::FLOAT, DepthValue},
                       {"right.Z", Imf::FLOAT, NearDepth},
                       {"shadow.key", Imf::HALF, KeyShadow},
                       {"shadow.right.key", Imf::HALF, NoShadow},
                       {"shadow.right.sun", Imf::HALF, NoShadow},
                       {"shadow.sun", Imf::HALF, SunShadow}});
  part.multi_view = {"left", "right"};
  ExpectRefused({part}, {}, {"\"left\", \"right\"", "\"right.Z\""});
  ExpectLeft(Read({part}, OptionsOfView("left")));
  // The header has the camera of the default view.
  ReadbackExrOptions options = OptionsOfView("right");
  ExpectRefused({part}, options, {"worldToCamera", "\"left\"", "\"right\"", "camera"});
  options.camera = testing::StandardCamera(8, 6, 2.0);
  const auto right = Read({part}, options);
  ASSERT_TRUE(right.ok()) << right.status();
  EXPECT_EQ(right->depth[0], static_cast<float>(NearDepth(0, 0)));
  EXPECT_EQ(right->shadow_bits, std::vector<uint32_t>(48, 0));
}

TEST_F(ExrChannels, CamerasOfOtherPartsMustAgree) {
  const ExrPart depth = WithoutCamera(Part("depth",
                                           {{"Z", Imf::FLOAT, DepthValue},
                                            {"shadow.key", Imf::HALF, KeyShadow},
                                            {"shadow.sun", Imf::HALF, SunShadow}}));
  const ExrPart fill = Part("fill", {{"R", Imf::HALF, NoDepth}});
  const ExrPart same = Part("same", {{"R", Imf::HALF, NoDepth}});
  const ExrPart other = Part("other", {{"R", Imf::HALF, NoDepth}}, 2.0);
  const auto file = Read({depth, fill, same});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->origin.camera_part, "fill");
  ExpectRefused({depth, fill, other}, {}, {"worldToCamera", "part \"fill\"", "part \"other\""});
}

TEST_F(ExrChannels, AFinerImageIsOfTheSameView) {
  const auto coarse = Read(StereoParts(), OptionsOfView("left"));
  ASSERT_TRUE(coarse.ok()) << coarse.status();
  std::vector<ExrPart> parts = StereoParts();
  for (ExrPart& part : parts) {
    part.width = part.data_width = 16;
    part.height = part.data_height = 12;
  }
  testing::WriteExr(folder_.File("fine.exr"), parts);
  const auto fine =
      ReadFineCoverExr(folder_.File("fine.exr"), kLights, OptionsOfView("left"), *coarse);
  ASSERT_TRUE(fine.ok()) << fine.status();
  EXPECT_EQ(fine->columns, 16);
  EXPECT_EQ(fine->depth[17], static_cast<float>(DepthValue(1, 1)));
  const auto other =
      ReadFineCoverExr(folder_.File("fine.exr"), kLights, OptionsOfView("right"), *coarse);
  EXPECT_TRUE(HasAll(other.status().message(), {"another view"}));
}

TEST_F(ExrChannels, RefusesMoreViewsThanAnyFileHas) {
  ExrPart part = Part("all", {{"Z", Imf::FLOAT, DepthValue}});
  for (int i = 0; i < 17; ++i) part.multi_view.push_back("v" + std::to_string(i));
  ExpectRefused({part}, {}, {"17 views", "16"});
}

}  // namespace
}  // namespace lightfit
