#include "cli/flags/fit_inputs.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/suggest.h"
#include "cli/flags/frame_inputs.h"
#include "jobs/shot/judge.h"
#include "optimizer/readback/readback.h"

namespace lightfit::cli {

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

ReadbackExrOptions ReadbackOptionsOf(const FitFlags& flags) {
  ReadbackExrOptions options;
  options.depth_kind = flags.depth_kind.value_or(DepthKind::kCameraZ);
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
  return options;
}

Readback FitInputs::View() const {
  Readback view = file.View();
  if (fine_cover_file.has_value()) view.fine_cover = &fine_cover;
  return view;
}

absl::StatusOr<FitInputs> ReadFitInputs(const FitFlags& flags) {
  FitInputs inputs;
  const std::string& path = flags.readback_path;
  const absl::StatusOr<FrameInputs> frame = FrameInputs::ForFile(flags, path);
  if (!frame.ok()) return frame.status();
  absl::StatusOr<FrameLights> lights = frame->LightsOf(path, frame->number());
  if (!lights.ok()) return lights.status();
  inputs.lights = std::move(lights->lights);
  const absl::StatusOr<ReadbackExrOptions> options = frame->ReadingOf(path, frame->number());
  if (!options.ok()) return options.status();
  absl::StatusOr<ReadbackFile> file = ReadReadbackExr(path, inputs.lights, *options);
  if (!file.ok()) return file.status();
  inputs.file = *std::move(file);
  SetAbsent(lights->absent, frame->number(), inputs.lights, &inputs.file);
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
