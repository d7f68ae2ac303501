// Read-backs in the other forms that OpenEXR files have: tiles, levels, every kind of compression,
// matrices in double precision; and the forms that no read-back can have.
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <cstring>

#include "io/readback_exr.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::ExrPart;
using testing::HasAll;
using testing::TemporaryFolder;

const std::vector<Light> kLights = {Light::Point("sun", Eigen::Vector3d::UnitX(), 0)};

// Half precision holds these depths, so that lossy compression keeps them too.
int Block(int pixel) { return pixel / 8; }
double DepthValue(int x, int y) { return 2.0 + 0.25 * Block(x) + 0.5 * Block(y); }
double SunShadow(int x, int y) { return (Block(x) + Block(y)) % 2; }

// 40 x 24 pixels of which 32 x 32 have data, beyond all but one edge of the display.
ExrPart Part() {
  ExrPart part;
  part.width = 40;
  part.height = 24;
  part.data_x = 0;
  part.data_y = -4;
  part.data_width = 32;
  part.data_height = 32;
  const testing::StandardMatrices matrices = testing::Standard(part.width, part.height);
  part.matrices = {{"worldToCamera", matrices.world_to_camera},
                   {"worldToNDC", matrices.world_to_ndc}};
  part.channels = {{"Z", Imf::FLOAT, DepthValue}, {"shadow.sun", Imf::FLOAT, SunShadow}};
  return part;
}

// Pixels of a part in memory for as long as a file is written.
struct Pixels {
  std::vector<std::vector<char>> channels;
  Imf::FrameBuffer slices;

  Pixels(const ExrPart& part, const Imf::Header& header) {
    for (const testing::Channel& channel : part.channels) {
      channels.push_back(testing::NativePixels(part, channel));
      slices.insert(channel.name,
                    Imf::Slice::Make(channel.type, channels.back().data(), header.dataWindow()));
    }
  }
};

void ExpectReadback(const absl::StatusOr<ReadbackFile>& file) {
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->light_status[0], absl::OkStatus());
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 40; ++x) {
      const float depth = file->depth[40 * y + x];
      EXPECT_EQ(depth, x < 32 ? static_cast<float>(DepthValue(x, y)) : 1e10F) << x << " " << y;
      const bool in_shadow = x < 32 && SunShadow(x, y) > 0.5;
      EXPECT_EQ(file->shadow_bits[40 * y + x], in_shadow ? 1U : 0U) << x << " " << y;
    }
  }
}

TEST(ExrForms, EveryCompressionIsRead) {
  const TemporaryFolder folder;
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    SCOPED_TRACE(compression);
    Imf::Header header = testing::HeaderOf(Part());
    header.compression() = static_cast<Imf::Compression>(compression);
    const Pixels pixels(Part(), header);
    {
      Imf::OutputFile file(folder.File("a.exr").c_str(), header);
      file.setFrameBuffer(pixels.slices);
      file.writePixels(32);
    }
    ExpectReadback(ReadReadbackExr(folder.File("a.exr"), kLights));
  }
}

TEST(ExrForms, TheFirstLevelOfTilesIsRead) {
  const TemporaryFolder folder;
  for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
    SCOPED_TRACE(mode);
    Imf::Header header = testing::HeaderOf(Part());
    header.setType(Imf::TILEDIMAGE);
    header.setTileDescription(Imf::TileDescription(16, 12, mode));  // 12 does not divide 32
    const Pixels pixels(Part(), header);
    {
      Imf::TiledOutputFile file(folder.File("a.exr").c_str(), header);
      file.setFrameBuffer(pixels.slices);
      for (int y = 0; y < file.numYLevels(); ++y) {
        for (int x = 0; x < file.numXLevels(); ++x) {
          if (!file.isValidLevel(x, y)) continue;
          file.writeTiles(0, file.numXTiles(x) - 1, 0, file.numYTiles(y) - 1, x, y);
        }
      }
    }
    ExpectReadback(ReadReadbackExr(folder.File("a.exr"), kLights));
  }
}

