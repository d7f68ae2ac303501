// render/ray_caster.h
//
// First hits and occlusion of rays with the triangles of a scene. The one place that knows Embree.
// In:   a Scene, which it keeps.
// Out:  hits; from any number of threads at once, and the same on every run.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <memory>

#include "absl/status/statusor.h"
#include "base/parallel.h"
#include "scenes/scene.h"

namespace lightfit {

struct Ray {
  Eigen::Vector3d origin;     // world
  Eigen::Vector3d direction;  // unit
};

struct Hit {
  int triangle = -1;  // -1: nothing
  double distance = std::numeric_limits<double>::infinity();

  bool is_surface() const { return triangle >= 0; }
};

class RayCaster {
 public:
  // InvalidArgument without a triangle of positive area. Bad triangles are dropped
  // (DropBadTriangles) and counted.
  static absl::StatusOr<RayCaster> Build(Scene scene, int num_threads = NumProcessors());

  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;
  ~RayCaster();

  // The nearest hit at a distance in (near, far). Distances are those of the triangle's plane in
  // double precision.
  Hit FirstHit(const Ray& ray,
               double near = 0.0,
               double far = std::numeric_limits<double>::infinity()) const;

  // Whether anything is hit at a distance in (near, far).
  bool IsBlocked(const Ray& ray,
                 double near = 0.0,
                 double far = std::numeric_limits<double>::infinity()) const;

  // Unit normal of a triangle, on the side that its winding says.
  Eigen::Vector3d Normal(int triangle) const;

  const Scene& scene() const;
  const Eigen::AlignedBox3d& bounds() const;  // of all triangles, world
  int num_threads() const;                    // for loops over many rays
  int64_t num_dropped_triangles() const;

  // Distances below this cannot be told apart at `point`: single-precision vertices and rays.
  double Resolution(const Eigen::Vector3d& point) const;

 private:
  struct State;
  explicit RayCaster(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace lightfit
