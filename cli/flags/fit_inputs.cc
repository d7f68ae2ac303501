#include "cli/flags/fit_inputs.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/suggest.h"
#include "base/text_file.h"
#include "base/verbose.h"
#include "cli/flags/frame_inputs.h"
#include "cli/flags/standard_streams.h"
#include "optimizer/readback/readback.h"

namespace lightfit::cli {
namespace {

const std::string& NameOf(const Light& light) { return light.name; }
const std::string& NameOf(const ListedLight& listed) { return listed.light.name; }

template <typename AnyLight>
absl::StatusOr<std::vector<AnyLight>> Chosen(const std::vector<AnyLight>& lights,
                                             const std::vector<std::string>& only) {
  if (only.empty()) return lights;
  std::vector<std::string> names;
  names.reserve(lights.size());
  for (const AnyLight& light : lights) names.push_back(NameOf(light));
  for (const std::string& name : only) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      return absl::InvalidArgumentError(absl::StrCat("--only ",
                                                     name,
                                                     ": there is no such light, want one of ",
                                                     absl::StrJoin(names, ", "),
                                                     DidYouMean(name, names)));
    }
  }
  std::vector<AnyLight> chosen;
  for (const AnyLight& light : lights) {
    if (std::find(only.begin(), only.end(), NameOf(light)) != only.end()) chosen.push_back(light);
  }
  return chosen;
}

// With one channel for all shadows a light's bit is its number in the file, whatever is chosen.
bool HasBitsChannel(const FitFlags& flags) { return !flags.shadow_bits_channel.empty(); }

void RefuseBeyondBits(std::vector<ListedLight>* lights) {
  for (ListedLight& listed : *lights) {
    if (!listed.status.ok() || listed.light.shadow_bit < kMaxLights) continue;
    listed.status = absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": is number %d of the file, and a channel of all shadows has bits for the "
        "first %d; want a channel for each light, or a file that lists it earlier",
        listed.light.name,
        listed.light.shadow_bit + 1,
        kMaxLights));
  }
}

int NumUsable(const std::vector<ListedLight>& lights) {
  return static_cast<int>(std::count_if(
      lights.begin(), lights.end(), [](const ListedLight& listed) { return listed.status.ok(); }));
}

absl::Status TooManyChosenError(int count) {
  return absl::InvalidArgumentError(
      absl::StrFormat("lights: %d of them, want at most %d at once; choose some with --only NAME, "
                      "and the others in another run",
                      count,
                      kMaxLights));
}

}  // namespace

absl::StatusOr<std::vector<Light>> ChooseLights(const std::vector<Light>& lights,
                                                const std::vector<std::string>& only) {
  return Chosen(lights, only);
}

absl::StatusOr<std::vector<ListedLight>> ChooseLights(const std::vector<ListedLight>& lights,
                                                      const std::vector<std::string>& only) {
  return Chosen(lights, only);
}

absl::StatusOr<std::vector<ListedLight>> ListFitLights(const FitFlags& flags) {
  const absl::StatusOr<std::vector<ListedLight>> all = ListLights(flags.lights);
  if (!all.ok()) return all.status();
  if (all->empty()) {
    return absl::InvalidArgumentError(
        "no lights: want --lights FILE, or --light NAME=sun:X,Y,Z for one light; the header of the "
        "read-back has none either");
  }
  absl::StatusOr<std::vector<ListedLight>> lights = ChooseLights(*all, flags.only);
  if (!lights.ok()) return lights;
  if (HasBitsChannel(flags)) RefuseBeyondBits(&*lights);
  if (NumUsable(*lights) == 0) {
    const absl::Status& status = lights->front().status;
    return flags.lights.path.empty() ? status : InFile(flags.lights.path, status);
  }
  return lights;
}

std::vector<std::vector<ListedLight>> GroupsOfLights(std::vector<ListedLight> lights) {
  const bool has_room = std::all_of(lights.begin(), lights.end(), [](const ListedLight& listed) {
    return !listed.status.ok() || listed.light.shadow_bit < kMaxLights;
  });
  if (has_room) return {std::move(lights)};
  std::vector<std::vector<ListedLight>> groups(1);
  int num_usable = 0;
  for (ListedLight& listed : lights) {
    if (listed.status.ok()) {
      if (num_usable == kMaxLights) {
        groups.emplace_back();
        num_usable = 0;
      }
      listed.light.shadow_bit = num_usable++;
    }
    groups.back().push_back(std::move(listed));
  }
  return groups;
}

