#include "io/image_exr_write.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "tests/io/testing.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr int kWidth = 5, kHeight = 3;

std::vector<float> Ramp(float step) {
  std::vector<float> values;
  for (int i = 0; i < kWidth * kHeight; ++i) values.push_back(step * static_cast<float>(i));
  return values;
}

TEST(WriteImageExr, KeepsEveryValueAndSaysWhatChannelsHold) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.exr");
  std::vector<float> mask(kWidth * kHeight, 0.0F);
  mask[7] = 1.0F;
  const std::vector<ExrImage> images = {{"footprint.lamp.001", Ramp(0.1F)},
                                        {"wrong.lamp.001", Ramp(1e-30F)},
                                        {"lightfit.ideal", mask, true}};
  const Camera camera = testing::StandardCamera(kWidth, kHeight);
  ASSERT_TRUE(WriteImageExr(path, camera, images).ok());
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  EXPECT_EQ(window, file.header().displayWindow());
  for (const ExrImage& image : images) {
    const Imf::Channel* channel = file.header().channels().findChannel(image.channel);
    ASSERT_NE(channel, nullptr) << image.channel;
    EXPECT_EQ(channel->type, image.is_mask ? Imf::HALF : Imf::FLOAT);
    std::vector<float> values(image.values.size());
    Imf::FrameBuffer buffer;
    buffer.insert(image.channel, Imf::Slice::Make(Imf::FLOAT, values.data(), window));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    EXPECT_EQ(values, image.values) << image.channel;
  }
  EXPECT_NE(file.header().find("worldToCamera"), file.header().end());
  EXPECT_NE(file.header().find("worldToNDC"), file.header().end());
}

TEST(WriteImageExr, RefusesWhatCannotBeWrittenAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.exr");
  const Camera camera = testing::StandardCamera(kWidth, kHeight);
  Camera skewed = camera;
  skewed.screen_from_camera(0, 1) = 0.1;
  std::vector<float> not_finite = Ramp(1.0F);
  not_finite[3] = std::numeric_limits<float>::quiet_NaN();
  const struct {
    Camera camera;
    std::vector<ExrImage> images;
    const char* words;
  } cases[] = {
      {camera, {{"", Ramp(1.0F)}}, "want distinct names"},
      {camera, {{std::string(256, 'a'), Ramp(1.0F)}}, "want distinct names of 1 to 255 bytes"},
      {camera, {{"a", Ramp(1.0F)}, {"a", Ramp(1.0F)}}, "channel \"a\": want distinct names"},
      {camera, {{"a", {1.0F}}}, "channel \"a\": 1 pixels, want 5 x 3"},
      {camera, {{"a", not_finite}}, "channel \"a\": a value is not finite"},
      {skewed, {{"a", Ramp(1.0F)}}, "skew"},
  };
  for (const auto& bad : cases) {
    const absl::Status status = WriteImageExr(path, bad.camera, bad.images);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), HasSubstr(bad.words));
    EXPECT_THAT(std::string(status.message()), HasSubstr(path));
    EXPECT_FALSE(std::filesystem::exists(path));
  }
}

}  // namespace
}  // namespace lightfit
