#include "cli/flags/frame_inputs.h"

#include <google/protobuf/struct.pb.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/text_file.h"
#include "cli/flags/fit_inputs.h"
#include "io/frames/exr_frame.h"
#include "io/header_lights.h"
#include "jobs/shot/judge.h"
#include "wire/proto_json.h"

namespace lightfit::cli {
namespace {

using google::protobuf::Struct;

// Where the number alone chooses, a header that says another one is not passed over.
absl::Status CheckHeader(const EntryChooser& chooser,
                         const std::string& table,
                         const std::string& path,
                         FrameNumber number) {
  if (!chooser.GoesByNumber()) return absl::OkStatus();
  const std::optional<FrameNumber> header = FrameOfExr(path);
  if (!header.has_value() || *header == number) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "%s: is frame %s by its name and frame %s by its header, so which entry of %s belongs to it "
      "cannot be known; --frame N says which is that of the first read-back",
      path,
      number.Text(),
      header->Text(),
      table));
}

struct LightsOfEntry {
  std::vector<ListedLight> lights;  // as many in the same order in all
  std::vector<std::string> absent;  // names of those that the entry does not place
};

absl::StatusOr<LightsOfEntry> ListEntry(const FitFlags& flags,
                                        const LightFrames& frames,
                                        size_t entry) {
  absl::StatusOr<LightFrames::Frame> frame = frames.FrameOf(entry);
  if (!frame.ok()) return InFile(flags.lights.path, frame.status());
  FitFlags own = flags;
  own.lights.json = std::move(frame->json);
  absl::StatusOr<std::vector<ListedLight>> lights = ListFitLights(own);
  if (!lights.ok()) return lights.status();
  LightsOfEntry result;
  result.lights = *std::move(lights);
  for (std::string& name : frame->absent) {
    const bool is_given = std::any_of(flags.lights.extra.begin(),
                                      flags.lights.extra.end(),
                                      [&name](const Light& light) { return light.name == name; });
    if (!is_given) result.absent.push_back(std::move(name));
  }
  return result;
}

// The depth kind may be the camera file's.
absl::StatusOr<ReadbackExrOptions> WithBackgroundChecked(ReadbackExrOptions options) {
  if (!options.background.has_value() || !IsNdc(options.depth_kind)) return options;
  return absl::InvalidArgumentError(
      absl::StrCat("--background: is for depths that are distances, and these are ",
                   DepthKindName(options.depth_kind),
                   ", whose background is the far plane: leave it out"));
}

// Then those of the read-backs' headers are taken, where these have any.
bool NoneAreGiven(const LightFlags& lights) { return lights.path.empty() && lights.extra.empty(); }

// "frames" of a lights file for the headers of a shot. A file that cannot be read says so later.
absl::StatusOr<std::optional<LightFrames>> LightsOfHeaders(const FrameList& list) {
  Struct file;
  auto* frames = (*file.mutable_fields())["frames"].mutable_struct_value()->mutable_fields();
  bool has_any = false;
  for (const ShotFrame& frame : list.frames) {
    Struct* entry = (*frames)[frame.number.Text()].mutable_struct_value();
    (*entry->mutable_fields())["lights"].mutable_list_value();
    const absl::StatusOr<std::optional<std::vector<Light>>> lights = LightsFromHeader(frame.path);
    if (!lights.ok() || !lights->has_value()) continue;
    const absl::StatusOr<std::string> json = LightsForHeader(**lights);
    if (!json.ok() || !JsonToProto(*json, *entry).ok()) continue;
    has_any = true;
  }
  if (!has_any) return std::optional<LightFrames>();
  return LightFrames::Of(file);
}

}  // namespace

