// The frame number in an OpenEXR header.

#include "io/frames/exr_frame.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>

#include "tests/testing/process.h"

namespace lightfit {
namespace {

template <typename Attribute, typename Value>
std::optional<FrameNumber> FrameOf(const char* name, const Value& value) {
  const TemporaryFolder folder;
  Imf::Header header(1, 1);
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  header.insert(name, Attribute(value));
  float pixel = 1.0F;
  Imf::FrameBuffer pixels;
  pixels.insert("Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&pixel), 4, 4));
  {
    Imf::OutputFile file(folder.Path("a.exr").c_str(), header);
    file.setFrameBuffer(pixels);
    file.writePixels(1);
  }
  return FrameOfExr(folder.Path("a.exr"));
}

TEST(ExrFrame, IsInTheHeader) {
  EXPECT_EQ(FrameOf<Imf::IntAttribute>("frame", 1001), FrameNumber::Whole(1001));
  EXPECT_EQ(FrameOf<Imf::StringAttribute>("Frame", std::string("0042")), FrameNumber::Whole(42));
  EXPECT_EQ(FrameOf<Imf::FloatAttribute>("exr/frameNumber", 1001.25F)->Text(), "1001.25");
  EXPECT_EQ(FrameOf<Imf::IntAttribute>("imageCounter", -2), FrameNumber::Whole(-2));
  EXPECT_FALSE(FrameOf<Imf::IntAttribute>("frames", 1001).has_value());
  EXPECT_FALSE(FrameOf<Imf::StringAttribute>("frame", std::string("first")).has_value());
  EXPECT_FALSE(FrameOfExr("/no/file.exr").has_value());
}

}  // namespace
}  // namespace lightfit
