// Broken EXR files: every one is an error or a usable read-back, never a crash or a huge
// allocation.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iostream>
#include <limits>

#include "io/readback_exr.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::HasAll;

const std::vector<Light> kLights = {Light::Point("sun", Eigen::Vector3d::UnitX(), 0),
                                    Light::Point("key", Eigen::Vector3d::UnitX(), 1)};

std::string ExampleBytes() {
  return testing::Bytes(testing::RepositoryFile("examples/yard_180/0001.exr"));
}

// A few hundred bytes of header and pixels, so that random damage hits both.
std::string SmallExrBytes(const testing::TemporaryFolder& folder, bool multi_part) {
  testing::ExrPart part;
  const testing::StandardMatrices matrices = testing::Standard(part.width, part.height);
  part.matrices = {{"worldToCamera", matrices.world_to_camera},
                   {"worldToNDC", matrices.world_to_ndc}};
  part.channels = {{"Z", Imf::FLOAT, [](int x, int y) { return 1.0 + x * y; }},
                   {"shadow.sun", Imf::HALF, [](int x, int) { return x % 2; }}};
  testing::ExrPart second = part;
  second.name = "second";
  second.channels = {{"shadow.key", Imf::UINT, [](int x, int) { return x % 2; }}};
  std::vector<testing::ExrPart> parts = {part};
  if (multi_part) parts.push_back(second);
  testing::WriteExr(folder.File("small.exr"), parts);
  return testing::Bytes(folder.File("small.exr"));
}

void ExpectUsable(const ReadbackFile& file) {
  const size_t pixels = static_cast<size_t>(file.camera.width) * file.camera.height;
  EXPECT_EQ(file.depth.size(), pixels);
  EXPECT_EQ(file.shadow_bits.size(), pixels);
  EXPECT_EQ(file.light_status.size(), kLights.size());
  EXPECT_TRUE(ValidateCamera(file.camera).ok());
}

TEST(MalformedExr, FilesThatAreNotExrSaySo) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(ReadReadbackExr(folder.File("none.exr"), kLights).status().code(),
            absl::StatusCode::kNotFound);
  EXPECT_TRUE(HasAll(ReadReadbackExr(folder.File(""), kLights).status().message(), {"folder"}));
  for (const std::string& text : {std::string(),
                                  std::string("P6 8 6 255\n"),
                                  std::string(100, '\0'),
                                  std::string("\x76\x2f\x31\x01"),
                                  std::string("\x76\x2f\x31\x01\x02\x00\x00\x00", 8)}) {
    const std::string path = folder.Write("text.exr", text);
    const auto file = ReadReadbackExr(path, kLights);
    EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_TRUE(HasAll(file.status().message(), {path}));
  }
}

TEST(MalformedExr, CutFilesAreErrorsAtEveryLength) {
  const testing::TemporaryFolder folder;
  for (const std::string& whole :
       {ExampleBytes(), SmallExrBytes(folder, false), SmallExrBytes(folder, true)}) {
    const size_t step = std::max<size_t>(1, whole.size() / 150);
    for (size_t length = 0; length < whole.size(); length += step) {
      const std::string path = folder.Write("cut.exr", whole.substr(0, length));
      const auto file = ReadReadbackExr(path, kLights);
      // Whatever the file cannot give is an error, of the file or of a light.
      if (file.ok()) ExpectUsable(*file);
      EXPECT_TRUE(!file.ok() || !file->light_status[0].ok() || !file->light_status[1].ok())
          << length << " of " << whole.size();
    }
  }
}

