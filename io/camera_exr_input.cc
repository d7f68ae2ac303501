#include "io/camera_exr_input.h"

#include <limits>
#include <optional>
#include <string>
#include <utility>
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

// Whether WriteReadbackExr() wrote them, so that they are known to be as the standard has them.
bool IsOurs(const internal::ExrInput& exr, int part) {
  return exr.MatrixAttribute(part, internal::ExactName("worldToNDC")).has_value();
}

struct Matrices {
  int part = 0;
  Eigen::Matrix4d world_to_camera, world_to_ndc;
};

std::optional<Matrices> MatricesOf(const internal::ExrInput& exr, int part) {
  const std::optional<Eigen::Matrix4d> world_to_camera = MatrixOf(exr, part, "worldToCamera");
  const std::optional<Eigen::Matrix4d> world_to_ndc = MatrixOf(exr, part, "worldToNDC");
  if (!world_to_camera || !world_to_ndc) return std::nullopt;
  return Matrices{part, *world_to_camera, *world_to_ndc};
}

// The view of the camera in the part's header; empty: of no view in particular.
absl::string_view ViewOfCamera(const internal::ExrInput& exr, int part) {
  const std::vector<std::string>& views = exr.part_views(part);
  return views.empty() ? absl::string_view() : views.front();
}

// The camera of the parts beside that of the read-back.
absl::StatusOr<std::optional<Matrices>> MatricesOfOthers(const internal::ExrInput& exr,
                                                         int part,
                                                         absl::string_view view) {
  std::optional<Matrices> found;
  for (int i = 0; i < exr.num_parts(); ++i) {
    if (i == part || (!view.empty() && ViewOfCamera(exr, i) != view)) continue;
    const std::optional<Matrices> matrices = MatricesOf(exr, i);
    if (!matrices) continue;
    if (!found) found = matrices;
    if (found->world_to_camera != matrices->world_to_camera ||
        found->world_to_ndc != matrices->world_to_ndc) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s: %s has no worldToCamera and worldToNDC, and those of %s and %s differ: want them in "
          "the part of the depth, or give the camera as a file, --camera",
          exr.path(),
          exr.quoted_part(part),
          exr.quoted_part(found->part),
          exr.quoted_part(i)));
    }
  }
  return found;
}

}  // namespace

std::string internal::ExactName(const std::string& attribute) {
  return absl::StrCat("lightfit.", attribute);
}

absl::StatusOr<internal::CameraOfPart> internal::CameraFromExr(const ExrInput& exr,
                                                               int part,
                                                               absl::string_view view,
                                                               const CameraExrOptions& options) {
  std::optional<Matrices> matrices = MatricesOf(exr, part);
  const absl::string_view own_view = ViewOfCamera(exr, part);
  if (matrices && !view.empty() && !own_view.empty() && own_view != view) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: worldToCamera and worldToNDC are those of the view %s, and the depth is of %s: give "
        "the camera as a file, --camera",
        exr.path(),
        QuotedList({std::string(own_view)}),
        QuotedList({std::string(view)})));
  }
  if (!matrices) {
    absl::StatusOr<std::optional<Matrices>> others = MatricesOfOthers(exr, part, view);
    if (!others.ok()) return others.status();
    matrices = *std::move(others);
  }
  if (!matrices) {
    return absl::NotFoundError(absl::StrFormat(
        "%s: has no worldToCamera and worldToNDC attributes%s (matrices in its header: %s): let "
        "the "
        "renderer write them, or give the camera as a file, --camera",
        exr.path(),
        view.empty() ? "" : absl::StrCat(" of the view ", QuotedList({std::string(view)})),
        QuotedList(exr.MatrixNames(part))));
  }
  CameraExrOptions file_options = options;
  if (options.pixel_aspect == 0.0) file_options.pixel_aspect = exr.pixel_aspect(matrices->part);
  const bool is_ours = IsOurs(exr, matrices->part);
  if (is_ours) {
    file_options.convention.frame_centre = CameraConvention::FrameCentre::kAnywhere;
  }
  absl::StatusOr<Camera> camera = CameraFromExrMatrices(matrices->world_to_camera,
                                                        matrices->world_to_ndc,
                                                        exr.width(part),
                                                        exr.height(part),
                                                        file_options);
  if (camera.ok()) return CameraOfPart{*std::move(camera), matrices->part, is_ours};
  return absl::Status(camera.status().code(),
                      absl::StrCat(exr.path(), ": ", camera.status().message()));
}

absl::StatusOr<Camera> ReadCameraExr(const std::string& path, const CameraExrOptions& options) {
  // Only the header is read, so the number of pixels does not matter.
  const absl::StatusOr<internal::ExrInput> exr =
      internal::ExrInput::Open(path, std::numeric_limits<int64_t>::max());
  if (!exr.ok()) return exr.status();
  absl::StatusOr<internal::CameraOfPart> found = internal::CameraFromExr(*exr, 0, "", options);
  if (!found.ok()) return found.status();
  return std::move(found->camera);
}

}  // namespace lightfit
