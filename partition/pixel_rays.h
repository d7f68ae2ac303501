// partition/pixel_rays.h
//
// The rays of a read-back's pixels: of centres, and of corners on the pixel's own plane.
// In:   a LightView, the samples that count; a pixel.
// Out:  rays in the view's normalised coordinates.   docs/mathematics.md (21)
#pragma once

#include <Eigen/Core>
#include <optional>

#include "base/scratch.h"
#include "geometry/homography.h"
#include "optimizer/light_view.h"
#include "optimizer/readback/sample_options.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

class PixelRays {
 public:
  // The view must outlive the object.
  PixelRays(const LightView& view, const SampleOptions& options);

  // A pixel's own plane as its depth tells it, or nothing. In the image's outermost rows and
  // columns, which have no differences of their own, that of the pixel beside it, if it is on the
  // same plane.
  std::optional<DepthGradient> PlaneAt(int x, int y) const;

  // Whether shadows can be seen on it: neither edge-on nor turned away, from light or eye.
  bool ShowsShadows(int x, int y, const DepthGradient& plane) const;

  // Of a screen point (x, y) at affine depth d.
  Eigen::Vector3d RayOf(double x, double y, double d) const {
    return ray_from_screen_ * Eigen::Vector4d(x, y, d, 1.0);
  }

  // Appends the rays of the pixel's corners, `half` pixels from its centre, on its plane; where no
  // plane is known, of its centre.
  void AddCorners(int x,
                  int y,
                  const std::optional<DepthGradient>& plane,
                  double half,
                  ScratchVector<Eigen::Vector3d>* rays) const;

  const Eigen::Matrix<double, 3, 4>& ray_from_screen() const { return ray_from_screen_; }

 private:
  const Surfaces& surfaces_;
  SampleOptions options_;
  Eigen::Matrix4d screen_from_world_;
  Eigen::Vector4d light_position_;
  Eigen::Matrix<double, 3, 4> ray_from_screen_;
};

// Of a world point: from a point light, or along a directional one's travel.
double DistanceFromLight(const Light& light, const Eigen::Vector3d& world);

// The same of all receivers in the read-back.
DepthRange DistancesFromLight(const Surfaces& surfaces, const Light& light);

}  // namespace lightfit
