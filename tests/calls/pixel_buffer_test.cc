#include "calls/pixel_buffer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "tests/calls/requests.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;

constexpr int kNumLights = 2;

testing::PlaneReadback Floor() {
  testing::PlaneReadback floor = testing::FloorReadback();
  floor.Cast(0, [](int x, int y) { return x > 12 && x < 25 && y > 8; });
  floor.Cast(1, [](int x, int y) { return x + y > 35; });
  return floor;
}

v1::Readback WithPlanes(v1::Readback proto, const std::vector<uint32_t>& bits) {
  proto.clear_shadow_bits();
  for (int light = 0; light < kNumLights; ++light) {
    std::string* plane = proto.add_shadow_planes();
    for (const uint32_t word : bits) plane->push_back(word >> light & 1 ? '\xff' : '\0');
  }
  return proto;
}

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

absl::StatusOr<ReadbackHeader> HeaderOf(const v1::Readback& proto) {
  return ReadbackHeaderFromProto(proto, kNumLights, CallLimits());
}

void ExpectPixels(const Readback& view, const Readback& want) {
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
  testing::PlaneReadback floor = Floor();
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
std::string PlaneOf(const std::vector<uint32_t>& words, uint32_t known, int light) {
  std::string plane;
  if ((known >> light & 1) == 0) return plane;
  for (const uint32_t word : words) plane.push_back(word >> light & 1 ? '\xff' : '\0');
  return plane;
}

v1::Readback WithFacingAndMappedPlanes(v1::Readback proto, const FullFloor& full) {
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

// Cells of 2 x 2 to a pixel of the floor, with everything that they may have.
struct FineFloor {
  testing::PlaneReadback floor = Floor();
  testing::PlaneReadback fine =
      testing::FloorReadback(testing::FloorCamera(2 * floor.camera.width, 2 * floor.camera.height));
  std::vector<float> furthest;
  std::vector<uint32_t> lit;
  FineCover cover;

  FineFloor() {
    fine.Cast(0, [](int x, int y) { return x > 22 && x < 52 && y > 16; });
    for (size_t i = 0; i < fine.depth.size(); ++i) {
      furthest.push_back(fine.depth[i] + 0.1F);
      lit.push_back(~fine.shadow_bits[i] & 2U);
    }
    cover.columns = fine.camera.width;
    cover.rows = fine.camera.height;
    cover.nearest = fine.depth;
    cover.furthest = furthest;
    cover.shadow_bits = fine.shadow_bits;
    cover.lit_bits = lit;
    cover.lit_lights = 2;
  }

  v1::Readback Message() const {
    v1::Readback proto = testing::ReadbackMessage(floor.View());
    *proto.mutable_fine_cover() = testing::FineCoverMessage(cover);
    return proto;
  }
};

void ExpectCells(const Readback& view, const FineCover& want) {
  ASSERT_NE(view.fine_cover, nullptr);
  EXPECT_EQ(view.fine_cover->columns, want.columns);
  EXPECT_EQ(view.fine_cover->rows, want.rows);
  EXPECT_EQ(view.fine_cover->nearest, want.nearest);
  EXPECT_EQ(view.fine_cover->furthest, want.furthest);
  EXPECT_EQ(view.fine_cover->shadow_bits, want.shadow_bits);
  EXPECT_EQ(view.fine_cover->lit_bits, want.lit_bits);
  EXPECT_EQ(view.fine_cover->lit_lights, want.lit_lights);
  EXPECT_THAT(ValidateReadback(view), testing::IsOk());
}

TEST(FineCoverBuffer, TakesCellsWholeOrInPieces) {
  FineFloor floor;
  for (const bool has_all : {true, false}) {
    if (!has_all) {
      floor.cover.furthest = {};
      floor.cover.lit_bits = {};
      floor.cover.lit_lights = 0;
    }
    const v1::Readback whole = floor.Message();
    auto view = ReadbackView::Of(whole, kNumLights, CallLimits());
    ASSERT_THAT(view, testing::IsOk());
    const ReadbackView moved = *std::move(view);
    ExpectPixels(moved.view(), floor.floor.View());
    ExpectCells(moved.view(), floor.cover);

    v1::Readback header = whole;
    header.mutable_fine_cover()->set_with_furthest(has_all);
    ClearPixels(&header);
    const auto parsed = HeaderOf(header);
    ASSERT_THAT(parsed, testing::IsOk());
    EXPECT_EQ(parsed->fine.buffer_bytes(), (has_all ? 4 : 2) * 4 * parsed->fine.num_cells());
    PixelBuffer buffer(*parsed);
    v1::Readback coarse = whole;
    coarse.clear_fine_cover();
    ASSERT_THAT(buffer.Append(coarse), testing::IsOk());
    EXPECT_FALSE(buffer.is_complete());
    const v1::FineCover& cells = whole.fine_cover();
    const auto append = [&buffer](const std::string& bytes, auto set) {
      constexpr size_t kPieceBytes = 1000;
      for (size_t at = 0; at < bytes.size(); at += kPieceBytes) {
        v1::PixelChunk chunk;
        set(&chunk, bytes.substr(at, kPieceBytes));
        ASSERT_THAT(buffer.Append(chunk), testing::IsOk());
      }
    };
    append(cells.nearest(), [](auto* c, const std::string& b) { c->set_fine_nearest(b); });
    append(cells.furthest(), [](auto* c, const std::string& b) { c->set_fine_furthest(b); });
    append(cells.shadow_bits(), [](auto* c, const std::string& b) { c->set_fine_shadow_bits(b); });
    append(cells.lit_bits(), [](auto* c, const std::string& b) { c->set_fine_lit_bits(b); });
    ASSERT_THAT(buffer.CheckComplete(), testing::IsOk());
    FineCover cover;
    ExpectCells(buffer.View(&cover), floor.cover);
    EXPECT_EQ(buffer.View().fine_cover, nullptr);
  }
}

TEST(FineCoverBuffer, RefusesWhatDoesNotBelong) {
  const FineFloor floor;
  const auto cover = [](v1::Readback* readback) { return readback->mutable_fine_cover(); };
  const std::vector<testing::BadInput<v1::Readback>> bad = {
      {[&](auto* r) { cover(r)->set_columns(0); }, "readback.fine_cover: 0 x 60 cells, want more"},
      {[&](auto* r) { cover(r)->set_rows(-60); }, "readback.fine_cover: 80 x -60 cells"},
      {[&](auto* r) { cover(r)->set_columns(40); }, "more than the read-back's 40 x 30 pixels"},
      {[&](auto* r) {
         cover(r)->set_columns(2147483647);
         cover(r)->set_rows(2147483647);
       },
       "cells, and this server takes at most",
       absl::StatusCode::kResourceExhausted},
      {[&](auto* r) { cover(r)->mutable_nearest()->pop_back(); },
       "readback.fine_cover.nearest: 19199 bytes, want whole values of 4 bytes"},
      {[&](auto* r) { cover(r)->clear_nearest(); },
       "readback.fine_cover.nearest: 0 bytes, want 19200: columns * rows values as in "
       "readback.fine_cover"},
      {[&](auto* r) { cover(r)->mutable_shadow_bits()->append("1234"); },
       "readback.fine_cover.shadow_bits: 19204 bytes, want 19200: columns * rows values of 4 "
       "bytes"},
      {[&](auto* r) { cover(r)->mutable_furthest()->resize(400); },
       "readback.fine_cover.furthest: 400 bytes, want 19200"},
      {[&](auto* r) { cover(r)->clear_lit_bits(); },
       "readback.fine_cover.lit_bits: 0 bytes, want 19200"},
      {[&](auto* r) { cover(r)->set_lit_lights(0); },
       "readback.fine_cover.lit_bits: 19200 bytes, and the header says that there are none; want "
       "readback.fine_cover.lit_lights there"},
      {[&](auto* r) { cover(r)->set_lit_lights(4); },
       "readback.fine_cover.lit_lights = 0x4: there are 2 lights"},
  };
  testing::ExpectRefused(
      floor.Message(), bad, [](const v1::Readback& proto, const CallContext& context) {
        return ReadbackView::Of(proto, kNumLights, context.limits);
      });
  v1::Readback coarse = floor.Message();
  coarse.clear_fine_cover();
  PixelBuffer buffer(*HeaderOf(coarse));
  v1::PixelChunk chunk;
  chunk.set_fine_nearest("1234");
  EXPECT_THAT(std::string(buffer.Append(chunk).message()),
              HasSubstr("want readback.fine_cover.columns and rows there, or leave them out"));
  // Depths of the furthest that the header of a stream did not announce.
  v1::Readback unannounced = floor.Message();
  ClearPixels(&unannounced);
  PixelBuffer nearest_only(*HeaderOf(unannounced));
  chunk.clear_fine_nearest();
  chunk.set_fine_furthest("1234");
  EXPECT_THAT(std::string(nearest_only.Append(chunk).message()),
              HasSubstr("want readback.fine_cover.with_furthest there"));
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
