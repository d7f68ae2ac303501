#include "bench/inputs.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "tests/testing/box_scene.h"

namespace lightfit {

namespace {

// Files or folders in `folder` whose path ends in `suffix`, sorted.
std::vector<std::filesystem::path> List(const std::string& folder, const std::string& suffix) {
  std::vector<std::filesystem::path> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (path.size() >= suffix.size() &&
        path.compare(path.size() - suffix.size(), suffix.size(), suffix) == 0) {
      paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::vector<std::filesystem::path> ListSets(const std::string& folder) {
  std::vector<std::filesystem::path> sets;
  for (const std::filesystem::path& path : List(folder, "")) {
    if (std::filesystem::exists(path / "scene.json")) sets.push_back(path);
  }
  return sets;
}

}  // namespace

Readback Input::View() const {
  Readback view = {camera, depth, depth_kind, shadow_bits};
  view.facing_bits = facing_bits;
  view.facing_lights = facing_lights;
  return view;
}

Input BoxInput(uint64_t seed, int width, int height, int num_lights) {
  const BoxScene scene = MakeBoxScene(seed);
  Input input;
  input.name = absl::StrCat("boxes/", seed);
  input.lights = RandomLights(scene, seed, num_lights);
  SyntheticReadback readback =
      Render(scene, RandomCamera(scene, seed, width, height), input.lights);
  input.camera = readback.camera;
  input.depth = std::move(readback.depth);
  input.shadow_bits = std::move(readback.shadow_bits);
  return input;
}

absl::StatusOr<Input> ReadInput(const std::string& set_folder, const std::string& frame) {
  const std::filesystem::path set = set_folder;
  absl::StatusOr<std::vector<Light>> lights = ReadLightsFile((set / "scene.json").string());
  if (!lights.ok()) return lights.status();
  absl::StatusOr<ReadbackFile> file =
      ReadReadbackExr((set / absl::StrCat(frame, ".exr")).string(), *lights);
  if (!file.ok()) return file.status();
  Input input;
  input.name = absl::StrCat(set.filename().string(), "/", frame);
  input.camera = file->camera;
  input.depth_kind = file->depth_kind;
  input.depth = std::move(file->depth);
  input.shadow_bits = std::move(file->shadow_bits);
  input.facing_bits = std::move(file->facing_bits);
  input.facing_lights = file->facing_lights;
  for (size_t i = 0; i < lights->size(); ++i) {
    if (file->light_status[i].ok()) input.lights.push_back((*lights)[i]);
  }
  return input;
}

std::string DefaultReadbackFolder() {
  return (std::filesystem::path(LIGHTFIT_REPOSITORY).parent_path() / "shared" / "readbacks")
      .string();
}

bool HasReadbacks(const std::string& folder) { return !ListSets(folder).empty(); }

absl::StatusOr<std::vector<Input>> ReadInputs(const std::string& folder, int frame_step) {
  std::vector<Input> inputs;
  for (const std::filesystem::path& set : ListSets(folder)) {
    const std::vector<std::filesystem::path> frames = List(set.string(), ".exr");
    for (size_t i = 0; i < frames.size(); i += frame_step) {
      absl::StatusOr<Input> input = ReadInput(set.string(), frames[i].stem().string());
      if (!input.ok()) return input.status();
      inputs.push_back(*std::move(input));
    }
  }
  return inputs;
}

}  // namespace lightfit
