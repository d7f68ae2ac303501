#include "geometry/camera.h"

#include <Eigen/Dense>
#include <cmath>

#include "absl/strings/str_format.h"
#include "geometry/clip.h"

namespace lightfit {

namespace {

// A matrix counts as singular when its determinant is this small against the product of its rows'
// lengths (Hadamard's bound).
constexpr double kSingularRatio = 1e-12;

template <int n>
bool IsInvertible(const Eigen::Matrix<double, n, n>& m) {
  const double bound = m.rowwise().norm().prod();
  return m.allFinite() && bound > 0.0 && std::abs(m.determinant()) > kSingularRatio * bound;
}

}  // namespace

bool IsNdc(DepthKind kind) {
  return kind == DepthKind::kNdcZeroToOne || kind == DepthKind::kNdcMinusOneToOne ||
         kind == DepthKind::kNdcReversedZeroToOne;
}

const char* DepthKindName(DepthKind kind) {
  switch (kind) {
    case DepthKind::kCameraZ:
      return "camera_z";
    case DepthKind::kDistance:
      return "distance";
    case DepthKind::kNdcZeroToOne:
      return "ndc_zero_to_one";
    case DepthKind::kNdcMinusOneToOne:
      return "ndc_minus_one_to_one";
    case DepthKind::kNdcReversedZeroToOne:
      return "ndc_reversed_zero_to_one";
  }
  return "unknown";
}

Eigen::Matrix4d Camera::WorldFromScreen() const {
  const Eigen::Matrix3d camera_from_screen = screen_from_camera.inverse();
  // Perspective: at z = 1/d the camera point is K^-1 (x, y, 1) / d; times d: (K^-1 (x, y, 1), d).
  // Orthographic: K^-1 (x, y, 1) gives (X, Y), and Z = d.
  Eigen::Matrix4d camera_from_affine = Eigen::Matrix4d::Zero();
  camera_from_affine.block<2, 2>(0, 0) = camera_from_screen.topLeftCorner<2, 2>();
  camera_from_affine.block<2, 1>(0, 3) = camera_from_screen.topRightCorner<2, 1>();
  if (orthographic) {
    camera_from_affine(2, 2) = 1.0;
    camera_from_affine(3, 3) = 1.0;
  } else {
    camera_from_affine(2, 3) = 1.0;
    camera_from_affine(3, 2) = 1.0;
  }
  return camera_from_world.inverse() * camera_from_affine;
}

Eigen::Matrix4d Camera::ScreenFromWorld() const { return WorldFromScreen().inverse(); }

absl::Status ValidateCamera(const Camera& camera, DepthKind kind) {
  if (camera.width < 1 || camera.height < 1) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "camera: size = %dx%d, want at least 1x1 pixels", camera.width, camera.height));
  }
  if (!camera.camera_from_world.allFinite() ||
      !IsInvertible<3>(camera.camera_from_world.topLeftCorner<3, 3>()) ||
      camera.camera_from_world.row(3) != Eigen::RowVector4d::UnitW()) {
    return absl::InvalidArgumentError(
        "camera.camera_from_world is singular, not finite or not affine: want a rotation (or a "
        "rotation and a mirror) with a translation, last row (0, 0, 0, 1)");
  }
  // Fourth powers of them are summed.
  constexpr double kMaxValue = 1e18;
  const double largest = std::max(camera.camera_from_world.cwiseAbs().maxCoeff(),
                                  camera.screen_from_camera.cwiseAbs().maxCoeff());
  if (largest > kMaxValue) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "camera: has a value of %g, want at most %g: are pose and intrinsics in world units and "
        "pixels?",
        largest,
        kMaxValue));
  }
  // How far the window is from the axis, its last column, does not make it singular.
  if (!camera.screen_from_camera.allFinite() ||
      !IsInvertible<2>(camera.screen_from_camera.topLeftCorner<2, 2>()) ||
      camera.screen_from_camera.row(2) != Eigen::RowVector3d::UnitZ()) {
    return absl::InvalidArgumentError(
        "camera.screen_from_camera is singular or not finite: want intrinsics in pixels with last "
        "row (0, 0, 1)");
  }
  // Infinity is welcome as the far distance of an NDC camera, but not of an orthographic one.
  if (IsNdc(kind) && !(camera.far > camera.near && std::isfinite(camera.near) &&
                       (camera.orthographic ? std::isfinite(camera.far) : camera.near > 0.0))) {
    return absl::InvalidArgumentError(
        absl::StrFormat("camera: near = %g, far = %g: depth of kind %s wants the clip planes, "
                        "0 < near < far",
                        camera.near,
                        camera.far,
                        DepthKindName(kind)));
  }
  return absl::OkStatus();
}