absl::StatusOr<std::vector<Light>> ReadFitLights(const FitFlags& flags) {
  absl::StatusOr<std::vector<ListedLight>> list = ListFitLights(flags);
  if (!list.ok()) return list.status();
  return UsableLights(*std::move(list));
}

absl::StatusOr<std::vector<Light>> UsableLights(std::vector<ListedLight> list) {
  const int num_usable = NumUsable(list);
  const std::vector<std::vector<ListedLight>> groups = GroupsOfLights(std::move(list));
  if (groups.size() > 1) return TooManyChosenError(num_usable);
  std::vector<Light> lights;
  for (const ListedLight& listed : groups.front()) {
    if (listed.status.ok()) lights.push_back(listed.light);
  }
  return lights;
}

ReadbackExrOptions ReadbackOptionsOf(const FitFlags& flags) {
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
  return options;
}

namespace {

void SayWhatIsRead(const FitFlags& flags, const FitInputs& inputs) {
  if (!IsVerbose()) return;
  const Camera& camera = inputs.file.camera;
  Say(absl::StrCat("read ",
                   WithStreamNames(flags.readback_path),
                   " (",
                   OriginText(inputs.file.origin),
                   "): ",
                   camera.width,
                   "x",
                   camera.height,
                   " pixels"));
  for (size_t i = 0; i < inputs.lights.size(); ++i) {
    const absl::Status& status = inputs.file.light_status[i];
    Say(absl::StrCat("light \"",
                     inputs.lights[i].name,
                     "\": ",
                     status.ok() ? "its shadows are there" : std::string(status.message())));
  }
}

}  // namespace

Readback FitInputs::View() const {
  Readback view = file.View();
  if (fine_cover_file.has_value()) view.fine_cover = &fine_cover;
  return view;
}

absl::StatusOr<FitInputs> ReadFitInputs(const FitFlags& flags) {
  absl::StatusOr<std::vector<ListedLight>> lights = ListFrameLights(flags);
  if (!lights.ok()) return lights.status();
  std::vector<std::vector<ListedLight>> groups = GroupsOfLights(*std::move(lights));
  if (groups.size() > 1) {
    int num_usable = 0;
    for (const std::vector<ListedLight>& group : groups) num_usable += NumUsable(group);
    return TooManyChosenError(num_usable);
  }
  return ReadFitInputs(flags, std::move(groups.front()));
}

absl::StatusOr<FitInputs> ReadFitInputs(const FitFlags& flags, std::vector<ListedLight> lights) {
  const std::string& path = flags.readback_path;
  const absl::StatusOr<FrameInputs> frame = FrameInputs::ForFile(flags, path);
  if (!frame.ok()) return frame.status();
  const absl::StatusOr<ReadbackExrOptions> options = frame->ReadingOf(path, frame->number());
  if (!options.ok()) return options.status();
  FitInputs inputs;
  std::vector<Light> usable;
  for (const ListedLight& listed : lights) {
    inputs.lights.push_back(listed.light);
    if (listed.status.ok()) usable.push_back(listed.light);
  }
  absl::StatusOr<ReadbackFile> file = ReadReadbackExr(path, usable, *options);
  if (!file.ok()) return file.status();
  inputs.file = *std::move(file);
  inputs.notes.Add(0, path, inputs.file);
  if (!flags.cover_readback_path.empty()) {
    absl::StatusOr<FineCoverFile> fine =
        ReadFineCoverExr(flags.cover_readback_path, usable, *options, inputs.file);
    if (!fine.ok()) return fine.status();
    inputs.fine_cover_file = *std::move(fine);
    inputs.fine_cover = inputs.fine_cover_file->View();
  }
  // From here on what was of no use before the file was read has its status among the others.
  const std::vector<absl::Status> of_usable = std::move(inputs.file.light_status);
  inputs.file.light_status.clear();
  for (size_t i = 0, next = 0; i < lights.size(); ++i) {
    inputs.file.light_status.push_back(lights[i].status.ok() ? of_usable[next++]
                                                             : lights[i].status);
  }
  SayWhatIsRead(flags, inputs);
  absl::Status status = ValidateReadback(inputs.View());
  if (!status.ok()) return status;
  return inputs;
}

}  // namespace lightfit::cli
