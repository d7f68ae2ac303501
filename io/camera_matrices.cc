#include "io/camera_matrices.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_format.h"

namespace lightfit {

namespace {

using Convention = CameraConvention;

// The attributes are single precision and products of several matrices.
constexpr double kMatrixTolerance = 1e-4;

// How far the axes of a rigid matrix may be from orthonormal.
constexpr double kRigidTolerance = 1e-3;

// Renderers round the frame's aspect to pixels and the pixel aspect to a few digits.
constexpr double kPixelAspectTolerance = 0.01;

// Width or height of the frame at distance 1. Beyond these the field of view is under 0.006 or over
// 179.8 degrees: no lens, but some other matrix.
constexpr double kMinFrameExtent = 1e-4;
constexpr double kMaxFrameExtent = 1e3;

absl::Status Refuse(const std::string& message) { return absl::InvalidArgumentError(message); }

std::string RowText(const Eigen::RowVector4d& row) {
  return absl::StrFormat("(%g, %g, %g, %g)", row(0), row(1), row(2), row(3));
}

// worldToCamera, column vectors, checked to be rigid; its last row is exact on return.
absl::Status CheckPose(Convention::Layout layout, Eigen::Matrix4d& camera_from_world) {
  const Eigen::RowVector4d last = camera_from_world.row(3);
  if ((last - Eigen::RowVector4d::UnitW()).cwiseAbs().maxCoeff() > kMatrixTolerance) {
    return Refuse(absl::StrFormat(
        "worldToCamera: last %s = %s, want (0, 0, 0, 1)",
        layout == Convention::Layout::kRowVectors ? "column (row vectors)" : "row (column vectors)",
        RowText(last)));
  }
  const Eigen::Matrix3d axes = camera_from_world.topLeftCorner<3, 3>();
  const Eigen::Matrix3d gram = axes * axes.transpose();
  if ((gram - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kRigidTolerance) {
    return Refuse(
        absl::StrFormat("worldToCamera: is not rigid, its axes have the lengths %g, %g, "
                        "%g: want a rotation or mirror without scale",
                        axes.row(0).norm(),
                        axes.row(1).norm(),
                        axes.row(2).norm()));
  }
  camera_from_world.row(3) = Eigen::RowVector4d::UnitW();
  return absl::OkStatus();
}

// NDC of camera-space points, z forward: w is 1 (orthographic) or z (perspective) and
// ndc = (scale_x X, scale_y Y) / w + centre.
struct Projection {
  bool orthographic = false;
  double scale_x = 0, scale_y = 0;
  double centre_x = 0, centre_y = 0;
};

// Takes ndc_from_camera apart; fails unless it is a projection of the stated kind.
absl::StatusOr<Projection> TakeApart(const Eigen::Matrix4d& ndc_from_camera,
                                     double distance_to_origin,
                                     double forward,
                                     Convention::NdcW ndc_w) {
  const Eigen::Matrix4d& p = ndc_from_camera;
  const double linear_scale = std::max(std::abs(p(0, 0)), std::abs(p(1, 1)));
  const double tolerance = kMatrixTolerance * linear_scale;
  Projection projection;
  projection.orthographic = std::abs(p(3, 2)) <= tolerance;
  const int w_column = projection.orthographic ? 3 : 2;
  const int other_column = projection.orthographic ? 2 : 3;
  // Translations lose digits with the camera's distance from the origin of the world.
  const double offset_tolerance =
      kMatrixTolerance * std::max(linear_scale, std::abs(p(3, 2))) * (1.0 + distance_to_origin);
  const double other_tolerance = projection.orthographic ? tolerance : offset_tolerance;

  const double w = p(3, w_column) * (projection.orthographic ? 1.0 : forward);
  if (!(linear_scale > 0.0) || w == 0.0 || std::abs(p(3, 0)) > tolerance ||
      std::abs(p(3, 1)) > tolerance || std::abs(p(3, other_column)) > other_tolerance) {
    return Refuse(
        absl::StrFormat("worldToNDC does not belong to worldToCamera: its w is %s times the "
                        "camera-space point, want z alone (perspective) or 1 (orthographic)",
                        RowText(p.row(3))));
  }
  if ((w > 0.0) != (ndc_w == Convention::NdcW::kPositive)) {
    return Refuse(absl::StrFormat("worldToNDC: w is %s in front of the camera, want it %s",
                                  w > 0.0 ? "positive" : "negative",
                                  w > 0.0 ? "negative" : "positive"));
  }
  if (std::abs(p(0, 1)) > tolerance || std::abs(p(1, 0)) > tolerance ||
      std::abs(p(0, other_column)) > other_tolerance ||
      std::abs(p(1, other_column)) > other_tolerance) {
    return Refuse(
        absl::StrFormat("worldToNDC does not belong to worldToCamera: NDC x and y are %s and %s "
                        "times the camera-space point, want them along the camera's own axes",
                        RowText(p.row(0)),
                        RowText(p.row(1))));
  }
  if (projection.orthographic && p(2, 2) * forward < 0.0) {
    return Refuse("worldToNDC: depth falls in front of the camera, want it to grow");
  }
  const double column_sign = projection.orthographic ? 1.0 : forward;
  projection.scale_x = p(0, 0) / std::abs(w);
  projection.scale_y = p(1, 1) / std::abs(w);
  projection.centre_x = p(0, w_column) * column_sign / std::abs(w);
  projection.centre_y = p(1, w_column) * column_sign / std::abs(w);
  return projection;
}

// Brings the projection to the standard: the frame is (0, 0) ... (1, 1), y down, so scale_y < 0.
absl::Status Standardize(const Convention& convention, int width, int height, Projection& p) {
  if (p.scale_x < 0.0) return Refuse("worldToNDC: x falls to the right of the camera");
  if ((p.scale_y < 0.0) != (convention.ndc_y == Convention::NdcY::kDown)) {
    return Refuse(absl::StrFormat("worldToNDC: y %s towards the camera's top",
                                  p.scale_y < 0.0 ? "falls" : "grows"));
  }
  if (convention.ndc_range == Convention::NdcRange::kMinusOneToOne) {
    p = {p.orthographic,
         p.scale_x / 2.0,
         p.scale_y / 2.0,
         (p.centre_x + 1.0) / 2.0,
         (p.centre_y + 1.0) / 2.0};
  }
  if (convention.ndc_y == Convention::NdcY::kUp) {
    p.scale_y = -p.scale_y;
    p.centre_y = 1.0 - p.centre_y;
  }
  if (convention.ndc_span == Convention::NdcSpan::kShorterSide) {
    const double x_share = std::min(1.0, static_cast<double>(height) / width);
    const double y_share = std::min(1.0, static_cast<double>(width) / height);
    p.scale_x *= x_share;
    p.scale_y *= y_share;
    p.centre_x = 0.5 + (p.centre_x - 0.5) * x_share;
    p.centre_y = 0.5 + (p.centre_y - 0.5) * y_share;
  }
  return absl::OkStatus();
}

absl::Status CheckPlausible(const Projection& p,
                            int width,
                            int height,
                            const CameraExrOptions& options) {
  const double largest = std::max(1.0 / p.scale_x, -1.0 / p.scale_y);
  const double smallest = std::min(1.0 / p.scale_x, -1.0 / p.scale_y);
  if (!p.orthographic && !(smallest >= kMinFrameExtent && largest <= kMaxFrameExtent)) {
    return Refuse(
        absl::StrFormat("worldToNDC: the frame is %g by %g at distance 1, which is no lens",
                        1.0 / p.scale_x,
                        -1.0 / p.scale_y));
  }
  const double wanted = options.pixel_aspect > 0.0 ? options.pixel_aspect : 1.0;
  const double pixel_aspect = (-p.scale_y * height) / (p.scale_x * width);
  if (!(std::abs(pixel_aspect / wanted - 1.0) <= kPixelAspectTolerance)) {
    return Refuse(absl::StrFormat(
        "worldToNDC: a pixel of the %dx%d frame is %.4g times as wide as high, the file says %g: "
        "if the renderer means it, state --pixel-aspect %.4g",
        width,
        height,
        pixel_aspect,
        wanted,
        pixel_aspect));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Camera> internal::CameraUnderConvention(const Eigen::Matrix4d& world_to_camera,
                                                       const Eigen::Matrix4d& world_to_ndc,
                                                       int width,
                                                       int height,
                                                       const CameraExrOptions& options) {
  const Convention& convention = options.convention;
  const bool rows = convention.layout == Convention::Layout::kRowVectors;
  Eigen::Matrix4d camera_from_world = world_to_camera;
  Eigen::Matrix4d ndc_from_world = world_to_ndc;
  if (rows) {
    camera_from_world.transposeInPlace();
    ndc_from_world.transposeInPlace();
  }
  if (absl::Status status = CheckPose(convention.layout, camera_from_world); !status.ok()) {
    return status;
  }
  const double forward = convention.view_axis == Convention::ViewAxis::kPlusZ ? 1.0 : -1.0;
  absl::StatusOr<Projection> projection = TakeApart(ndc_from_world * camera_from_world.inverse(),
                                                    camera_from_world.col(3).head<3>().norm(),
                                                    forward,
                                                    convention.ndc_w);
  if (!projection.ok()) return projection.status();
  if (absl::Status status = Standardize(convention, width, height, *projection); !status.ok()) {
    return status;
  }
  if (absl::Status status = CheckPlausible(*projection, width, height, options); !status.ok()) {
    return status;
  }
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.orthographic = projection->orthographic;
  camera.camera_from_world =
      Eigen::Vector4d(1.0, 1.0, forward, 1.0).asDiagonal() * camera_from_world;
  camera.screen_from_camera << projection->scale_x * width, 0.0, projection->centre_x * width,  //
      0.0, projection->scale_y * height, projection->centre_y * height,                         //
      0.0, 0.0, 1.0;
  camera.near = options.near;
  camera.far = options.far;
  if (absl::Status status = ValidateCamera(camera); !status.ok()) return status;
  return camera;
}

}  // namespace lightfit
