#include "io/readback_exr.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/affine_depth.h"
#include "io/lights_file.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::Channel;
using ::testing::ElementsAre;
using testing::ExrPart;
using testing::HasAll;
using testing::TemporaryFolder;

const std::vector<Light> kLights = {Light::Directional("sun", Eigen::Vector3d(0.0, 0.0, -1.0), 0),
                                    Light::Point("key", Eigen::Vector3d(1.0, 2.0, 3.0), 1)};

double DepthValue(int x, int y) { return 2.0 + x + 0.125 * y; }
double SunShadow(int x, int) { return x % 2; }
double KeyShadow(int, int y) { return y % 3 == 0 ? 1.0 : 0.0; }

ExrPart StandardPart() {
  ExrPart part;
  const testing::StandardMatrices matrices = testing::Standard(part.width, part.height);
  part.matrices = {{"worldToCamera", matrices.world_to_camera},
                   {"worldToNDC", matrices.world_to_ndc}};
  part.channels = {{"Z", Imf::FLOAT, DepthValue},
                   {"shadow.key", Imf::HALF, KeyShadow},
                   {"shadow.sun", Imf::HALF, SunShadow}};
  return part;
}

uint32_t ExpectedBits(int x, int y) {
  return (SunShadow(x, y) > 0.5 ? 1U : 0U) | (KeyShadow(x, y) > 0.5 ? 2U : 0U);
}

TEST(ReadReadbackExr, ReadsDepthShadowsAndCamera) {
  const TemporaryFolder folder;
  testing::WriteExr(folder.File("a.exr"), {StandardPart()});
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->light_status, ElementsAre(absl::OkStatus(), absl::OkStatus()));
  EXPECT_LE(testing::LargestScreenDifference(testing::StandardCamera(8, 6), file->camera), 1e-6);
  const Readback view = file->View();
  ASSERT_EQ(view.width(), 8);
  ASSERT_EQ(view.height(), 6);
  ASSERT_EQ(view.depth.size(), 48);
  ASSERT_EQ(view.shadow_bits.size(), 48);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      EXPECT_EQ(view.depth[8 * y + x], static_cast<float>(DepthValue(x, y)));
      EXPECT_EQ(view.shadow_bits[8 * y + x], ExpectedBits(x, y));
    }
  }
}

TEST(ReadReadbackExr, ReadsTheExamplesWithTheirOwnLights) {
  for (const std::string set : {"yard_180", "room_180"}) {
    const std::string folder = testing::RepositoryFile("examples/" + set);
    const auto lights = ReadLightsFile(folder + "/scene.json");
    ASSERT_TRUE(lights.ok()) << lights.status();
    const auto file = ReadReadbackExr(folder + "/0001.exr", *lights);
    ASSERT_TRUE(file.ok()) << file.status();
    ASSERT_EQ(file->depth.size(), 180 * 180);
    const AffineDepth affine(file->camera, file->depth_kind);
    int surfaces = 0;
    for (const float depth : file->depth) {
      EXPECT_FALSE(affine.IsInvalid(depth)) << depth;
      surfaces += affine.IsSurface(depth) ? 1 : 0;
    }
    EXPECT_GT(surfaces, 180 * 180 / 4);
    for (const Light& light : *lights) {
      EXPECT_TRUE(file->light_status[light.shadow_bit].ok());
      int shadowed = 0;
      for (const uint32_t bits : file->shadow_bits) shadowed += bits >> light.shadow_bit & 1;
      EXPECT_GT(shadowed, 100) << set << " " << light.name;
      EXPECT_LT(shadowed, 180 * 180 * 3 / 4) << set << " " << light.name;
    }
  }
}

TEST(ReadReadbackExr, LightsFillTheirOwnBit) {
  const TemporaryFolder folder;
  testing::WriteExr(folder.File("a.exr"), {StandardPart()});
  const std::vector<Light> key = {Light::Point("key", Eigen::Vector3d::UnitX(), 31)};
  const auto file = ReadReadbackExr(folder.File("a.exr"), key);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->shadow_bits[0], 1U << 31);
  EXPECT_EQ(file->shadow_bits[8], 0U);
}