TEST(MalformedExr, DamagedFilesAreErrorsOrUsable) {
  const testing::TemporaryFolder folder;
  std::mt19937 random(testing::kSeed);
  std::cout << "seed " << testing::kSeed << "\n";
  int errors = 0, usable = 0;
  for (const std::string& whole :
       {ExampleBytes(), SmallExrBytes(folder, false), SmallExrBytes(folder, true)}) {
    for (int i = 0; i < 400; ++i) {
      std::string bytes = whole;
      // Half of the damage goes to the header, where it hurts most.
      const size_t range = i % 2 == 0 ? std::min<size_t>(bytes.size(), 800) : bytes.size();
      const int count = 1 + static_cast<int>(random() % 4);
      for (int j = 0; j < count; ++j)
        bytes[4 + random() % (range - 4)] = static_cast<char>(random());
      const auto file = ReadReadbackExr(folder.Write("damaged.exr", bytes), kLights);
      if (file.ok()) {
        ExpectUsable(*file);
        ++usable;
      } else {
        EXPECT_FALSE(file.status().message().empty());
        ++errors;
      }
    }
  }
  std::cout << errors << " errors, " << usable << " usable\n";
  EXPECT_GT(errors, 100);
}

// Overwrites the four numbers of a window attribute in the header.
std::string WithWindow(std::string bytes,
                       const std::string& attribute,
                       const std::array<int32_t, 4>& window) {
  const std::string key = attribute + '\0' + "box2i" + '\0';
  const size_t place = bytes.find(key);
  EXPECT_NE(place, std::string::npos);
  std::memcpy(&bytes[place + key.size() + 4], window.data(), sizeof(window));
  return bytes;
}

// OpenEXR itself demands one display window of all parts; were it to let this pass, we must not.
TEST(MalformedExr, PartsOfTwoSizesAreRefused) {
  const testing::TemporaryFolder folder;
  const std::string whole = SmallExrBytes(folder, true);
  const size_t first = whole.find("displayWindow");
  const size_t second = whole.find("displayWindow", first + 1);
  ASSERT_NE(second, std::string::npos);
  const std::string bytes =
      whole.substr(0, second) + WithWindow(whole.substr(second), "displayWindow", {0, 0, 99, 99});
  const auto file = ReadReadbackExr(folder.Write("two.exr", bytes), kLights);
  EXPECT_TRUE(!file.ok() || !file->light_status[1].ok());
}

int64_t PeakMemoryKilobytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

TEST(MalformedExr, HugeDimensionsAreRefusedBeforeMemoryIsTaken) {
  const testing::TemporaryFolder folder;
  const std::string whole = SmallExrBytes(folder, false);
  constexpr int32_t kMax = std::numeric_limits<int32_t>::max();
  constexpr int32_t kMin = std::numeric_limits<int32_t>::min();
  const std::array<int32_t, 4> windows[] = {{0, 0, 99999, 99999},
                                            {0, 0, 1 << 20, 1 << 20},
                                            {0, 0, (1 << 30) - 1, 5},
                                            {0, 0, 7, (1 << 30) - 1},
                                            {0, 0, kMax, kMax},
                                            {kMin, kMin, kMax, kMax},
                                            {0, 0, -1, -1},
                                            {5, 5, 2, 2},
                                            {kMax, kMax, kMax, kMax}};
  const int64_t before = PeakMemoryKilobytes();
  for (const auto& window : windows) {
    for (const bool data : {true, false}) {
      for (const bool display : {true, false}) {
        if (!data && !display) continue;
        std::string bytes = whole;
        if (data) bytes = WithWindow(bytes, "dataWindow", window);
        if (display) bytes = WithWindow(bytes, "displayWindow", window);
        const auto file = ReadReadbackExr(folder.Write("huge.exr", bytes), kLights);
        EXPECT_FALSE(file.ok()) << window[2] << "x" << window[3] << " " << data << display;
        EXPECT_FALSE(ListShadowLights(folder.File("huge.exr")).ok());
        // A header alone may be huge; it must still not crash or take memory.
        const auto camera = ReadCameraExr(folder.File("huge.exr"));
        EXPECT_TRUE(!camera.ok() || ValidateCamera(*camera).ok());
      }
    }
  }
  // 2^30 rows would need 8 GB for their table of offsets alone.
  EXPECT_LT(PeakMemoryKilobytes() - before, 200 * 1024);
}

