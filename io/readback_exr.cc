#include "io/readback_exr.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "geometry/affine_depth.h"
#include "geometry/sized_camera.h"
#include "io/camera_exr_input.h"
#include "io/exr/channels.h"
#include "io/exr/depth.h"
#include "io/exr/input.h"
#include "io/header_lights.h"
#include "io/light_channels.h"
#include "wire/utf8.h"

namespace lightfit {

using internal::ExrChannels;
using internal::ExrInput;
using internal::OpenReadback;

namespace {

// What Cycles writes where nothing was hit; beyond kBackgroundDepth, and finite.
constexpr float kNothingHit = 1e10F;

float BackgroundDepth(DepthKind kind) {
  switch (kind) {
    case DepthKind::kCameraZ:
    case DepthKind::kDistance:
      return kNothingHit;
    case DepthKind::kNdcZeroToOne:
    case DepthKind::kNdcMinusOneToOne:
      return 1.0F;
    case DepthKind::kNdcReversedZeroToOne:
      return 0.0F;
  }
  return kNothingHit;
}

absl::Status CheckShadowBits(absl::Span<const Light> lights) {
  uint32_t taken = 0;
  for (const Light& light : lights) {
    if (light.shadow_bit < 0 || light.shadow_bit >= kMaxLights ||
        (taken >> light.shadow_bit & 1U) != 0) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "light \"%s\": shadow_bit = %d, want 0 ... %d and a different one for every light",
          Utf8Text(light.name),
          light.shadow_bit,
          kMaxLights - 1));
    }
    taken |= 1U << light.shadow_bit;
  }
  return absl::OkStatus();
}

void Append(std::vector<ReadbackWarning> more, std::vector<ReadbackWarning>* warnings) {
  for (ReadbackWarning& warning : more) warnings->push_back(std::move(warning));
}

// What the header says of the lights.
void CheckHeaderLights(const ExrInput& exr,
                       int part,
                       absl::Span<const Light> lights,
                       ReadbackFile& file) {
  const absl::StatusOr<std::optional<std::vector<Light>>> of_header =
      internal::LightsFromHeader(exr, part);
  if (!of_header.ok()) {
    file.warnings.push_back(
        {"header",
         absl::StrCat("the lights in its header cannot be read and are not compared: ",
                      of_header.status().message())});
  } else if (of_header->has_value()) {
    Append(LightWarnings(lights, **of_header, file.camera), &file.warnings);
  }
}

// What the pixels say of depth and shadows.
void CheckPixels(absl::Span<const Light> lights, ReadbackFile& file) {
  std::vector<Light> usable;
  for (size_t l = 0; l < lights.size(); ++l) {
    if (file.light_status[l].ok() && ValidateLight(lights[l]).ok()) usable.push_back(lights[l]);
  }
  Readback readback = file.View();
  if (!ValidateReadback(readback).ok()) return;
  Append(PixelWarnings(usable, WarningWords::kCommandLine, &readback), &file.warnings);
  file.background = readback.background;
}

// Finds the camera and says where.
absl::Status SetCamera(const OpenReadback& open,
                       const ReadbackExrOptions& options,
                       ReadbackFile& file) {
  const ExrInput& exr = open.exr;
  const int part = open.depth.part;
  file.depth_kind = options.depth_kind;
  if (options.camera.has_value()) {
    absl::StatusOr<Camera> sized = SizedCamera(*options.camera, exr.width(part), exr.height(part));
    if (!sized.ok()) return sized.status();
    file.camera = *std::move(sized);
    if (file.camera.width != exr.width(part) || file.camera.height != exr.height(part)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("camera: size = %dx%d, but the display window of %s is %dx%d: want the "
                          "camera of this image",
                          file.camera.width,
                          file.camera.height,
                          exr.path(),
                          exr.width(part),
                          exr.height(part)));
    }
    // What the file says of it, where that can be understood.
    const absl::StatusOr<internal::CameraOfPart> own =
        internal::CameraFromExr(exr, part, open.view, options.camera_exr);
    if (own.ok()) Append(CameraWarnings(file.camera, own->camera), &file.warnings);
  } else {
    absl::StatusOr<internal::CameraOfPart> found =
        internal::CameraFromExr(exr, part, open.view, options.camera_exr);
    if (!found.ok()) return found.status();
    file.camera = std::move(found->camera);
    if (!found->is_exact &&
        options.camera_exr.convention.frame_centre == CameraConvention::FrameCentre::kNearMiddle) {
      Append(ShiftWarnings(file.camera), &file.warnings);
    }
    if (exr.num_parts() > 1) file.origin.camera_part = exr.part_name(found->part);
  }
  absl::Status status = ValidateCamera(file.camera, file.depth_kind);
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(exr.path(), ": ", status.message()));
}

}  // namespace

Readback ReadbackFile::View() const {
  Readback readback;
  readback.camera = camera;
  readback.depth = depth;
  readback.depth_kind = depth_kind;
  readback.background = background;
  readback.shadow_bits = shadow_bits;
  readback.facing_bits = facing_bits;
  readback.facing_lights = facing_lights;
  readback.mapped_bits = mapped_bits;
  readback.mapped_lights = mapped_lights;
  return readback;
}

absl::StatusOr<ReadbackFile> ReadReadbackExr(const std::string& path,
                                             absl::Span<const Light> lights,
                                             const ReadbackExrOptions& options) {
  if (absl::Status status = CheckShadowBits(lights); !status.ok()) return status;
  const absl::StatusOr<internal::NameFormats> formats = internal::ParseNameFormats(options);
  if (!formats.ok()) return formats.status();
  absl::StatusOr<ExrInput> exr = ExrInput::Open(path, options.max_pixels);
  if (!exr.ok()) return exr.status();
  const ExrChannels channels(*exr);
  const absl::StatusOr<internal::DepthChoice> choice =
      internal::ChooseDepth(channels, options.depth_channel, options.view);
  if (!choice.ok()) return choice.status();
  const OpenReadback open = {*exr, channels, choice->id, choice->view};

  ReadbackFile file;
  file.origin.depth_channel = exr->name(open.depth);
  if (exr->num_parts() > 1) file.origin.depth_part = exr->part_name(open.depth.part);
  file.origin.view = open.view;
  file.background = options.background;
  if (absl::Status status = SetCamera(open, options, file); !status.ok()) return status;

  absl::StatusOr<std::vector<float>> depth =
      exr->ReadFloat(open.depth, BackgroundDepth(options.depth_kind));
  if (!depth.ok()) return depth.status();
  file.depth = *std::move(depth);
  if (absl::Status status = internal::ReadBits(open, lights, *formats, options, file);
      !status.ok()) {
    return status;
  }
  CheckHeaderLights(*exr, open.depth.part, lights, file);
  CheckPixels(lights, file);
  return file;
}

absl::StatusOr<std::vector<std::string>> ListShadowLights(const std::string& path,
                                                          const ReadbackExrOptions& options) {
  const absl::StatusOr<internal::NameFormats> formats = internal::ParseNameFormats(options);
  if (!formats.ok()) return formats.status();
  const absl::StatusOr<ExrInput> exr = ExrInput::Open(path, options.max_pixels);
  if (!exr.ok()) return exr.status();
  return internal::LightsInFile(ExrChannels(*exr), formats->shadow);
}

}  // namespace lightfit
