#include "bench/matrix_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "geometry/affine_depth.h"
#include "optimizer/energy/footprint.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

absl::StatusOr<MatrixCheck> MatrixCheck::Create(const Readback& readback,
                                                const Light& light,
                                                const SampleOptions& options) {
  absl::StatusOr<Surfaces> surfaces =
      FindSurfaces(readback, uint32_t{1} << light.shadow_bit, options);
  if (!surfaces.ok()) return surfaces.status();
  MatrixCheck check;
  // The right inverse of ray_from_world, whose first three columns have orthonormal rows or, for a
  // directional light, two of them and the world point's fourth coordinate.
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
  check.world_from_ray_.topRows<3>() = ray_from_world.leftCols<3>().transpose();
  check.world_from_ray_.row(3).setZero();
  if (light.kind == Light::Kind::kDirectional) check.world_from_ray_(3, 2) = 1.0;
  check.samples_ = SelectSamples(*surfaces,
                                 light,
                                 surfaces->options,
                                 Eigen::Matrix3d::Identity(),
                                 /*with_edge_normals=*/false);
  const AffineDepth affine_depth = AffineDepthOf(readback);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  size_t pixel = 0;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x, ++pixel) {
      const double depth = readback.depth[pixel];
      if (!affine_depth.IsSurface(depth)) continue;
      const Eigen::Vector4d screen(x + 0.5, y + 0.5, affine_depth.At(x, y, depth), 1.0);
      check.receivers_.emplace_back((world_from_screen * screen).hnormalized());
    }
  }
  return check;
}

MatrixQuality MatrixCheck::Measure(const Eigen::Matrix4d& map_from_world, MapSize map) const {
  Eigen::Matrix<double, 3, 4> rows;  // (u w, v w, w) of a world point
  rows << map_from_world.topRows<2>(), map_from_world.row(3);

  MatrixQuality quality;
  quality.energy = Energy(rows * world_from_ray_, samples_, MetricWeights());
  for (const Eigen::Vector3d& receiver : receivers_) {
    const Eigen::Vector3d p = rows * receiver.homogeneous();
    if (!(p.z() > 0.0)) {
      quality.outside_texels = std::numeric_limits<double>::infinity();
      break;
    }
    const double u = p.x() / p.z(), v = p.y() / p.z();
    quality.outside_texels =
        std::max({quality.outside_texels, -u, u - map.width, -v, v - map.height});
  }
  return quality;
}

}  // namespace lightfit
