// The optional channels of a read-back: which surfaces face a light, and what the map says.

#include <OpenEXR/ImfOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using ::testing::ElementsAre;
using testing::ExrPart;
using testing::HasAll;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

const std::vector<Light> kLights = {Light::Directional("sun", Eigen::Vector3d(0.0, 0.0, -1.0), 0),
                                    Light::Point("key", Eigen::Vector3d(1.0, 2.0, 3.0), 5)};

double Depth(int, int) { return 2.0; }
double Shadow(int x, int) { return x % 2; }
double Facing(int, int y) { return y % 2; }
double Mapped(int x, int y) { return (x + y) % 3 == 0 ? 1.0 : 0.0; }

ExrPart StandardPart() {
  ExrPart part;
  const testing::StandardMatrices matrices = testing::Standard(part.width, part.height);
  part.matrices = {{"worldToCamera", matrices.world_to_camera},
                   {"worldToNDC", matrices.world_to_ndc}};
  part.channels = {{"Z", Imf::FLOAT, Depth},
                   {"shadow.key", Imf::HALF, Shadow},
                   {"shadow.sun", Imf::HALF, Shadow}};
  return part;
}

absl::StatusOr<ReadbackFile> Read(const std::vector<ExrPart>& parts,
                                  const ReadbackExrOptions& options = {}) {
  const TemporaryFolder folder;
  testing::WriteExr(folder.File("a.exr"), parts);
  return ReadReadbackExr(folder.File("a.exr"), kLights, options);
}

TEST(FacingChannels, AreNotNeeded) {
  const auto file = Read({StandardPart()});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->light_status, ElementsAre(absl::OkStatus(), absl::OkStatus()));
  EXPECT_THAT(file->facing_bits, IsEmpty());
  EXPECT_THAT(file->mapped_bits, IsEmpty());
  EXPECT_FALSE(file->View().KnowsFacing(0));
  EXPECT_FALSE(file->View().KnowsMapped(0));
  EXPECT_EQ(ValidateReadback(file->View()), absl::OkStatus());
}

TEST(FacingChannels, AreReadForTheLightsThatHaveThem) {
  ExrPart part = StandardPart();
  part.channels.push_back({"facing.key", Imf::HALF, Facing});
  part.channels.push_back({"mapped.key", Imf::FLOAT, Mapped});
  part.channels.push_back({"mapped.sun", Imf::UINT, Mapped});
  const auto file = Read({part});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->light_status, ElementsAre(absl::OkStatus(), absl::OkStatus()));
  const Readback view = file->View();
  ASSERT_EQ(ValidateReadback(view), absl::OkStatus());
  EXPECT_FALSE(view.KnowsFacing(0));
  EXPECT_TRUE(view.KnowsFacing(5));
  EXPECT_TRUE(view.KnowsMapped(0));
  EXPECT_TRUE(view.KnowsMapped(5));
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      const size_t pixel = view.Index(x, y);
      EXPECT_EQ(view.shadow_bits[pixel], Shadow(x, y) != 0.0 ? 1U | 1U << 5 : 0U);
      EXPECT_EQ(view.facing_bits[pixel], Facing(x, y) != 0.0 ? 1U << 5 : 0U);
      EXPECT_EQ(view.mapped_bits[pixel], Mapped(x, y) != 0.0 ? 1U | 1U << 5 : 0U);
    }
  }
}

TEST(FacingChannels, CountAboveHalf) {
  ExrPart part = StandardPart();
  const double values[] = {0.0, 0.5, 0.501, 1.0, std::nan(""), INFINITY, -1.0, 7.0};
  part.channels.push_back({"facing.sun", Imf::HALF, [&values](int x, int) { return values[x]; }});
  const auto file = Read({part});
  ASSERT_TRUE(file.ok()) << file.status();
  const std::vector<uint32_t> row(file->facing_bits.begin(), file->facing_bits.begin() + 8);
  EXPECT_THAT(row, ElementsAre(0, 0, 1, 1, 0, 1, 0, 1));
}

TEST(FacingChannels, NothingFacesALightOutsideTheDataWindow) {
  ExrPart part = StandardPart();
  part.data_x = 2;
  part.data_width = 3;
  part.channels.push_back({"facing.sun", Imf::HALF, [](int, int) { return 1.0; }});
  const auto file = Read({part});
  ASSERT_TRUE(file.ok()) << file.status();
  for (int i = 0; i < 48; ++i) {
    EXPECT_EQ(file->facing_bits[i], i % 8 >= 2 && i % 8 < 5 ? 1U : 0U);
  }
}