absl::StatusOr<FrameInputs> FrameInputs::Read(const FitFlags& flags, const ShotNumbers& shot) {
  FrameInputs inputs(flags, shot);
  if (!flags.camera_path.empty()) {
    absl::StatusOr<CameraFile> file = ReadCameras(flags.camera_path);
    if (!file.ok()) return file.status();
    inputs.camera_file_ = *std::move(file);
    const bool is_stated = shot.stated.value_or(FrameNumber{}) != FrameNumber{};
    if (!inputs.camera_file_->IsForAll() || is_stated) {
      absl::StatusOr<EntryChooser> chooser =
          EntryChooser::Make(inputs.camera_file_->numbers, shot, "cameras");
      if (!chooser.ok()) return InFile(flags.camera_path, chooser.status());
      inputs.cameras_ = *std::move(chooser);
    }
  }
  if (!flags.lights.path.empty() && flags.lights.json.empty()) {
    absl::StatusOr<std::optional<LightFrames>> frames = LightFrames::Read(flags.lights.path);
    if (!frames.ok()) return frames.status();
    inputs.light_frames_ = *std::move(frames);
  }
  if (inputs.light_frames_.has_value()) {
    absl::StatusOr<EntryChooser> chooser =
        EntryChooser::Make(inputs.light_frames_->numbers(), shot, "lights");
    if (!chooser.ok()) return InFile(flags.lights.path, chooser.status());
    inputs.lights_ = *std::move(chooser);
  }
  return inputs;
}

absl::StatusOr<FrameInputs> FrameInputs::ForFile(const FitFlags& flags, const std::string& path) {
  ShotNumbers shot;
  const std::optional<FrameNumber> number = NumberOfFile(path);
  shot.stated = flags.frame;
  shot.are_known = number.has_value() || flags.frame.has_value();
  shot.first = shot.last = number.value_or(FrameNumber{});
  if (!NoneAreGiven(flags.lights)) return Read(flags, shot);
  const absl::StatusOr<std::optional<std::vector<Light>>> lights = LightsFromHeader(path);
  if (!lights.ok()) return lights.status();
  if (!lights->has_value()) return Read(flags, shot);
  FitFlags own = flags;
  absl::StatusOr<std::string> json = LightsForHeader(**lights);
  if (!json.ok()) return InFile(path, json.status());
  own.lights.path = path;
  own.lights.json = *std::move(json);
  return Read(own, shot);
}

absl::StatusOr<FrameInputs> FrameInputs::ForShot(const FitFlags& flags, const FrameList& list) {
  ShotNumbers shot;
  shot.stated = flags.frame;
  shot.are_known = list.is_numbered || (list.frames.size() == 1 && flags.frame.has_value());
  shot.first = list.frames.front().number;
  shot.last = list.frames.back().number;
  absl::StatusOr<FrameInputs> inputs = Read(flags, shot);
  if (!inputs.ok() || !NoneAreGiven(flags.lights)) return inputs;
  absl::StatusOr<std::optional<LightFrames>> lights = LightsOfHeaders(list);
  if (!lights.ok()) return lights.status();
  if (!lights->has_value()) return inputs;
  // Each frame's own: neither --frame nor what else its header says can be about another.
  ShotNumbers own = shot;
  own.stated.reset();
  own.are_known = true;
  absl::StatusOr<EntryChooser> chooser = EntryChooser::Make((*lights)->numbers(), own, "lights");
  if (!chooser.ok()) return chooser.status();
  inputs->flags_.lights.path = "lightfit.lights of the read-backs";  // for messages
  inputs->light_frames_ = *std::move(lights);
  inputs->lights_ = *std::move(chooser);
  inputs->lights_are_of_headers_ = true;
  return inputs;
}

absl::StatusOr<ReadbackExrOptions> FrameInputs::ReadingOf(const std::string& path,
                                                          FrameNumber number) const {
  ReadbackExrOptions options = ReadbackOptionsOf(flags_);
  if (!camera_file_.has_value()) return WithBackgroundChecked(std::move(options));
  size_t entry = 0;
  if (cameras_.has_value()) {
    absl::Status status = CheckHeader(*cameras_, flags_.camera_path, path, number);
    if (!status.ok()) return status;
    const absl::StatusOr<size_t> found = cameras_->EntryOf(number);
    if (!found.ok()) return InFile(flags_.camera_path, found.status());
    entry = *found;
  }
  const absl::StatusOr<StatedCamera>& camera = camera_file_->cameras[entry];
  if (!camera.ok()) return InFile(flags_.camera_path, camera.status());
  if (!flags_.depth_kind.has_value() && camera->depth_kind.has_value()) {
    options.depth_kind = *camera->depth_kind;
  }
  options.camera = camera->camera;
  return WithBackgroundChecked(std::move(options));
}

