#include "cli/flags/fit_inputs.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/suggest.h"
#include "io/camera_file.h"
#include "optimizer/readback/readback.h"

namespace lightfit::cli {
namespace {

// The depth kind may be the camera file's.
absl::StatusOr<ReadbackExrOptions> WithBackgroundChecked(const ReadbackExrOptions& options) {
  if (!options.background.has_value() || !IsNdc(options.depth_kind)) return options;
  return absl::InvalidArgumentError(
      absl::StrCat("--background: is for depths that are distances, and these are ",
                   DepthKindName(options.depth_kind),
                   ", whose background is the far plane: leave it out"));
}

}  // namespace

absl::StatusOr<std::vector<Light>> ChooseLights(const std::vector<Light>& lights,
                                                const std::vector<std::string>& only) {
  if (only.empty()) return lights;
  std::vector<std::string> names;
  names.reserve(lights.size());
  for (const Light& light : lights) names.push_back(light.name);
  for (const std::string& name : only) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      return absl::InvalidArgumentError(absl::StrCat("--only ",
                                                     name,
                                                     ": there is no such light, want one of ",
                                                     absl::StrJoin(names, ", "),
                                                     DidYouMean(name, names)));
    }
  }
  std::vector<Light> chosen;
  for (const Light& light : lights) {
    if (std::find(only.begin(), only.end(), light.name) != only.end()) chosen.push_back(light);
  }
  return chosen;
}

absl::StatusOr<std::vector<Light>> ReadFitLights(const FitFlags& flags) {
  const absl::StatusOr<std::vector<Light>> lights = ReadLights(flags.lights);
  if (!lights.ok()) return lights.status();
  if (lights->empty()) {
    return absl::InvalidArgumentError(
        "no lights: want --lights FILE, or --light NAME=sun:X,Y,Z for one light");
  }
  return ChooseLights(*lights, flags.only);
}

absl::StatusOr<ReadbackExrOptions> ReadbackOptionsOf(const FitFlags& flags) {
  ReadbackExrOptions options;
  options.depth_kind = flags.depth_kind.value_or(DepthKind::kCameraZ);
  options.background = flags.background;
  options.depth_channel = flags.depth_channel;
  options.view = flags.view;
  if (!flags.shadow_channel_format.empty()) {
    options.shadow_channel_format = flags.shadow_channel_format;
  }
  options.shadow_bits_channel = flags.shadow_bits_channel;
  if (!flags.facing_channel_format.empty()) {
    options.facing_channel_format = flags.facing_channel_format;
  }
  if (!flags.mapped_channel_format.empty()) {
    options.mapped_channel_format = flags.mapped_channel_format;
  }
  options.camera_exr = flags.camera_exr;
  if (flags.camera_path.empty()) return WithBackgroundChecked(options);
  absl::StatusOr<StatedCamera> file = ReadCameraFile(flags.camera_path, flags.frame);
  if (!file.ok()) return file.status();
  if (!flags.depth_kind.has_value() && file->depth_kind.has_value()) {
    options.depth_kind = *file->depth_kind;
  }
  options.camera = file->camera;
  return WithBackgroundChecked(options);
}

Readback FitInputs::View() const {
  Readback view = file.View();
  if (fine_cover_file.has_value()) view.fine_cover = &fine_cover;
  return view;
}

absl::StatusOr<FitInputs> ReadFitInputs(const FitFlags& flags) {
  FitInputs inputs;
  absl::StatusOr<std::vector<Light>> lights = ReadFitLights(flags);
  if (!lights.ok()) return lights.status();
  inputs.lights = *std::move(lights);
  const absl::StatusOr<ReadbackExrOptions> options = ReadbackOptionsOf(flags);
  if (!options.ok()) return options.status();
  absl::StatusOr<ReadbackFile> file = ReadReadbackExr(flags.readback_path, inputs.lights, *options);
  if (!file.ok()) return file.status();
  inputs.file = *std::move(file);
  inputs.notes.Add(0, flags.readback_path, inputs.file);
  if (!flags.cover_readback_path.empty()) {
    absl::StatusOr<FineCoverFile> fine =
        ReadFineCoverExr(flags.cover_readback_path, inputs.lights, *options, inputs.file);
    if (!fine.ok()) return fine.status();
    inputs.fine_cover_file = *std::move(fine);
    inputs.fine_cover = inputs.fine_cover_file->View();
  }
  absl::Status status = ValidateReadback(inputs.View());
  if (!status.ok()) return status;
  return inputs;
}

}  // namespace lightfit::cli