// OpenEXR takes memory for a whole tile, however small the image and the file are.
TEST(ExrForms, TilesFarLargerThanTheImageAreRefused) {
  const TemporaryFolder folder;
  Imf::Header header = testing::HeaderOf(Part());
  header.setType(Imf::TILEDIMAGE);
  header.setTileDescription(Imf::TileDescription(64, 64));
  const Pixels pixels(Part(), header);
  {
    Imf::TiledOutputFile file(folder.File("a.exr").c_str(), header);
    file.setFrameBuffer(pixels.slices);
    file.writeTile(0, 0);
  }
  ExpectReadback(ReadReadbackExr(folder.File("a.exr"), kLights));

  std::string bytes = testing::Bytes(folder.File("a.exr"));
  const std::string key = std::string("tiledesc") + '\0';
  const uint32_t height = 1 << 22;
  std::memcpy(&bytes[bytes.find(key) + key.size() + 8], &height, sizeof(height));
  const auto file = ReadReadbackExr(folder.Write("b.exr", bytes), kLights);
  EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(
      HasAll(file.status().message(), {"b.exr", "part 0", "64x4194304", "at most 1024x1024"}));
}

TEST(ExrForms, MatricesInDoublePrecisionAreRead) {
  const TemporaryFolder folder;
  ExrPart part = Part();
  const auto matrices = part.matrices;
  part.matrices.clear();
  Imf::Header header = testing::HeaderOf(part);
  for (const auto& [name, matrix] : matrices) {
    Imath::M44d rows;
    for (int i = 0; i < 16; ++i) rows[i / 4][i % 4] = matrix(i / 4, i % 4);
    header.insert(name, Imf::M44dAttribute(rows));
  }
  const Pixels pixels(part, header);
  {
    Imf::OutputFile file(folder.File("a.exr").c_str(), header);
    file.setFrameBuffer(pixels.slices);
    file.writePixels(32);
  }
  const auto camera = ReadCameraExr(folder.File("a.exr"));
  ASSERT_TRUE(camera.ok()) << camera.status();
  // 1e-7 would be single precision.
  EXPECT_LE(testing::LargestScreenDifference(testing::StandardCamera(40, 24), *camera), 1e-10);
}

// Colours often are, beside a depth for every pixel.
TEST(ExrForms, ASubsampledChannelIsRefusedAlone) {
  const TemporaryFolder folder;
  ExrPart part = Part();
  Imf::Header header = testing::HeaderOf(part);
  header.channels().insert("shadow.key", Imf::Channel(Imf::HALF, 2, 2));
  const Pixels pixels(part, header);  // none of "shadow.key", which is filled with 0
  {
    Imf::OutputFile file(folder.File("a.exr").c_str(), header);
    file.setFrameBuffer(pixels.slices);
    file.writePixels(32);
  }
  ExpectReadback(ReadReadbackExr(folder.File("a.exr"), kLights));

  const auto file =
      ReadReadbackExr(folder.File("a.exr"), {Light::Point("key", Eigen::Vector3d::UnitX(), 0)});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->light_status[0].code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(
      HasAll(file->light_status[0].message(), {"a.exr", "\"shadow.key\"", "2x2", "subsampling"}));

  ReadbackExrOptions options;
  options.depth_channel = "shadow.key";
  EXPECT_EQ(ReadReadbackExr(folder.File("a.exr"), kLights, options).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(ExrForms, DeepPartsAreRefused) {
  const TemporaryFolder folder;
  Imf::Header header = testing::HeaderOf(Part());
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  // Without pixels, which nobody gets to.
  { const Imf::DeepScanLineOutputFile without_pixels(folder.File("a.exr").c_str(), header); }
  const auto file = ReadReadbackExr(folder.File("a.exr"), kLights);
  EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(HasAll(file.status().message(), {"a.exr", "part 0 is deep", "flatten"}));
}

}  // namespace
}  // namespace lightfit
