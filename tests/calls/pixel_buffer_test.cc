#include "calls/pixel_buffer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "tests/calls/floor_readback.h"
#include "tests/calls/requests.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using testing::ExpectPixels;
using testing::Floor;
using ::testing::HasSubstr;
using testing::HeaderOf;
using testing::kNumLights;
using testing::WithPlanes;

v1::Readback WithHalves(v1::Readback proto, const std::vector<float>& depth) {
  proto.set_depth_format(v1::DEPTH_FORMAT_FLOAT16);
  std::string* bytes = proto.mutable_depth();
  bytes->clear();
  for (const float value : depth) {
    const Eigen::half half(value);
    bytes->append(reinterpret_cast<const char*>(&half.x), 2);
  }
  return proto;
}

TEST(ReadbackView, RefersToPixelsThatCanBeUsedAsTheyAre) {
  const testing::PlaneReadback floor = Floor();
  const v1::Readback proto = testing::ReadbackMessage(floor.View());
  const auto view = ReadbackView::Of(proto, kNumLights, CallLimits());
  ASSERT_THAT(view, testing::IsOk());
  ExpectPixels(view->view(), floor.View());
  EXPECT_EQ(static_cast<const void*>(view->view().depth.data()), proto.depth().data());
  EXPECT_EQ(static_cast<const void*>(view->view().shadow_bits.data()), proto.shadow_bits().data());
}

TEST(ReadbackView, TakesPlanes) {
  const testing::PlaneReadback floor = Floor();
  const v1::Readback proto = WithPlanes(testing::ReadbackMessage(floor.View()), floor.shadow_bits);
  const auto view = ReadbackView::Of(proto, kNumLights, CallLimits());
  ASSERT_THAT(view, testing::IsOk());
  ExpectPixels(view->view(), floor.View());
}

TEST(ReadbackView, APlanesValuesFrom128OnAreShadow) {
  testing::PlaneReadback floor = Floor();
  v1::Readback proto = WithPlanes(testing::ReadbackMessage(floor.View()), floor.shadow_bits);
  *proto.mutable_shadow_planes(0) = std::string(floor.depth.size(), '\x7f');
  *proto.mutable_shadow_planes(1) = std::string(floor.depth.size(), '\x80');
  const auto view = ReadbackView::Of(proto, kNumLights, CallLimits());
  ASSERT_THAT(view, testing::IsOk());
  EXPECT_THAT(view->view().shadow_bits, ::testing::Each(2u));
}

// Every half there is, NaN included.
TEST(ReadbackView, TakesEveryHalf) {
  Camera camera = testing::FloorCamera(256, 256);
  const std::vector<uint32_t> bits(65536, 0);
  std::vector<float> depth(65536, 1.0f);
  v1::Readback proto = testing::ReadbackMessage({camera, depth, DepthKind::kCameraZ, bits});
  proto.set_depth_format(v1::DEPTH_FORMAT_FLOAT16);
  std::string* bytes = proto.mutable_depth();
  bytes->clear();
  for (int word = 0; word < 65536; ++word) {
    bytes->push_back(static_cast<char>(word & 255));
    bytes->push_back(static_cast<char>(word >> 8));
  }
  const auto view = ReadbackView::Of(proto, kNumLights, CallLimits());
  ASSERT_THAT(view, testing::IsOk());
  for (int word = 0; word < 65536; ++word) {
    // The definition of IEEE 754: sign, 5 bits of exponent, 10 of fraction.
    const int exponent = word >> 10 & 31, fraction = word & 1023;
    double want = exponent == 0    ? std::ldexp(fraction, -24)
                  : exponent == 31 ? (fraction == 0 ? INFINITY : NAN)
                                   : std::ldexp(1024 + fraction, exponent - 25);
    if (word >> 15 == 1) want = -want;
    const float found = view->view().depth[word];
    if (std::isnan(want)) {
      EXPECT_TRUE(std::isnan(found)) << word;
    } else {
      EXPECT_EQ(found, static_cast<float>(want)) << word;
    }
  }
}

TEST(PixelBuffer, TakesPiecesOfAnyNumberOfWholeValues) {
  const testing::PlaneReadback floor = Floor();
  const v1::Readback bits = testing::ReadbackMessage(floor.View());
  const v1::Readback planes = WithPlanes(bits, floor.shadow_bits);
  constexpr uint32_t kSeed = 11;
  std::cout << "seed " << kSeed << "\n";
  std::mt19937 random(kSeed);
  for (int round = 0; round < 50; ++round) {
    const bool has_planes = round % 2 == 1;
    v1::Readback header = has_planes ? planes : bits;
    header.clear_depth();
    header.clear_shadow_bits();
    header.clear_shadow_planes();
    if (has_planes) header.set_shadow_format(v1::SHADOW_FORMAT_PLANES);
    const auto parsed = HeaderOf(header);
    ASSERT_THAT(parsed, testing::IsOk());
    PixelBuffer buffer(*parsed);
    // Where each kind of bytes has got to; the order among them is drawn.
    std::vector<size_t> at(2 + kNumLights, 0);
    while (!buffer.is_complete()) {
      v1::PixelChunk chunk;
      const size_t kind = random() % at.size(), count = 4 * (1 + random() % 300);
      if (kind == 0) {
        chunk.set_depth(bits.depth().substr(at[0], count));
      } else if (kind == 1 && !has_planes) {
        chunk.set_shadow_bits(bits.shadow_bits().substr(at[1], count));
      } else if (kind >= 2 && has_planes) {
        const int plane = static_cast<int>(kind) - 2;
        chunk.set_shadow_plane_index(plane);
        chunk.set_shadow_plane(planes.shadow_planes(plane).substr(at[kind], count));
      } else {
        continue;
      }
      at[kind] += chunk.depth().size() + chunk.shadow_bits().size() + chunk.shadow_plane().size();
      ASSERT_THAT(buffer.Append(chunk), testing::IsOk());
    }
    ExpectPixels(buffer.View(), floor.View());
  }
}

