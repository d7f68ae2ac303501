// geometry/camera.h
//
// The camera that rendered the image: from pixels and depth to world space and back.
// In:   an engine's view and projection matrices, or intrinsics and a pose.
// Out:  world_from_screen, the 4x4 that everything downstream multiplies.
//
// Screen coordinates are homogeneous 4-vectors (x, y, d, 1): x right and y down in pixels, pixel
// centres at +0.5, and the *affine depth* d, which is 1/z for a perspective camera and z for an
// orthographic one (z: planar distance in front of the camera, world units). With this d the map to
// world space is one 4x4 matrix and d is affine in (x, y) on every plane.   math.md (11)
#pragma once

#include <Eigen/Core>
#include <limits>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace lightfit {

// What the numbers in a depth image mean.
enum class DepthKind {
  kCameraZ,              // planar distance in front of the camera, world units, positive forward
  kDistance,             // distance from the camera's centre along the pixel's ray, world units
  kNdcZeroToOne,         // Direct3D, Vulkan: 0 at the near plane, 1 at the far plane
  kNdcMinusOneToOne,     // OpenGL clip depth: -1 at the near plane, 1 at the far plane
  kNdcReversedZeroToOne  // 1 at the near plane, 0 at the far plane
};

const char* DepthKindName(DepthKind kind);

// Whether depth lies between the clip planes, so that they must be known.
bool IsNdc(DepthKind kind);

struct ClipConvention;  // geometry/clip.h

// A perspective or orthographic camera. Camera space is x, y as you like and z forward, in world
// units; its handedness does not matter.
struct Camera {
  int width = 0;   // pixels
  int height = 0;  // pixels
  bool orthographic = false;

  // Rigid, or rigid with a mirror: points in camera space from points in the world.
  Eigen::Matrix4d camera_from_world = Eigen::Matrix4d::Identity();

  // Intrinsics, last row (0, 0, 1). Perspective: (x z, y z, z) = K (X, Y, Z).
  // Orthographic: (x, y, 1) = K (X, Y, 1). Pixels.
  Eigen::Matrix3d screen_from_camera = Eigen::Matrix3d::Identity();

  // Distances of the clip planes, world units; needed for NDC depth only. far may be infinite.
  double near = 0.0;
  double far = std::numeric_limits<double>::infinity();

  // World point of a screen point (x, y, d, 1), homogeneous with a positive scale in front of the
  // camera. Requires a camera that passed ValidateCamera().
  Eigen::Matrix4d WorldFromScreen() const;

  // The inverse: screen point (x, y, d, 1) times a positive scale for points in front.
  Eigen::Matrix4d ScreenFromWorld() const;
};

// Checks sizes, finiteness and that both matrices can be inverted. `kind` NDC also needs near, far.
absl::Status ValidateCamera(const Camera& camera, DepthKind kind = DepthKind::kCameraZ);

// A camera from the matrices of an engine (column vectors): camera_from_world may look along -z
// (OpenGL) or +z, clip_from_camera is perspective or orthographic, in the given clip convention.
absl::StatusOr<Camera> MakeCamera(const Eigen::Matrix4d& camera_from_world,
                                  const Eigen::Matrix4d& clip_from_camera,
                                  const ClipConvention& clip,
                                  int width,
                                  int height);

// A symmetric perspective camera at `eye` looking at `target`; the vertical field of view is in
// radians. For tests, tools and examples.
absl::StatusOr<Camera> LookAtCamera(const Eigen::Vector3d& eye,
                                    const Eigen::Vector3d& target,
                                    const Eigen::Vector3d& up,
                                    double vertical_fov_rad,
                                    int width,
                                    int height);

}  // namespace lightfit
