#include "io/camera_exr_input.h"

#include <limits>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace lightfit {

namespace {

std::optional<Eigen::Matrix4d> MatrixOf(const internal::ExrInput& exr,
                                        int part,
                                        const std::string& name) {
  std::optional<Eigen::Matrix4d> matrix = exr.MatrixAttribute(part, name);
  std::optional<Eigen::Matrix4d> exact = exr.MatrixAttribute(part, internal::ExactName(name));
  if (matrix && exact && exact->cast<float>() == matrix->cast<float>()) return exact;
  return matrix;
}

}  // namespace

std::string internal::ExactName(const std::string& attribute) {
  return absl::StrCat("lightfit.", attribute);
}

absl::StatusOr<Camera> internal::CameraFromExr(const ExrInput& exr,
                                               int part,
                                               const CameraExrOptions& options) {
  std::vector<int> parts = {part};
  for (int i = 0; i < exr.num_parts(); ++i) parts.push_back(i);
  for (const int i : parts) {
    const std::optional<Eigen::Matrix4d> world_to_camera = MatrixOf(exr, i, "worldToCamera");
    const std::optional<Eigen::Matrix4d> world_to_ndc = MatrixOf(exr, i, "worldToNDC");
    if (!world_to_camera || !world_to_ndc) continue;
    CameraExrOptions file_options = options;
    if (options.pixel_aspect == 0.0) {
      file_options.pixel_aspect = exr.pixel_aspect(i);
    }
    absl::StatusOr<Camera> camera = CameraFromExrMatrices(
        *world_to_camera, *world_to_ndc, exr.width(part), exr.height(part), file_options);
    if (camera.ok()) return camera;
    return absl::Status(camera.status().code(),
                        absl::StrCat(exr.path(), ": ", camera.status().message()));
  }
  return absl::NotFoundError(
      absl::StrFormat("%s: has no worldToCamera and worldToNDC attributes (matrices in its header: "
                      "%s): let the renderer write them, or give the camera as a file",
                      exr.path(),
                      QuotedList(exr.MatrixNames(part))));
}

absl::StatusOr<Camera> ReadCameraExr(const std::string& path, const CameraExrOptions& options) {
  // Only the header is read, so the number of pixels does not matter.
  const absl::StatusOr<internal::ExrInput> exr =
      internal::ExrInput::Open(path, std::numeric_limits<int64_t>::max());
  if (!exr.ok()) return exr.status();
  return internal::CameraFromExr(*exr, 0, options);
}

}  // namespace lightfit