TEST(ReadReadbackExr, RefusesTwoLightsOnOneBit) {
  const std::vector<Light> lights = {Light::Point("a", Eigen::Vector3d::UnitX(), 3),
                                     Light::Point("b", Eigen::Vector3d::UnitX(), 3)};
  const auto file = ReadReadbackExr("unread.exr", lights);
  EXPECT_TRUE(HasAll(file.status().message(), {"light \"b\"", "shadow_bit = 3"}));
}

TEST(ReadReadbackExr, AMissingShadowChannelFailsThatLightOnly) {
  const TemporaryFolder folder;
  testing::WriteExr(folder.File("a.exr"), {StandardPart()});
  std::vector<Light> lights = kLights;
  lights.insert(lights.begin(), Light::Point("rim", Eigen::Vector3d::UnitX(), 2));
  const auto file = ReadReadbackExr(folder.File("a.exr"), lights);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->light_status[0].code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(HasAll(file->light_status[0].message(),
                     {"light \"rim\"", "no channel \"shadow.rim\"", "\"key\", \"sun\"", "\"Z\""}));
  EXPECT_TRUE(file->light_status[1].ok());
  EXPECT_TRUE(file->light_status[2].ok());
  EXPECT_EQ(file->shadow_bits[1], ExpectedBits(1, 0));
}

TEST(ReadReadbackExr, ShadowChannelsFollowTheFormatOrTheirOwnName) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  part.channels = {{"Z", Imf::FLOAT, DepthValue},
                   {"key_visibility.S", Imf::FLOAT, KeyShadow},
                   {"sol", Imf::FLOAT, SunShadow}};
  testing::WriteExr(folder.File("a.exr"), {part});
  ReadbackExrOptions options;
  options.shadow_channel_format = "{light}_visibility.S";
  options.shadow_channels["sun"] = "sol";
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights, options);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->light_status, ElementsAre(absl::OkStatus(), absl::OkStatus()));
  EXPECT_EQ(file->shadow_bits[1], ExpectedBits(1, 0));
  const auto names = ListShadowLights(folder.File("a.exr"), options);
  ASSERT_TRUE(names.ok()) << names.status();
  EXPECT_THAT(*names, ElementsAre("key"));
}

TEST(ReadReadbackExr, RefusesAFormatWithoutTheLight) {
  for (const std::string format : {"shadow", "", "{light}{light}"}) {
    ReadbackExrOptions options;
    options.shadow_channel_format = format;
    const auto file = ReadReadbackExr("unread.exr", kLights, options);
    EXPECT_TRUE(HasAll(file.status().message(), {"shadow_channel_format", "{light}"}));
  }
}

TEST(ReadReadbackExr, HalfAndFullShadowsAboveHalfCount) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  // 0.5 itself is lit; NaN is lit; infinity is shadowed; whole numbers count from 1.
  const double values[] = {0.0, 0.5, 0.501, 1.0, std::nan(""), INFINITY, -1.0, 7.0};
  part.channels[2].value = [&values](int x, int) { return values[x]; };
  part.channels.push_back({"shadow.uint", Imf::UINT, [](int x, int) { return x; }});
  testing::WriteExr(folder.File("a.exr"), {part});
  const std::vector<Light> lights = {Light::Point("sun", Eigen::Vector3d::UnitX(), 0),
                                     Light::Point("uint", Eigen::Vector3d::UnitX(), 1)};
  const auto file = ReadReadbackExr(folder.File("a.exr"), lights);
  ASSERT_TRUE(file.ok()) << file.status();
  const std::vector<uint32_t> row(file->shadow_bits.begin(), file->shadow_bits.begin() + 8);
  EXPECT_THAT(row, ElementsAre(0, 2, 3, 3, 2, 3, 2, 3));
}

TEST(ReadReadbackExr, ReadsABitMaskExactly) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  const uint32_t masks[] = {0, 1, 0xFFFFFFFFU, 0x80000001U, 16777217U, 0x7FFFFFFFU, 3, 0xDEADBEEFU};
  part.channels = {{"Z", Imf::FLOAT, DepthValue},
                   {"beauty.R", Imf::HALF, KeyShadow},
                   {"shadowBits", Imf::UINT, [&](int x, int) { return masks[x]; }}};
  testing::WriteExr(folder.File("a.exr"), {part});
  ReadbackExrOptions options;
  options.shadow_bits_channel = "shadowBits";
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights, options);
  ASSERT_TRUE(file.ok()) << file.status();
  for (int i = 0; i < 48; ++i) EXPECT_EQ(file->shadow_bits[i], masks[i % 8]);

  options.shadow_bits_channel = "beauty.R";
  EXPECT_TRUE(HasAll(ReadReadbackExr(folder.File("a.exr"), kLights, options).status().message(),
                     {"beauty.R", "UINT"}));
  options.shadow_bits_channel = "bits";
  EXPECT_TRUE(HasAll(ReadReadbackExr(folder.File("a.exr"), kLights, options).status().message(),
                     {"shadow_bits_channel \"bits\"", "\"shadowBits\""}));
}

