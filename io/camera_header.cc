#include "io/camera_header.h"

#include <OpenEXR/ImfMatrixAttribute.h>

#include <Eigen/Core>
#include <cmath>
#include <string>

#include "absl/strings/str_format.h"
#include "io/camera_exr_input.h"

namespace lightfit::internal {
namespace {

// The standard's camera space has x right and y up in the image, whatever ours has.
struct StandardMatrices {
  Eigen::Matrix4d camera_from_world, ndc_from_world;
  double pixel_aspect = 1.0;
};

StandardMatrices StandardMatricesOf(const Camera& camera) {
  const Eigen::Matrix3d& k = camera.screen_from_camera;
  Eigen::Matrix4d standard_from_camera = Eigen::Matrix4d::Identity();
  if (k(0, 0) < 0.0) standard_from_camera(0, 0) = -1.0;
  if (k(1, 1) > 0.0) standard_from_camera(1, 1) = -1.0;
  // Row 3 is not part of the 2D NDC; any that grows with depth and can be inverted will do.
  Eigen::Matrix4d ndc_from_camera = Eigen::Matrix4d::Zero();
  const int w_column = camera.orthographic ? 3 : 2;
  for (int row = 0; row < 2; ++row) {
    const double size = row == 0 ? camera.width : camera.height;
    ndc_from_camera(row, row) = k(row, row) * standard_from_camera(row, row) / size;
    ndc_from_camera(row, w_column) = k(row, 2) / size;
  }
  ndc_from_camera(2, 2) = 1.0;
  if (!camera.orthographic) ndc_from_camera(2, 3) = -1.0;
  ndc_from_camera(3, w_column) = 1.0;
  StandardMatrices matrices;
  matrices.camera_from_world = standard_from_camera * camera.camera_from_world;
  matrices.ndc_from_world = ndc_from_camera * matrices.camera_from_world;
  matrices.pixel_aspect = std::abs(k(1, 1) / k(0, 0));
  return matrices;
}

// Row vectors, in single and in double precision.
void AddMatrix(const std::string& name, const Eigen::Matrix4d& matrix, Imf::Header* header) {
  Imath::M44d rows;
  for (int i = 0; i < 16; ++i) rows[i / 4][i % 4] = matrix(i % 4, i / 4);
  header->insert(name, Imf::M44fAttribute(Imath::M44f(rows)));
  header->insert(ExactName(name), Imf::M44dAttribute(rows));
}

}  // namespace

absl::Status CheckCameraAttributes(const Camera& camera) {
  const Eigen::Matrix3d& k = camera.screen_from_camera;
  if (k(0, 1) == 0.0 && k(1, 0) == 0.0) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "camera: screen_from_camera has skew (%g, %g), want 0: worldToNDC cannot express it",
      k(0, 1),
      k(1, 0)));
}

Imf::Header CameraHeader(const Camera& camera) {
  const StandardMatrices matrices = StandardMatricesOf(camera);
  Imf::Header header(camera.width, camera.height, static_cast<float>(matrices.pixel_aspect));
  header.compression() = Imf::ZIP_COMPRESSION;
  AddMatrix("worldToCamera", matrices.camera_from_world, &header);
  AddMatrix("worldToNDC", matrices.ndc_from_world, &header);
  return header;
}

}  // namespace lightfit::internal
