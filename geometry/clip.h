// geometry/clip.h
//
// From the map's own coordinates to the clip space of a graphics interface.
// In:   map_from_world, result (u w, v w, z w, w): u, v in texels, z in [0, 1], near to far.
// Out:  clip_from_world in the convention the renderer uses.   math.md 8
#pragma once

#include <Eigen/Core>

#include "geometry/map_size.h"

namespace lightfit {

// Texel (0, 0) is the first in memory. `y_up` says whether clip y = +1 is the first row (Direct3D,
// Metal, WebGPU) or y = -1 is (Vulkan, OpenGL).
struct ClipConvention {
  enum class Depth { kZeroToOne, kMinusOneToOne, kReversedZeroToOne };

  Depth depth = Depth::kZeroToOne;
  bool y_up = false;

  static ClipConvention Vulkan() { return {Depth::kZeroToOne, false}; }
  static ClipConvention Direct3D() { return {Depth::kZeroToOne, true}; }
  static ClipConvention OpenGl() { return {Depth::kMinusOneToOne, false}; }
  static ClipConvention ReversedZ() { return {Depth::kReversedZeroToOne, false}; }
  // Reversed z of Direct3D, Metal and WebGPU; ReversedZ() is Vulkan's.
  static ClipConvention Direct3DReversed() { return {Depth::kReversedZeroToOne, true}; }
};

// Clip space from map space, both homogeneous. Column vectors; an engine with row vectors
// transposes the product clip_from_map * map_from_world.
Eigen::Matrix4d ClipFromMap(MapSize map, const ClipConvention& clip);

}  // namespace lightfit
