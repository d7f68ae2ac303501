#include "io/fine_cover_exr.h"

#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "geometry/sized_camera.h"
#include "io/camera_exr_input.h"
#include "io/exr/channels.h"
#include "io/exr/depth.h"
#include "io/exr/input.h"

namespace lightfit {

namespace {

// Whether two cameras of the same size send the same points to the same pixels, but for what
// single-precision attributes lose.
bool SeeTheSame(const Camera& a, const Camera& b) {
  constexpr double kPixels = 0.25;
  const Eigen::Matrix4d b_from_a = b.ScreenFromWorld() * a.WorldFromScreen();
  const double depth = a.orthographic ? 1.0 : 0.1;  // affine: any one in view
  for (const double x : {0.0, static_cast<double>(a.width)}) {
    for (const double y : {0.0, static_cast<double>(a.height)}) {
      const Eigen::Vector4d there = b_from_a * Eigen::Vector4d(x, y, depth, 1.0);
      const Eigen::Vector2d pixel = there.head<2>() / there.w();
      if (!((pixel - Eigen::Vector2d(x, y)).norm() <= kPixels)) return false;
    }
  }
  return true;
}

}  // namespace

FineCover FineCoverFile::View() const {
  FineCover view;
  view.columns = columns;
  view.rows = rows;
  view.nearest = depth;
  view.shadow_bits = shadow_bits;
  view.lit_bits = lit_bits;
  view.lit_lights = lit_lights;
  return view;
}

absl::StatusOr<FineCoverFile> ReadFineCoverExr(const std::string& path,
                                               absl::Span<const Light> lights,
                                               const ReadbackExrOptions& options,
                                               const ReadbackFile& readback) {
  const absl::StatusOr<internal::ExrInput> exr = internal::ExrInput::Open(path, options.max_pixels);
  if (!exr.ok()) return exr.status();
  const absl::StatusOr<internal::DepthChoice> depth =
      internal::ChooseDepth(internal::ExrChannels(*exr), options.depth_channel, options.view);
  if (!depth.ok()) return depth.status();
  const int part = depth->id.part;
  const int width = exr->width(part), height = exr->height(part);
  if (width <= readback.camera.width || height <= readback.camera.height) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: %d x %d pixels, want more than the read-back's %d x %d: it is there for what lies "
        "between its pixels",
        path,
        width,
        height,
        readback.camera.width,
        readback.camera.height));
  }
  ReadbackExrOptions of_fine = options;
  of_fine.camera = ResizedCamera(readback.camera, width, height);
  of_fine.depth_kind = readback.depth_kind;
  if (readback.background.has_value() && std::isfinite(*readback.background)) {
    of_fine.background = readback.background;
  }
  const absl::StatusOr<internal::CameraOfPart> own =
      internal::CameraFromExr(*exr, part, depth->view, options.camera_exr);
  if (!options.camera.has_value() && own.ok() && !SeeTheSame(*of_fine.camera, own->camera)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "%s: its camera sees another view than the read-back's: want the same frame, only larger",
        path));
  }
  absl::StatusOr<ReadbackFile> file = ReadReadbackExr(path, lights, of_fine);
  if (!file.ok()) return file.status();
  FineCoverFile fine;
  fine.columns = width;
  fine.rows = height;
  fine.depth = std::move(file->depth);
  // It may have a background where the read-back shows none.
  if (file->background.has_value() && !IsNdc(file->depth_kind)) {
    constexpr float kNothingHit = 1e10F;
    for (float& depth : fine.depth) {
      if (depth >= *file->background) depth = kNothingHit;
    }
  }
  fine.shadow_bits = std::move(file->shadow_bits);
  fine.lit_lights = file->facing_lights;
  if (!file->facing_bits.empty()) {
    for (size_t i = 0; i < fine.shadow_bits.size(); ++i) {
      const uint32_t facing = file->facing_bits[i] & file->facing_lights;
      fine.lit_bits.push_back(facing & ~fine.shadow_bits[i]);
      fine.shadow_bits[i] &= facing | ~file->facing_lights;
    }
  }
  return fine;
}

}  // namespace lightfit