TEST(ReadReadbackExr, EveryDepthKindHasItsBackgroundOutsideTheDataWindow) {
  const TemporaryFolder folder;
  for (const DepthKind kind : {DepthKind::kCameraZ,
                               DepthKind::kDistance,
                               DepthKind::kNdcZeroToOne,
                               DepthKind::kNdcMinusOneToOne,
                               DepthKind::kNdcReversedZeroToOne}) {
    ExrPart part = StandardPart();
    part.data_x = 2;
    part.data_y = 1;
    part.data_width = 3;
    part.data_height = 4;
    part.channels[0].value = [](int, int) { return 0.5; };
    testing::WriteExr(folder.File("a.exr"), {part});
    ReadbackExrOptions options;
    options.depth_kind = kind;
    options.camera_exr.near = 0.1;
    options.camera_exr.far = 100.0;
    const auto file = ReadReadbackExr(folder.File("a.exr"), kLights, options);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->depth_kind, kind);
    ASSERT_EQ(file->depth.size(), 48);
    const AffineDepth affine(file->camera, kind);
    for (int i = 0; i < 48; ++i) {
      const int x = i % 8, y = i / 8;
      const bool inside = x >= 2 && x < 5 && y >= 1 && y < 5;
      EXPECT_EQ(affine.IsSurface(file->depth[i]), inside) << DepthKindName(kind) << " " << i;
      EXPECT_FALSE(affine.IsInvalid(file->depth[i])) << DepthKindName(kind) << " " << i;
      EXPECT_EQ(file->shadow_bits[i], inside ? ExpectedBits(x, y) : 0U);
    }
  }
}

TEST(ReadReadbackExr, NdcDepthWantsTheClipPlanes) {
  const TemporaryFolder folder;
  testing::WriteExr(folder.File("a.exr"), {StandardPart()});
  ReadbackExrOptions options;
  options.depth_kind = DepthKind::kNdcZeroToOne;
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights, options);
  ASSERT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(HasAll(file.status().message(), {"a.exr", "near", "far"}));
}

TEST(ReadReadbackExr, ADataWindowBeyondTheDisplayIsCropped) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  part.data_x = -3;
  part.data_y = -2;
  part.data_width = 14;
  part.data_height = 11;
  part.channels[1].value = [](int, int) { return 0.0; };
  part.channels[2].value = [](int x, int) { return x == 7 ? 1.0 : 0.0; };
  testing::WriteExr(folder.File("a.exr"), {part});
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights);
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->camera.width, 8);
  ASSERT_EQ(file->depth.size(), 48);
  for (int i = 0; i < 48; ++i) {
    EXPECT_EQ(file->depth[i], static_cast<float>(DepthValue(i % 8, i / 8)));
    EXPECT_EQ(file->shadow_bits[i], i % 8 == 7 ? 1U : 0U);
  }
}

TEST(ReadReadbackExr, ADataWindowApartFromTheDisplayIsAllBackground) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  part.data_x = 20;
  part.data_y = -30;
  part.channels[2].value = [](int, int) { return 1.0; };
  testing::WriteExr(folder.File("a.exr"), {part});
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights);
  ASSERT_TRUE(file.ok()) << file.status();
  for (int i = 0; i < 48; ++i) {
    EXPECT_GE(file->depth[i], kBackgroundDepth);
    EXPECT_EQ(file->shadow_bits[i], 0U);
  }
}

