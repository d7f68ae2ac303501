// bench/inputs.h
//
// What the benchmarks run on: random box scenes, and read-backs of a renderer where there are any.
// In:   a seed, or a folder of sets, each with scene.json (lights) and frames 0001.exr, ...
// Out:  Inputs that own their pixels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct Input {
  std::string name;  // "boxes/17", "yard_180/0001"
  Camera camera;
  DepthKind depth_kind = DepthKind::kCameraZ;
  std::vector<float> depth;
  std::vector<uint32_t> shadow_bits;
  std::vector<uint32_t> facing_bits;  // of the lights in `facing_lights`; empty: of none
  uint32_t facing_lights = 0;
  std::vector<Light> lights;  // those whose shadow could be read

  // Refers to this object's buffers.
  Readback View() const;
};

// Boxes on a floor, camera and lights all from the seed.
Input BoxInput(uint64_t seed, int width, int height, int num_lights);

// One frame of a set.
absl::StatusOr<Input> ReadInput(const std::string& set_folder, const std::string& frame);

// The folder of sets beside the repository. It need not exist: see HasReadbacks().
std::string DefaultReadbackFolder();
bool HasReadbacks(const std::string& folder);

// Every `frame_step`-th frame of every set in the folder, in order of name.
absl::StatusOr<std::vector<Input>> ReadInputs(const std::string& folder, int frame_step);

}  // namespace lightfit