TEST(PixelBuffer, TakesHalvesInPieces) {
  const testing::PlaneReadback floor = Floor();
  const v1::Readback proto = WithHalves(testing::ReadbackMessage(floor.View()), floor.depth);
  PixelBuffer buffer(*HeaderOf(proto));
  ASSERT_THAT(buffer.Append(proto), testing::IsOk());
  ASSERT_THAT(buffer.CheckComplete(), testing::IsOk());
  for (size_t i = 0; i < floor.depth.size(); ++i) {
    EXPECT_EQ(buffer.View().depth[i], static_cast<float>(Eigen::half(floor.depth[i])));
  }
}

TEST(PixelBuffer, RefusesWhatDoesNotBelong) {
  const testing::PlaneReadback floor = Floor();
  const v1::Readback proto = testing::ReadbackMessage(floor.View());
  const auto expect_refused = [&](const v1::PixelChunk& chunk, const std::string& words) {
    PixelBuffer buffer(*HeaderOf(proto));
    const absl::Status status = buffer.Append(chunk);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), HasSubstr(words));
  };
  v1::PixelChunk chunk;
  chunk.set_depth(std::string(10, '\0'));
  expect_refused(chunk, "readback.depth: 10 bytes, want whole values of 4 bytes each");
  chunk.set_depth(std::string(4804, '\0'));
  expect_refused(chunk, "readback.depth: 4804 bytes, want 4800");
  chunk.clear_depth();
  chunk.set_shadow_plane("x");
  expect_refused(chunk, "readback.shadow_format says bits");

  v1::Readback planes = proto;
  planes.clear_shadow_bits();
  planes.set_shadow_format(v1::SHADOW_FORMAT_PLANES);
  PixelBuffer buffer(*HeaderOf(planes));
  for (const int plane : {-1, 2}) {
    chunk.set_shadow_plane_index(plane);
    EXPECT_THAT(std::string(buffer.Append(chunk).message()), HasSubstr("there are 2 lights"));
  }
  EXPECT_THAT(std::string(buffer.CheckComplete().message()),
              HasSubstr("readback.depth: 0 bytes, want 4800"));
}

TEST(ReadbackView, RefusesNoise) {
  testing::PlaneReadback floor = testing::FloorReadback();
  floor.Cast(0, [](int x, int y) { return (x + y) % 2 == 0; });
  const v1::Readback proto = testing::ReadbackMessage(floor.View());
  CallLimits limits;
  limits.max_boundary_pixels = 38 * 28;  // all but the outermost rows and columns
  EXPECT_THAT(ReadbackView::Of(proto, kNumLights, limits), testing::IsOk());
  --limits.max_boundary_pixels;
  const absl::Status status = ReadbackView::Of(proto, kNumLights, limits).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("1064 pixels at the borders of shadows"));
}

TEST(ReadbackHeader, SaysWhatItTakesBeforeAnythingIsTaken) {
  const testing::PlaneReadback floor = Floor();
  v1::Readback proto = testing::ReadbackMessage(floor.View());
  proto.mutable_camera()->set_width(3840);
  proto.mutable_camera()->set_height(2160);
  const auto header = HeaderOf(proto);
  ASSERT_THAT(header, testing::IsOk());
  EXPECT_EQ(header->buffer_bytes(), int64_t{3840} * 2160 * 8);
  proto.mutable_camera()->set_width(2147483647);
  proto.mutable_camera()->set_height(2147483647);
  EXPECT_EQ(HeaderOf(proto).status().code(), absl::StatusCode::kResourceExhausted);
  proto.mutable_camera()->set_width(-2147483647);
  EXPECT_EQ(HeaderOf(proto).status().code(), absl::StatusCode::kInvalidArgument);
  proto.mutable_camera()->set_height(-2147483647);
  EXPECT_EQ(HeaderOf(proto).status().code(), absl::StatusCode::kResourceExhausted);
  proto = testing::ReadbackMessage(floor.View());
  proto.set_depth_format(static_cast<v1::DepthFormat>(7));
  EXPECT_THAT(std::string(HeaderOf(proto).status().message()),
              HasSubstr("readback.depth_format = 7"));
}

}  // namespace
}  // namespace lightfit
