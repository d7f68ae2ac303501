// tests/calls/floor_readback.h
//
// Messages of a floor with shadows in every form that pixels may have.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calls/pixel_buffer.h"
#include "tests/calls/requests.h"
#include "tests/testing/plane_readback.h"

namespace lightfit::testing {

inline constexpr int kNumLights = 2;

inline PlaneReadback Floor() {
  PlaneReadback floor = FloorReadback();
  floor.Cast(0, [](int x, int y) { return x > 12 && x < 25 && y > 8; });
  floor.Cast(1, [](int x, int y) { return x + y > 35; });
  return floor;
}

inline v1::Readback WithPlanes(v1::Readback proto, const std::vector<uint32_t>& bits) {
  proto.clear_shadow_bits();
  for (int light = 0; light < kNumLights; ++light) {
    std::string* plane = proto.add_shadow_planes();
    for (const uint32_t word : bits) plane->push_back(word >> light & 1 ? '\xff' : '\0');
  }
  return proto;
}

inline absl::StatusOr<ReadbackHeader> HeaderOf(const v1::Readback& proto) {
  return ReadbackHeaderFromProto(proto, kNumLights, CallLimits());
}

inline void ExpectPixels(const Readback& view, const Readback& want) {
  EXPECT_EQ(view.depth, want.depth);
  EXPECT_EQ(view.shadow_bits, want.shadow_bits);
  EXPECT_EQ(view.facing_bits, want.facing_bits);
  EXPECT_EQ(view.mapped_bits, want.mapped_bits);
  for (int light = 0; light < kNumLights; ++light) {
    EXPECT_EQ(view.KnowsFacing(light), want.KnowsFacing(light)) << light;
    EXPECT_EQ(view.KnowsMapped(light), want.KnowsMapped(light)) << light;
  }
}

// The floor with all there may be.
struct FullFloor {
  PlaneReadback floor = Floor();
  std::vector<uint32_t> facing = BitsWhere([](int x, int y) { return x > 4 && y > 8; });
  std::vector<uint32_t> mapped = BitsWhere([](int x, int y) { return x > 13 && y < 20; });
  uint32_t facing_lights = 3, mapped_lights = 3;

  // The same for both lights but for the edge.
  template <typename Where>
  std::vector<uint32_t> BitsWhere(Where where) const {
    std::vector<uint32_t> words;
    for (size_t i = 0; i < floor.depth.size(); ++i) {
      const int x = static_cast<int>(i) % floor.camera.width;
      const int y = static_cast<int>(i) / floor.camera.width;
      words.push_back((where(x, y) ? 1u : 0u) | (where(x + 1, y) ? 2u : 0u));
    }
    return words;
  }
  // With the bits of lights that are not known at 0.
  FullFloor Of(uint32_t facing_known, uint32_t mapped_known) && {
    for (uint32_t& word : facing) word &= facing_known;
    for (uint32_t& word : mapped) word &= mapped_known;
    facing_lights = facing_known;
    mapped_lights = mapped_known;
    return std::move(*this);
  }
  Readback View() const {
    Readback readback = floor.View();
    readback.facing_bits = facing;
    readback.facing_lights = facing_lights;
    readback.mapped_bits = mapped;
    readback.mapped_lights = mapped_lights;
    return readback;
  }
};

// A plane of a light, empty where it is not known.
inline std::string PlaneOf(const std::vector<uint32_t>& words, uint32_t known, int light) {
  std::string plane;
  if ((known >> light & 1) == 0) return plane;
  for (const uint32_t word : words) plane.push_back(word >> light & 1 ? '\xff' : '\0');
  return plane;
}

inline v1::Readback WithFacingAndMappedPlanes(v1::Readback proto, const FullFloor& full) {
  proto.clear_facing_bits();
  proto.clear_facing_lights();
  proto.clear_mapped_bits();
  proto.clear_mapped_lights();
  for (int light = 0; light < kNumLights; ++light) {
    *proto.add_facing_planes() = PlaneOf(full.facing, full.facing_lights, light);
    *proto.add_mapped_planes() = PlaneOf(full.mapped, full.mapped_lights, light);
  }
  return proto;
}

}  // namespace lightfit::testing
