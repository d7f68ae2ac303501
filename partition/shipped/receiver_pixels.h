// partition/shipped/receiver_pixels.h
//
// What a read-back sees, pixel by pixel, as patches of surface in the world.
// In:   Surfaces.
// Out:  the middle and the four corners of every pixel that shows a surface.
//
// Between two pixels of a read-back lie several of the image, so a map that must hold what the
// camera sees has to hold the corners of pixels and not their middles alone. A corner lies on the
// pixel's own plane where the surface continues to all four sides; else, at an outline, at the
// pixel's affine depth.
#pragma once

#include <Eigen/Core>
#include <array>

#include "absl/functional/function_ref.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

struct ReceiverPixel {
  int x = 0, y = 0;  // column and row
  // World. The middle first, then the corners around it.
  std::array<Eigen::Vector3d, 5> points;
};

// In row order, until a StopScope says so. To a perspective camera a corner is at most twice and at
// least half as far away as its middle.
void ForEachReceiverPixel(const Surfaces& surfaces,
                          absl::FunctionRef<void(const ReceiverPixel&)> visit);

}  // namespace lightfit
