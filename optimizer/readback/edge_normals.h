// optimizer/readback/edge_normals.h
//
// The direction of a shadow's edge on the screen, from coarse bits.
// In:   Readback, a light's bit, the window to smooth over.
// Out:  unit normals, from lit to shadowed.   math.md 4
#pragma once

#include <Eigen/Core>

#include "base/scratch.h"
#include "geometry/affine_depth.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

class EdgeNormals {
 public:
  // `window`: half width in pixels, 1 ... 8. The arguments must outlive the object.
  EdgeNormals(const Readback& readback, const AffineDepth& affine_depth, int bit, int window);

  // The gradient of the shadow bit smoothed over the (2 window + 1)^2 pixels around (x, y), over
  // surfaces only; 0 if there is none.
  Eigen::Vector2d At(int x, int y) const;

 private:
  const Readback& readback_;
  const AffineDepth& affine_depth_;
  int bit_;
  int window_;
  ScratchVector<double> weights_;  // of a window's pixels, in row order
};

}  // namespace lightfit
