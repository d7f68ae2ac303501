// Cells of a finer cover, whole and in pieces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
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
using ::testing::HasSubstr;
using testing::HeaderOf;
using testing::kNumLights;

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

}  // namespace
}  // namespace lightfit