absl::StatusOr<size_t> FrameInputs::LightsEntryOf(const std::string& path,
                                                  FrameNumber number) const {
  if (!lights_are_of_headers_) {
    absl::Status status = CheckHeader(*lights_, flags_.lights.path, path, number);
    if (!status.ok()) return status;
  }
  absl::StatusOr<size_t> entry = lights_->EntryOf(number);
  if (!entry.ok()) return InFile(flags_.lights.path, entry.status());
  return entry;
}

absl::StatusOr<std::vector<ListedLight>> FrameInputs::ListLightsOf(const std::string& path,
                                                                   FrameNumber number) const {
  if (!light_frames_.has_value()) return ListFitLights(flags_);
  const absl::StatusOr<size_t> entry = LightsEntryOf(path, number);
  if (!entry.ok()) return entry.status();
  absl::StatusOr<LightsOfEntry> own = ListEntry(flags_, *light_frames_, *entry);
  if (!own.ok()) return own.status();
  for (ListedLight& listed : own->lights) {
    const std::vector<std::string>& absent = own->absent;
    if (listed.status.ok() &&
        std::find(absent.begin(), absent.end(), listed.light.name) != absent.end()) {
      listed.status = AbsentError(listed.light.name, number);
    }
  }
  return std::move(own->lights);
}

absl::StatusOr<FrameLights> FrameInputs::LightsOf(const std::string& path,
                                                  FrameNumber number) const {
  FrameLights result;
  if (!light_frames_.has_value()) {
    absl::StatusOr<std::vector<Light>> lights = ReadFitLights(flags_);
    if (!lights.ok()) return lights.status();
    result.lights = *std::move(lights);
    return result;
  }
  const absl::StatusOr<size_t> entry = LightsEntryOf(path, number);
  if (!entry.ok()) return entry.status();
  const absl::StatusOr<LightsOfEntry> any = ListEntry(flags_, *light_frames_, 0);
  if (!any.ok()) return any.status();
  absl::StatusOr<LightsOfEntry> own = ListEntry(flags_, *light_frames_, *entry);
  if (!own.ok()) return own.status();
  for (size_t i = 0; i < own->lights.size(); ++i) {
    // What is a light in one frame and none in another would change the numbers of those behind it.
    if (own->lights[i].status.ok() != any->lights[i].status.ok()) {
      const ListedLight& bad = own->lights[i].status.ok() ? any->lights[i] : own->lights[i];
      return InFile(flags_.lights.path, bad.status);
    }
  }
  absl::StatusOr<std::vector<Light>> usable = UsableLights(std::move(own->lights));
  if (!usable.ok()) return usable.status();
  result.lights = *std::move(usable);
  for (std::string& name : own->absent) {
    const auto is_named = [&name](const Light& light) { return light.name == name; };
    if (std::any_of(result.lights.begin(), result.lights.end(), is_named)) {
      result.absent.push_back(std::move(name));
    }
  }
  return result;
}

absl::StatusOr<std::vector<ListedLight>> ListFrameLights(const FitFlags& flags) {
  const absl::StatusOr<FrameInputs> frame = FrameInputs::ForFile(flags, flags.readback_path);
  if (!frame.ok()) return frame.status();
  return frame->ListLightsOf(flags.readback_path, frame->number());
}

absl::StatusOr<std::vector<ListedLight>> ListLightsOfAnyFrame(const FitFlags& flags) {
  if (flags.lights.path.empty()) return ListFitLights(flags);
  const absl::StatusOr<std::optional<LightFrames>> frames = LightFrames::Read(flags.lights.path);
  if (!frames.ok()) return frames.status();
  if (!frames->has_value()) return ListFitLights(flags);
  absl::StatusOr<LightsOfEntry> any = ListEntry(flags, **frames, 0);
  if (!any.ok()) return any.status();
  return std::move(any->lights);
}

}  // namespace lightfit::cli
