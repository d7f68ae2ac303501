// Which surfaces face a light and which are mapped, in either form, whole and in pieces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "calls/pixel_buffer.h"
#include "tests/calls/floor_readback.h"
#include "tests/calls/requests.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using testing::ExpectPixels;
using testing::Floor;
using testing::FullFloor;
using ::testing::HasSubstr;
using testing::HeaderOf;
using testing::kNumLights;
using testing::PlaneOf;
using testing::WithFacingAndMappedPlanes;
using testing::WithPlanes;

TEST(ReadbackView, RefersToFacingAndMappedBitsAsTheyAre) {
  const FullFloor full;
  const v1::Readback proto = testing::ReadbackMessage(full.View());
  const auto view = ReadbackView::Of(proto, kNumLights, CallLimits());
  ASSERT_THAT(view, testing::IsOk());
  ExpectPixels(view->view(), full.View());
  EXPECT_EQ(static_cast<const void*>(view->view().facing_bits.data()), proto.facing_bits().data());
  EXPECT_EQ(static_cast<const void*>(view->view().mapped_bits.data()), proto.mapped_bits().data());
}

TEST(ReadbackView, BitsMayBeKnownOfSomeLightsAlone) {
  const FullFloor full = FullFloor().Of(2, 1);
  const v1::Readback proto = testing::ReadbackMessage(full.View());
  const auto view = ReadbackView::Of(proto, kNumLights, CallLimits());
  ASSERT_THAT(view, testing::IsOk());
  ExpectPixels(view->view(), full.View());
}

TEST(ReadbackView, TakesFacingAndMappedPlanesBesideEitherFormOfShadows) {
  for (const auto& [facing, mapped] : {std::pair(3u, 3u), std::pair(2u, 1u), std::pair(1u, 2u)}) {
    const FullFloor full = FullFloor().Of(facing, mapped);
    const v1::Readback bits =
        WithFacingAndMappedPlanes(testing::ReadbackMessage(full.View()), full);
    for (const v1::Readback& proto : {bits, WithPlanes(bits, full.floor.shadow_bits)}) {
      const auto view = ReadbackView::Of(proto, kNumLights, CallLimits());
      ASSERT_THAT(view, testing::IsOk());
      ExpectPixels(view->view(), full.View());
    }
  }
}

// Planes that are missing at the end, too.
TEST(ReadbackView, EmptyPlanesAreNotKnown) {
  const testing::PlaneReadback floor = Floor();
  v1::Readback proto = testing::ReadbackMessage(floor.View());
  proto.add_facing_planes();
  proto.add_facing_planes();
  *proto.add_mapped_planes() = std::string(floor.depth.size(), '\x80');
  const auto view = ReadbackView::Of(proto, kNumLights, CallLimits());
  ASSERT_THAT(view, testing::IsOk());
  EXPECT_TRUE(view->view().facing_bits.empty());
  EXPECT_TRUE(view->view().KnowsMapped(0));
  EXPECT_FALSE(view->view().KnowsMapped(1));
  EXPECT_THAT(view->view().mapped_bits, ::testing::Each(1u));
}

TEST(ReadbackView, RefusesFacingThatIsIncomplete) {
  const FullFloor full;
  const v1::Readback good = testing::ReadbackMessage(full.View());
  const auto expect_refused = [&](const auto& spoil, const std::string& words) {
    v1::Readback proto = good;
    spoil(&proto);
    const absl::Status status = ReadbackView::Of(proto, kNumLights, CallLimits()).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << words;
    EXPECT_THAT(std::string(status.message()), HasSubstr(words));
  };
  using Proto = v1::Readback;
  expect_refused([](Proto* p) { p->mutable_facing_bits()->resize(400); },
                 "readback.facing_bits: 400 bytes, want 4800");
  expect_refused([](Proto* p) { p->mutable_facing_bits()->append("1234"); },
                 "readback.facing_bits: 4804 bytes, want 4800");
  expect_refused([](Proto* p) { p->mutable_mapped_bits()->append("1"); },
                 "readback.mapped_bits: 4801 bytes, want whole values of 4 bytes");
  expect_refused([](Proto* p) { p->add_facing_planes("1"); }, "want one of them");
  expect_refused([](Proto* p) { p->set_facing_lights(4); },
                 "readback.facing_lights = 0x4: there are 2 lights");
  expect_refused([](Proto* p) { p->set_mapped_format(static_cast<v1::ShadowFormat>(7)); },
                 "readback.mapped_format = 7");
  const Proto planes = WithFacingAndMappedPlanes(good, full);
  expect_refused(
      [&](Proto* p) {
        *p = planes;
        p->mutable_facing_planes(1)->resize(7);
      },
      "readback.facing_planes[1]: 7 bytes, want 1200");
  expect_refused(
      [&](Proto* p) {
        *p = planes;
        p->mutable_depth()->resize(4);
      },
      "readback.depth: 4 bytes, want 4800");
  expect_refused(
      [&](Proto* p) {
        *p = planes;
        p->add_mapped_planes("x");
      },
      "mapped plane 2: there are 2 lights");
  expect_refused(
      [&](Proto* p) {
        *p = planes;
        p->set_facing_lights(1);
      },
      "readback.facing_planes[1]: has pixels, but readback.facing_lights = 0x1");
  expect_refused(
      [](Proto* p) {
        p->clear_facing_bits();
        p->set_facing_format(v1::SHADOW_FORMAT_BITS);
      },
      "readback.facing_bits: 0 bytes, want 4800");
}

