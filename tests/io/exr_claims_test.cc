#include <OpenEXR/ImfCompression.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "io/exr/claims.h"
#include "io/readback_exr.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using internal::CheckExrClaims;
using internal::ExrClaims;
using internal::MostPixelBytes;
using testing::HasAll;

constexpr int kCompressions[] = {Imf::NO_COMPRESSION,
                                 Imf::RLE_COMPRESSION,
                                 Imf::ZIPS_COMPRESSION,
                                 Imf::ZIP_COMPRESSION,
                                 Imf::PIZ_COMPRESSION,
                                 Imf::PXR24_COMPRESSION,
                                 Imf::B44_COMPRESSION,
                                 Imf::B44A_COMPRESSION,
                                 Imf::DWAA_COMPRESSION,
                                 Imf::DWAB_COMPRESSION};

// The best that every compression can do: an image of one value, of many channels.
TEST(ExrClaims, ImagesOfOneValueAreWithinThemUnderEveryCompression) {
  const testing::TemporaryFolder folder;
  for (const int compression : kCompressions) {
    for (const auto& [width, height] : {std::pair(1, 1), {5, 700}, {1500, 400}}) {
      testing::ExrPart part;
      part.width = part.data_width = width;
      part.height = part.data_height = height;
      const auto one = [](int, int) { return 1.0; };
      for (const char* name : {"A", "B", "C", "Z"})
        part.channels.push_back({name, Imf::FLOAT, one});
      part.channels.push_back({"shadow.sun", Imf::HALF, one});
      testing::WriteExr(folder.File("a.exr"), {part}, static_cast<Imf::Compression>(compression));
      const auto bytes = static_cast<int64_t>(std::filesystem::file_size(folder.File("a.exr")));
      ReadbackExrOptions options;
      options.camera = *LookAtCamera({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 1.0, width, height);
      const auto file =
          ReadReadbackExr(folder.File("a.exr"), {Light::Directional("sun", {0, 0, -1})}, options);
      ASSERT_TRUE(file.ok()) << compression << " " << width << ": " << file.status();
      EXPECT_TRUE(file->light_status[0].ok()) << file->light_status[0];
      EXPECT_LE(int64_t{18} * width * height, MostPixelBytes(compression, bytes));
    }
  }
}

TEST(ExrClaims, TablesOfChunksMustLieInTheFile) {
  ExrClaims part;
  part.width = part.height = 1 << 12;
  part.bytes_per_pixel = 8;
  part.compression = Imf::NO_COMPRESSION;
  EXPECT_TRUE(CheckExrClaims(part, 8 << 12).ok());
  EXPECT_TRUE(
      HasAll(CheckExrClaims(part, (8 << 12) - 1).message(), {"4096 chunks", "32768 bytes"}));
  part.compression = Imf::ZIP_COMPRESSION;
  EXPECT_TRUE(CheckExrClaims(part, (8 << 12) / 16).ok());
  EXPECT_FALSE(CheckExrClaims(part, (8 << 12) / 16 - 1).ok());
  part.is_tiled = true;
  part.tile_width = part.tile_height = 1;
  EXPECT_TRUE(HasAll(CheckExrClaims(part, 1 << 20).message(), {"16777216 chunks"}));
  part.tile_width = part.tile_height = 64;
  EXPECT_TRUE(CheckExrClaims(part, 8 << 12).ok());
  part.chunk_count = 5000;
  EXPECT_TRUE(HasAll(CheckExrClaims(part, 8 << 12).message(), {"5000 chunks"}));
}

TEST(ExrClaims, ChunksAreBoundedByWhatTheFileCanHold) {
  ExrClaims part;  // one line of very many pixels
  part.width = 1 << 26;
  part.height = 1;
  part.bytes_per_pixel = 8;
  part.compression = Imf::DWAB_COMPRESSION;
  EXPECT_TRUE(HasAll(CheckExrClaims(part, 4000).message(), {"4000 bytes", "damaged"}));
  part.width = 4096;
  part.height = 2160;
  EXPECT_TRUE(CheckExrClaims(part, 4000).ok());
  // Products beyond 64 bits are large, not negative.
  part.width = part.height = int64_t{1} << 32;
  EXPECT_FALSE(CheckExrClaims(part, 4000).ok());
  part.is_tiled = true;
  part.tile_width = part.tile_height = (int64_t{1} << 32) - 1;
  EXPECT_FALSE(CheckExrClaims(part, 4000).ok());
}

// A header is all there is to many pixels.
TEST(ExrClaims, PixelsThatTheFileCannotHoldAreRefusedBeforeMemoryIsTaken) {
  const testing::TemporaryFolder folder;
  testing::ExrPart part;
  part.width = part.data_width = 4000;
  part.height = part.data_height = 1;
  part.channels = {{"Z", Imf::FLOAT, [](int, int) { return 1.0; }}};
  testing::WriteExr(folder.File("a.exr"), {part});
  std::string bytes = testing::Bytes(folder.File("a.exr"));
  for (const std::string name : {"dataWindow", "displayWindow"}) {
    const std::string key = name + '\0' + "box2i" + '\0';
    const int32_t x_max = 4000000 - 1;  // 16 MB from some hundred bytes
    std::memcpy(&bytes[bytes.find(key) + key.size() + 4 + 8], &x_max, sizeof(x_max));
  }
  ReadbackExrOptions options;
  options.camera = *LookAtCamera({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 1.0, 4000000, 1);
  const auto file = ReadReadbackExr(
      folder.Write("b.exr", bytes), {Light::Directional("sun", {0, 0, -1})}, options);
  EXPECT_TRUE(HasAll(file.status().message(), {"b.exr", "damaged"})) << file.status();
}

TEST(ExrClaims, TheSmallFileThatCostMuchIsRefusedAtOnce) {
  const std::string path = testing::RepositoryFile("../shared/cases/exr_small_but_slow/frame.exr");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no ../shared/cases";
  const auto file = ReadReadbackExr(path, {Light::Directional("sun", {0, 0, -1})});
  EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(HasAll(file.status().message(), {"part 0", "tiles of 16x4194320", "damaged"}));
}

}  // namespace
}  // namespace lightfit