absl::StatusOr<Camera> MakeCamera(const Eigen::Matrix4d& camera_from_world,
                                  const Eigen::Matrix4d& clip_from_camera,
                                  const ClipConvention& clip,
                                  int width,
                                  int height) {
  const Eigen::Matrix4d& projection = clip_from_camera;
  Camera camera;
  camera.width = width;
  camera.height = height;
  if (!projection.allFinite()) {
    return absl::InvalidArgumentError("camera: the projection has values that are not finite");
  }
  const bool looks_orthographic = projection.row(3) == Eigen::RowVector4d::UnitW();
  // The sign of z in w tells which way a perspective camera looks. For an orthographic one the
  // depth row tells, as depth must grow away from the camera (or fall, when reversed).
  const double depth_sign = clip.depth == ClipConvention::Depth::kReversedZeroToOne ? -1.0 : 1.0;
  const double forward = looks_orthographic ? std::copysign(1.0, depth_sign * projection(2, 2))
                                            : std::copysign(1.0, projection(3, 2));
  if (!looks_orthographic &&
      (projection(3, 0) != 0.0 || projection(3, 1) != 0.0 || projection(3, 3) != 0.0 ||
       std::abs(std::abs(projection(3, 2)) - 1.0) > 1e-6)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("camera: the projection's last row = (%g, %g, %g, %g), want (0, 0, -1, 0) "
                        "or (0, 0, 1, 0) for perspective, (0, 0, 0, 1) for orthographic; is it "
                        "meant for row vectors? Then transpose it",
                        projection(3, 0),
                        projection(3, 1),
                        projection(3, 2),
                        projection(3, 3)));
  }
  camera.orthographic = looks_orthographic;
  const double w_scale = looks_orthographic ? 1.0 : std::abs(projection(3, 2));

  // Our camera space has z forward; only the sign of z changes.
  const Eigen::Vector4d flip(1.0, 1.0, forward, 1.0);
  camera.camera_from_world = flip.asDiagonal() * camera_from_world;
  const Eigen::Matrix4d clip_from_forward = projection * flip.asDiagonal() / w_scale;

  Eigen::Matrix3d clip_intrinsics = Eigen::Matrix3d::Identity();
  const Eigen::Index offset_column = looks_orthographic ? 3 : 2;
  clip_intrinsics.topLeftCorner<2, 2>() = clip_from_forward.topLeftCorner<2, 2>();
  clip_intrinsics.topRightCorner<2, 1>() = clip_from_forward.block<2, 1>(0, offset_column);
  // Images have their first row at the top whatever texture rows do, so y points up in clip space
  // for OpenGL and Direct3D, and down for Vulkan.
  const bool clip_y_points_up = clip.y_up || clip.depth == ClipConvention::Depth::kMinusOneToOne;
  const double y_sign = clip_y_points_up ? -1.0 : 1.0;
  Eigen::Matrix3d screen_from_clip;
  screen_from_clip << 0.5 * width, 0.0, 0.5 * width,  //
      0.0, 0.5 * y_sign * height, 0.5 * height,       //
      0.0, 0.0, 1.0;
  camera.screen_from_camera = screen_from_clip * clip_intrinsics;

  // Depth row: ndc = a + b / z (perspective) or ndc = a z + b (orthographic).
  const double a = clip_from_forward(2, 2);
  const double b = clip_from_forward(2, 3);
  double ndc_near = 0.0, ndc_far = 1.0;
  if (clip.depth == ClipConvention::Depth::kMinusOneToOne) ndc_near = -1.0;
  if (clip.depth == ClipConvention::Depth::kReversedZeroToOne) std::swap(ndc_near, ndc_far);
  if (looks_orthographic) {
    camera.near = (ndc_near - b) / a;
    camera.far = (ndc_far - b) / a;
  } else {
    camera.near = b / (ndc_near - a);
    camera.far = ndc_far == a ? std::numeric_limits<double>::infinity() : b / (ndc_far - a);
  }
  if (absl::Status status = ValidateCamera(camera); !status.ok()) return status;
  return camera;
}

absl::StatusOr<Camera> LookAtCamera(const Eigen::Vector3d& eye,
                                    const Eigen::Vector3d& target,
                                    const Eigen::Vector3d& up,
                                    double vertical_fov_rad,
                                    int width,
                                    int height) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  if (!forward.allFinite() || !right.allFinite() || right.norm() < 0.5) {
    return absl::InvalidArgumentError(
        "camera: eye and target coincide, or up is parallel to the view: want three independent "
        "directions");
  }
  if (!(vertical_fov_rad > 0.0) || !(vertical_fov_rad < M_PI)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "camera: vertical field of view = %g rad, want more than 0 and less than pi",
        vertical_fov_rad));
  }
  Camera camera;
  camera.width = width;
  camera.height = height;
  Eigen::Matrix3d axes;  // x right, y down, z forward
  axes.row(0) = right;
  axes.row(1) = forward.cross(right);
  axes.row(2) = forward;
  camera.camera_from_world.topLeftCorner<3, 3>() = axes;
  camera.camera_from_world.topRightCorner<3, 1>() = -axes * eye;
  const double focal_pixels = 0.5 * height / std::tan(0.5 * vertical_fov_rad);
  camera.screen_from_camera << focal_pixels, 0.0, 0.5 * width,  //
      0.0, focal_pixels, 0.5 * height,                          //
      0.0, 0.0, 1.0;
  if (absl::Status status = ValidateCamera(camera); !status.ok()) return status;
  return camera;
}

}  // namespace lightfit