TEST(FacingChannels, FollowTheirFormats) {
  ExrPart part = StandardPart();
  part.channels.push_back({"sun_lambert.S", Imf::HALF, Facing});
  part.channels.push_back({"map/sun", Imf::HALF, Mapped});
  ReadbackExrOptions options;
  options.facing_channel_format = "{light}_lambert.S";
  options.mapped_channel_format = "map/{light}";
  const auto file = Read({part}, options);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->facing_lights, 1U);
  EXPECT_EQ(file->mapped_lights, 1U);

  options.facing_channel_format = "lambert";
  EXPECT_TRUE(HasAll(Read({part}, options).status().message(),
                     {"facing_channel_format = \"lambert\"", "\"facing.{light}\""}));
  options.facing_channel_format = "{light}";
  options.mapped_channel_format = "";
  EXPECT_TRUE(HasAll(Read({part}, options).status().message(),
                     {"mapped_channel_format = \"\"", "\"mapped.{light}\""}));
}

TEST(FacingChannels, GoWithAMaskOfShadows) {
  ExrPart part = StandardPart();
  part.channels.push_back({"facing.key", Imf::HALF, Facing});
  part.channels.push_back({"shadowBits", Imf::UINT, [](int x, int) { return x; }});
  ReadbackExrOptions options;
  options.shadow_bits_channel = "shadowBits";
  const auto file = Read({part}, options);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->shadow_bits[7], 7U);
  EXPECT_EQ(file->facing_lights, 1U << 5);
  EXPECT_EQ(file->facing_bits[8], 1U << 5);
}

// Of the fewer pixels that a subsampled channel has, as of any that is of another size.
TEST(FacingChannels, OnesThatCannotBeReadFailTheirLightAlone) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  part.channels.push_back({"facing.sun", Imf::HALF, Facing});
  Imf::Header header = testing::HeaderOf(part);
  header.channels().insert("facing.key", Imf::Channel(Imf::HALF, 2, 2));
  header.channels().insert("mapped.key", Imf::Channel(Imf::HALF, 2, 2));
  std::vector<std::vector<char>> pixels;
  Imf::FrameBuffer slices;
  for (const testing::Channel& channel : part.channels) {
    pixels.push_back(testing::NativePixels(part, channel));
    slices.insert(channel.name,
                  Imf::Slice::Make(channel.type, pixels.back().data(), header.dataWindow()));
  }
  {
    Imf::OutputFile file(folder.File("a.exr").c_str(), header);
    file.setFrameBuffer(slices);
    file.writePixels(part.data_height);
  }
  auto file = ReadReadbackExr(folder.File("a.exr"), kLights);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->light_status[0], absl::OkStatus());
  EXPECT_EQ(file->light_status[1].code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(HasAll(file->light_status[1].message(),
                     {"light \"key\"", "a.exr", "\"facing.key\"", "2x2", "subsampling"}));
  EXPECT_EQ(file->facing_lights, 1U);

  // Without any that could be read there are none.
  ReadbackExrOptions options;
  options.facing_channel_format = "absent.{light}";
  file = ReadReadbackExr(folder.File("a.exr"), kLights, options);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(HasAll(file->light_status[1].message(), {"light \"key\"", "\"mapped.key\""}));
  EXPECT_EQ(file->mapped_lights, 0U);
  EXPECT_THAT(file->mapped_bits, IsEmpty());
}

TEST(FacingChannels, NameNoLightsOfTheirOwn) {
  const TemporaryFolder folder;
  ExrPart part = StandardPart();
  part.channels.push_back({"facing.rim", Imf::HALF, Facing});
  testing::WriteExr(folder.File("a.exr"), {part});
  const auto names = ListShadowLights(folder.File("a.exr"));
  ASSERT_TRUE(names.ok()) << names.status();
  EXPECT_THAT(*names, ElementsAre("key", "sun"));
}

// A renderer's own, where shadow implies facing.
TEST(FacingChannels, OfARendererFitItsShadows) {
  for (const std::string set : {"yard_180_facing", "room_180_facing", "hall_180"}) {
    const std::string folder = testing::RepositoryFile("../shared/readbacks/" + set);
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no read-backs at " << folder;
    const auto lights = ReadLightsFile(folder + "/scene.json");
    ASSERT_TRUE(lights.ok()) << lights.status();
    const auto file = ReadReadbackExr(folder + "/0001.exr", *lights);
    ASSERT_TRUE(file.ok()) << file.status();
    for (const Light& light : *lights) {
      ASSERT_TRUE(file->View().KnowsFacing(light.shadow_bit)) << set << " " << light.name;
      int facing = 0, shadowed = 0, both = 0;
      for (size_t i = 0; i < file->depth.size(); ++i) {
        const bool is_facing = (file->facing_bits[i] >> light.shadow_bit & 1U) != 0;
        const bool is_shadowed = (file->shadow_bits[i] >> light.shadow_bit & 1U) != 0;
        facing += is_facing ? 1 : 0;
        shadowed += is_shadowed ? 1 : 0;
        both += is_facing && is_shadowed ? 1 : 0;
      }
      EXPECT_EQ(both, shadowed) << set << " " << light.name;
      EXPECT_GT(facing, shadowed) << set << " " << light.name;
    }
    EXPECT_THAT(file->mapped_bits, IsEmpty());
  }
}

}  // namespace
}  // namespace lightfit
