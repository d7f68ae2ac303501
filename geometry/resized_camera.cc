#include "geometry/resized_camera.h"

#include <Eigen/Core>

namespace lightfit {

Camera ResizedCamera(const Camera& camera, int width, int height) {
  Camera resized = camera;
  resized.width = width;
  resized.height = height;
  const Eigen::Vector3d scale(
      static_cast<double>(width) / camera.width, static_cast<double>(height) / camera.height, 1.0);
  resized.screen_from_camera = scale.asDiagonal() * camera.screen_from_camera;
  return resized;
}

}  // namespace lightfit