// Every kind in either form, known of all lights or of some.
TEST(PixelBuffer, TakesFacingAndMappedInPieces) {
  constexpr uint32_t kSeed = 12;
  std::cout << "seed " << kSeed << "\n";
  std::mt19937 random(kSeed);
  for (int round = 0; round < 40; ++round) {
    const FullFloor full = FullFloor().Of(1 + random() % 3, 1 + random() % 3);
    const v1::Readback whole = testing::ReadbackMessage(full.View());
    const bool facing_planes = random() % 2 == 0, mapped_planes = random() % 2 == 0;
    v1::Readback header = whole;
    ClearPixels(&header);
    header.set_facing_format(facing_planes ? v1::SHADOW_FORMAT_PLANES : v1::SHADOW_FORMAT_BITS);
    header.set_mapped_format(mapped_planes ? v1::SHADOW_FORMAT_PLANES : v1::SHADOW_FORMAT_BITS);
    const auto parsed = HeaderOf(header);
    ASSERT_THAT(parsed, testing::IsOk());
    EXPECT_EQ(parsed->buffer_bytes(), 1200 * 16);
    std::vector<v1::PixelChunk> chunks;
    const auto cut = [&](const std::string& bytes, const auto& set) {
      for (size_t at = 0; at < bytes.size();) {
        const size_t count = 4 * (1 + random() % 300);
        set(&chunks.emplace_back(), bytes.substr(at, count));
        at += count;
      }
    };
    using Chunk = v1::PixelChunk;
    cut(whole.depth(), [](Chunk* c, const std::string& b) { c->set_depth(b); });
    cut(whole.shadow_bits(), [](Chunk* c, const std::string& b) { c->set_shadow_bits(b); });
    if (!facing_planes) {
      cut(whole.facing_bits(), [](Chunk* c, const std::string& b) { c->set_facing_bits(b); });
    }
    if (!mapped_planes) {
      cut(whole.mapped_bits(), [](Chunk* c, const std::string& b) { c->set_mapped_bits(b); });
    }
    for (int light = 0; light < kNumLights; ++light) {
      const auto facing = [&](Chunk* c, const std::string& b) {
        c->set_facing_plane(b);
        c->set_facing_plane_index(light);
      };
      if (facing_planes) cut(PlaneOf(full.facing, full.facing_lights, light), facing);
      const auto mapped = [&](Chunk* c, const std::string& b) {
        c->set_mapped_plane(b);
        c->set_mapped_plane_index(light);
      };
      if (mapped_planes) cut(PlaneOf(full.mapped, full.mapped_lights, light), mapped);
    }
    PixelBuffer buffer(*parsed);
    for (const v1::PixelChunk& chunk : chunks) {
      EXPECT_FALSE(buffer.is_complete());
      ASSERT_THAT(buffer.Append(chunk), testing::IsOk());
    }
    ASSERT_THAT(buffer.CheckComplete(), testing::IsOk());
    ExpectPixels(buffer.View(), full.View());
  }
}

TEST(PixelBuffer, RefusesFacingThatWasNotAnnounced) {
  const testing::PlaneReadback floor = Floor();
  v1::Readback header = testing::ReadbackMessage(floor.View());
  ClearPixels(&header);
  PixelBuffer buffer(*HeaderOf(header));
  v1::PixelChunk bits;
  bits.set_facing_bits(std::string(4, '\0'));
  EXPECT_THAT(std::string(buffer.Append(bits).message()),
              HasSubstr("readback.facing_bits: has pixels, but readback.facing_format says none"));
  v1::PixelChunk plane;
  plane.set_mapped_plane("x");
  EXPECT_THAT(
      std::string(buffer.Append(plane).message()),
      HasSubstr("readback.mapped_planes: has pixels, but readback.mapped_format says none"));
}

TEST(ReadbackView, RefusesNoiseInFacing) {
  FullFloor full;
  full.floor = testing::FloorReadback();
  full.facing = full.BitsWhere([](int x, int y) { return (x + y) % 2 == 0; });
  CallLimits limits;
  limits.max_boundary_pixels = 38 * 28 - 1;
  const absl::Status status =
      ReadbackView::Of(testing::ReadbackMessage(full.View()), kNumLights, limits).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("1064 pixels at the borders of shadows and of surfaces that face a light"));
}

}  // namespace
}  // namespace lightfit
