// fuzz/small_readback.h
//
// A read-back of few pixels, and messages of it in the forms that targets take.
// In:   examples/yard_180, of which it has one pixel of each 9 x 9.
// Out:  SmallReadback; v1::Readback whole, in other forms, and in pieces.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "geometry/light.h"
#include "io/readback_exr.h"
#include "lightfit/v1/readback.pb.h"
#include "lightfit/v1/service.pb.h"
#include "wire/light_proto.h"

namespace lightfit::fuzz {

struct SmallReadback {
  std::vector<Light> lights;
  ReadbackFile file;
};

// Of the example in `folder`, with its first two lights.
SmallReadback SmallYard(const std::string& folder);

v1::Readback MessageOf(const SmallReadback& yard);

template <typename Request>
Request RequestOf(const SmallReadback& yard) {
  Request request;
  *request.mutable_readback() = MessageOf(yard);
  for (const Light& light : yard.lights) *request.add_lights() = LightToProto(light);
  return request;
}

// Each pixel as two by two cells.
void AddFineCover(const SmallReadback& yard, v1::Readback* readback);

// The same pixels as halves and planes, and other choices.
void UseOtherForms(const SmallReadback& yard, v1::Readback* readback);

// Bytes `begin` to `end` of every kind of pixels.
v1::FitStreamRequest PixelsOf(const v1::Readback& readback, size_t begin, size_t end);

// Which follow in chunks.
void RemovePixels(v1::Readback* readback);

}  // namespace lightfit::fuzz