TEST(ReadReadbackExr, FindsBlenderDepthAndRefusesToChooseAmongSeveral) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  part.channels[0].name = "ViewLayer.Depth.Z";
  testing::WriteExr(folder.File("a.exr"), {part});
  EXPECT_TRUE(ReadReadbackExr(folder.File("a.exr"), kLights).ok());

  part.channels.push_back({"Other.Depth.Z", Imf::FLOAT, SunShadow});
  testing::WriteExr(folder.File("a.exr"), {part});
  const auto refused = ReadReadbackExr(folder.File("a.exr"), kLights);
  ASSERT_EQ(refused.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(HasAll(refused.status().message(),
                     {"\"ViewLayer.Depth.Z\"", "\"Other.Depth.Z\"", "depth_channel"}));

  ReadbackExrOptions options;
  options.depth_channel = "ViewLayer.Depth.Z";
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights, options);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->depth[1], 3.0F);
  options.depth_channel = "Depth";
  EXPECT_TRUE(HasAll(ReadReadbackExr(folder.File("a.exr"), kLights, options).status().message(),
                     {"depth_channel \"Depth\"", "\"ViewLayer.Depth.Z\""}));
}

TEST(ReadReadbackExr, SaysWhichChannelsThereAreWhenNoneIsDepth) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  part.channels[0].name = "distant";
  testing::WriteExr(folder.File("a.exr"), {part});
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights);
  ASSERT_EQ(file.status().code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(HasAll(file.status().message(), {"\"Z\"", "\"distant\"", "depth_channel"}));
}

TEST(ReadReadbackExr, RefusesWholeNumbersAsDepth) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  part.channels[0].type = Imf::UINT;
  testing::WriteExr(folder.File("a.exr"), {part});
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights);
  EXPECT_TRUE(HasAll(file.status().message(), {"\"Z\"", "UINT", "want half or float"}));
}

TEST(ReadReadbackExr, MultiPartFilesUseTheFirstPartWithDepth) {
  const TemporaryFolder folder;
  ExrPart beauty = StandardPart();
  beauty.name = "beauty";
  beauty.channels = {{"R", Imf::HALF, SunShadow}, {"shadow.key", Imf::HALF, KeyShadow}};
  ExrPart depth = StandardPart();
  depth.name = "depth";
  depth.matrices.clear();  // only the first part has the camera
  depth.channels = {{"Z", Imf::FLOAT, DepthValue}, {"shadow.sun", Imf::HALF, SunShadow}};
  testing::WriteExr(folder.File("a.exr"), {beauty, depth});
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->light_status, ElementsAre(absl::OkStatus(), absl::OkStatus()));
  for (int i = 0; i < 48; ++i) {
    EXPECT_EQ(file->depth[i], static_cast<float>(DepthValue(i % 8, i / 8)));
    EXPECT_EQ(file->shadow_bits[i], ExpectedBits(i % 8, i / 8));
  }
  const auto names = ListShadowLights(folder.File("a.exr"));
  ASSERT_TRUE(names.ok()) << names.status();
  EXPECT_THAT(*names, ElementsAre("key", "sun"));
}

TEST(ReadReadbackExr, AGivenCameraReplacesTheAttributes) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  part.matrices.clear();
  testing::WriteExr(folder.File("a.exr"), {part});
  EXPECT_EQ(ReadReadbackExr(folder.File("a.exr"), kLights).status().code(),
            absl::StatusCode::kNotFound);
  ReadbackExrOptions options;
  options.camera = testing::StandardCamera(8, 6, 2.5);
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights, options);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->camera.screen_from_camera, options.camera->screen_from_camera);

  options.camera = testing::StandardCamera(80, 60);
  EXPECT_TRUE(HasAll(ReadReadbackExr(folder.File("a.exr"), kLights, options).status().message(),
                     {"80x60", "8x6"}));
}

TEST(ReadReadbackExr, RefusesMorePixelsThanTheLimit) {
  const TemporaryFolder folder;
  testing::WriteExr(folder.File("a.exr"), {StandardPart()});
  ReadbackExrOptions options;
  options.max_pixels = 47;
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights, options);
  ASSERT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(HasAll(file.status().message(), {"8x6", "47 pixels", "max_pixels"}));
  options.max_pixels = 48;
  EXPECT_TRUE(ReadReadbackExr(folder.File("a.exr"), kLights, options).ok());
}

TEST(ListShadowLights, NamesTheLightsOfTheExamples) {
  const auto names = ListShadowLights(testing::RepositoryFile("examples/yard_180/0001.exr"));
  ASSERT_TRUE(names.ok()) << names.status();
  EXPECT_THAT(*names, ElementsAre("key", "rim", "sun"));
}

}  // namespace
}  // namespace lightfit
