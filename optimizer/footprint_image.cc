#include "optimizer/footprint_image.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "optimizer/receivers.h"
#include "optimizer/samples.h"

namespace lightfit {

absl::StatusOr<std::vector<float>> FootprintImage(const Readback& readback,
                                                  const Light& light,
                                                  const Eigen::Matrix4d& map_from_world,
                                                  const SampleOptions& options) {
  if (absl::Status status = ValidateReadback(readback); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (!map_from_world.allFinite()) {
    return absl::InvalidArgumentError("map_from_world has values that are not finite");
  }
  const AffineDepth affine_depth(readback.camera, readback.depth_kind);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  const Eigen::Matrix4d screen_from_world = world_from_screen.inverse();
  // (u w, v w, w) of a screen point (x, y, d, 1).
  Eigen::Matrix<double, 3, 4> map_from_screen;
  map_from_screen << map_from_world.topRows<2>() * world_from_screen,
      map_from_world.row(3) * world_from_screen;

  std::vector<float> footprints(readback.depth.size(), 0.0f);
  for (int y = 1; y + 1 < readback.height(); ++y) {
    for (int x = 1; x + 1 < readback.width(); ++x) {
      DepthGradient gradient;
      if (!DepthGradientAt(readback, affine_depth, options, x, y, &gradient)) continue;
      const Eigen::Vector4d screen(x + 0.5, y + 0.5, gradient.d, 1.0);
      const Eigen::Vector4d position = world_from_screen * screen;
      const Eigen::Vector3d normal =
          SurfaceNormal(screen_from_world, readback.camera.orthographic, x, y, gradient);
      const Eigen::Vector4d light_position = light.HomogeneousPosition();
      const Eigen::Vector3d to_light =
          light_position.head<3>() - light_position.w() * position.hnormalized();
      if (!(normal.dot(to_light) > options.min_cos_light * to_light.norm())) continue;

      // J_map_screen by the quotient rule, and its inverse.
      const Eigen::Vector3d map = map_from_screen * screen;
      if (!(map.z() > 0.0)) continue;
      Eigen::Matrix<double, 3, 2> derivatives;
      derivatives.col(0) = map_from_screen.col(0) + gradient.d_x * map_from_screen.col(2);
      derivatives.col(1) = map_from_screen.col(1) + gradient.d_y * map_from_screen.col(2);
      const Eigen::Matrix2d J_map_screen =
          (derivatives.topRows<2>() - map.hnormalized() * derivatives.row(2)) / map.z();
      const double footprint = std::sqrt(0.5) * J_map_screen.inverse().norm();
      if (!std::isfinite(footprint)) continue;
      footprints[static_cast<size_t>(y) * readback.width() + x] = static_cast<float>(footprint);
    }
  }
  return footprints;
}

absl::StatusOr<std::vector<uint8_t>> SampleImage(const Readback& readback,
                                                 const Light& light,
                                                 const SampleOptions& options) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  absl::StatusOr<Receivers> receivers =
      FindReceivers(readback, uint32_t{1} << light.shadow_bit, options);
  if (!receivers.ok()) return receivers.status();
  const Samples samples =
      SelectSamples(*receivers, light, Eigen::Matrix3d::Identity(), /*with_edge_normals=*/false);
  std::vector<uint8_t> used(readback.depth.size(), 0);
  for (size_t i = 0; i < samples.size(); ++i) {
    used[static_cast<size_t>(samples.y[i]) * readback.width() + static_cast<size_t>(samples.x[i])] =
        1;
  }
  return used;
}

absl::StatusOr<std::vector<Eigen::Vector3d>> ReceiverPositions(const Readback& readback) {
  if (absl::Status status = ValidateReadback(readback); !status.ok()) return status;
  const AffineDepth affine_depth(readback.camera, readback.depth_kind);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  std::vector<Eigen::Vector3d> positions;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const double depth = readback.depth[static_cast<size_t>(y) * readback.width() + x];
      if (!affine_depth.IsSurface(depth)) continue;
      const Eigen::Vector4d screen(x + 0.5, y + 0.5, affine_depth.At(x, y, depth), 1.0);
      positions.push_back((world_from_screen * screen).hnormalized());
    }
  }
  return positions;
}

}  // namespace lightfit
