#include "cli/summary_list.h"

#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/flags/frame_inputs.h"
#include "io/summary_file.h"
#include "jobs/frames/frame_pattern.h"
#include "jobs/shot/frames.h"

namespace lightfit::cli {
namespace {

// The files that one word of the command line stands for.
absl::StatusOr<std::vector<std::string>> FilesOf(const std::string& input) {
  std::vector<std::string> paths;
  if (IsFilePattern(input)) {
    const absl::StatusOr<std::vector<MatchedFile>> files = FilesMatching(input);
    if (!files.ok()) return files.status();
    paths.reserve(files->size());
    for (const MatchedFile& file : *files) paths.push_back(file.path);
    return paths;
  }
  std::error_code error;
  const std::string extension =
      absl::AsciiStrToLower(std::filesystem::path(input).extension().string());
  if (!std::filesystem::is_directory(input, error) && extension != ".txt") return {{input}};
  const absl::StatusOr<FrameList> list = ListFrames({input});
  if (!list.ok()) return list.status();
  paths.reserve(list->frames.size());
  for (const ShotFrame& frame : list->frames) paths.push_back(frame.path);
  return paths;
}

absl::Status CheckOutput(const std::vector<SummaryInput>& inputs, const std::string& output_path) {
  for (const SummaryInput& input : inputs) {
    std::error_code error;
    if (!std::filesystem::equivalent(input.path, output_path, error)) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("-o ",
                     output_path,
                     ": is among the inputs, and its frames would count again each time; leave it "
                     "out of them, or write the sum to a folder of its own"));
  }
  return absl::OkStatus();
}

// Of the read-backs, which are not in the order of the inputs.
absl::Status SetFrames(const FrameList& list,
                       const FitFlags& flags,
                       std::vector<SummaryInput>* inputs) {
  const absl::StatusOr<FrameInputs> of_frames = FrameInputs::ForShot(flags, list);
  if (!of_frames.ok()) return of_frames.status();
  std::map<std::string, const ShotFrame*> by_path;
  for (const ShotFrame& frame : list.frames) by_path[frame.path] = &frame;
  std::optional<FrameLights> still;  // the same in every frame
  for (SummaryInput& input : *inputs) {
    if (input.is_summary()) continue;
    const auto found = by_path.find(input.path);
    if (found == by_path.end()) continue;
    const FrameNumber number = found->second->number;
    absl::StatusOr<FrameLights> lights =
        still.has_value() ? *still : of_frames->LightsOf(input.path, number);
    if (!lights.ok()) return lights.status();
    if (!of_frames->HasMovingLights()) still = *lights;
    FrameToSum& frame = *input.frame;
    frame.lights = std::move(lights->lights);
    frame.absent_lights = std::move(lights->absent);
    frame.exr = of_frames->ReadingOf(input.path, number);
    frame.number = list.is_numbered ? number : NumberOfFile(input.path);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<SummaryInput>> ListSummaryInputs(const std::vector<std::string>& words,
                                                            const std::string& output_path,
                                                            const FitFlags& flags) {
  std::vector<SummaryInput> inputs;
  std::vector<std::string> readbacks;
  for (const std::string& word : words) {
    const absl::StatusOr<std::vector<std::string>> paths = FilesOf(word);
    if (!paths.ok()) return paths.status();
    for (const std::string& path : *paths) {
      SummaryInput& input = inputs.emplace_back();
      input.path = path;
      if (IsSummaryFile(path)) continue;
      input.frame.emplace();
      input.frame->path = path;
      readbacks.push_back(path);
    }
  }
  if (absl::Status status = CheckOutput(inputs, output_path); !status.ok()) return status;
  if (readbacks.empty()) return inputs;
  const absl::StatusOr<FrameList> list = ListFrames(readbacks);
  if (!list.ok()) return list.status();
  if (absl::Status status = SetFrames(*list, flags, &inputs); !status.ok()) return status;
  // What is missing here may be in a summary.
  if (!list->missing.empty() && readbacks.size() == inputs.size()) {
    PrintWarning(absl::StrCat(list->missing,
                              ": a map that is fitted to this is not made for what is missing"));
  }
  return inputs;
}

}  // namespace lightfit::cli