// OpenEXR takes memory for an attribute before it reads it, so the length must be looked at first.
TEST(MalformedExr, AttributesLongerThanTheFileAreRefusedBeforeMemoryIsTaken) {
  const testing::TemporaryFolder folder;
  const int64_t before = PeakMemoryKilobytes();
  for (const bool multi_part : {false, true}) {
    const std::string whole = SmallExrBytes(folder, multi_part);
    const std::string key = std::string("worldToNDC") + '\0' + "m44f" + '\0';
    for (size_t place = whole.find(key); place != std::string::npos;
         place = whole.find(key, place + 1)) {
      for (const int32_t length : {std::numeric_limits<int32_t>::max(), 1 << 30, 1 << 20, -1}) {
        std::string bytes = whole;
        // A type that OpenEXR does not know may have any length.
        bytes[place + key.size() - 2] = 'x';
        std::memcpy(&bytes[place + key.size()], &length, sizeof(length));
        const auto file = ReadReadbackExr(folder.Write("long.exr", bytes), kLights);
        EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
        EXPECT_TRUE(HasAll(file.status().message(), {"long.exr", "worldToNDC", "damaged"}));
      }
    }
  }
  EXPECT_LT(PeakMemoryKilobytes() - before, 200 * 1024);
}

TEST(MalformedExr, ChannelsOfUnknownKindAreRefused) {
  const testing::TemporaryFolder folder;
  const std::string whole = SmallExrBytes(folder, true);
  for (const std::string key : {"shadow.sun", "shadow.key"}) {
    std::string bytes = whole;
    bytes[bytes.find(key) + key.size() + 1] = '\3';
    const auto file = ReadReadbackExr(folder.Write("kind.exr", bytes), kLights);
    EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_TRUE(HasAll(file.status().message(), {"kind.exr", key, "invalid"}));
  }
}

std::string Int32Bytes(int32_t number) {
  return {reinterpret_cast<const char*>(&number), sizeof(number)};
}

// OpenEXR takes half a kilobyte for a name of a few bytes.
TEST(MalformedExr, CountlessNamesAreRefusedBeforeMemoryIsTaken) {
  const testing::TemporaryFolder folder;
  constexpr int kNumNames = 1 << 20;
  std::string attributes, channels;
  for (int i = 0; i < kNumNames; ++i) {
    const std::string name = std::to_string(i) + '\0';
    attributes += name + "int" + '\0' + Int32Bytes(4) + Int32Bytes(i);
    channels += name + Int32Bytes(2) + Int32Bytes(0) + Int32Bytes(1) + Int32Bytes(1);
  }
  channels += '\0';
  const std::string list =
      std::string("channels") + '\0' + "chlist" + '\0' + Int32Bytes(channels.size()) + channels;
  const int64_t before = PeakMemoryKilobytes();
  for (const std::string& names : {attributes, list}) {
    const std::string bytes = "\x76\x2f\x31\x01" + Int32Bytes(2) + names + '\0';
    const auto file = ReadReadbackExr(folder.Write("names.exr", bytes), kLights);
    EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_TRUE(HasAll(file.status().message(), {"names.exr", "65536 attributes and channels"}));
  }
  EXPECT_LT(PeakMemoryKilobytes() - before, 200 * 1024);
}

TEST(MalformedExr, CountlessPartsAreRefused) {
  const testing::TemporaryFolder folder;
  std::string bytes = "\x76\x2f\x31\x01" + Int32Bytes(0x1002);
  for (int i = 0; i < 1025; ++i) {
    bytes += std::string("a") + '\0' + "int" + '\0' + Int32Bytes(4) + Int32Bytes(i) + '\0';
  }
  const auto file = ReadReadbackExr(folder.Write("parts.exr", bytes + '\0'), kLights);
  EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(HasAll(file.status().message(), {"parts.exr", "1024 parts"}));
}

// What is not UTF-8 could not be written into a result.
TEST(MalformedExr, NamesThatAreNotUtf8AreQuotedAsQuestionMarks) {
  const testing::TemporaryFolder folder;
  std::string bytes = SmallExrBytes(folder, false);
  const size_t place = bytes.find("shadow.sun");
  ASSERT_NE(place, std::string::npos);
  bytes[place + 7] = '\xff';
  const auto file = ReadReadbackExr(folder.Write("name.exr", bytes), kLights);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(HasAll(file->light_status[0].message(), {"\"shadow.?un\""}));
}

}  // namespace
}  // namespace lightfit
