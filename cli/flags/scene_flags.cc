#include "cli/flags/scene_flags.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/suggest.h"
#include "cli/flags/fit_flags.h"
#include "cli/flags/frame_flag.h"
#include "cli/flags/size_flags.h"
#include "scenes/gltf_view.h"

namespace lightfit::cli {
namespace {

constexpr int kMaxRandomLights = 100'000;
constexpr char kGenerate[] = "generate";

absl::StatusOr<Eigen::Vector3d> ParseVector(const std::string& text) {
  const std::vector<std::string> numbers = absl::StrSplit(text, ',');
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  bool good = numbers.size() == 3;
  for (size_t i = 0; good && i < 3; ++i) good = absl::SimpleAtod(numbers[i], &vector[i]);
  if (good && vector.allFinite()) return vector;
  return absl::InvalidArgumentError(
      absl::StrCat("\"", text, "\" is no point or direction, want three numbers X,Y,Z"));
}

bool IsGenerator(const std::string& text) {
  return text == kGenerate || absl::StartsWith(text, absl::StrCat(kGenerate, ":"));
}

// A file of that name is a file, whatever else the name could mean.
bool IsView(const std::string& text) {
  std::error_code error;
  return absl::StrContains(text, ',') && !IsGltf(text) && !std::filesystem::exists(text, error);
}

template <typename Parse, typename Target>
void ParseInto(const char* flag, const std::string& text, const Parse& parse, Target* target) {
  auto value = parse(text);
  if (!value.ok()) throw CLI::ValidationError(flag, std::string(value.status().message()));
  *target = *std::move(value);
}

void DeclareCamera(CLI::App* app, SceneFlags* flags) {
  const std::string group = "Camera";
  app->add_option_function<std::string>(
         "--camera",
         [flags](const std::string& text) {
           flags->camera = text;
           flags->view.reset();
           if (IsView(text)) ParseInto("--camera", text, ParseView, &flags->view);
         },
         "Where the eye is, what it looks at and the vertical field of view in degrees [60]; or "
         "a JSON file with the camera, a scene file with its frames, or a glTF file, as "
         "scene.glb:NAME for one of several cameras [that of SCENE, if it is a glTF file with one]")
      ->type_name("X,Y,Z:X,Y,Z[:DEG]|FILE")
      ->group(group);
  app->add_option_function<std::string>(
         "--up",
         [flags](const std::string& text) { ParseInto("--up", text, ParseVector, &flags->up); },
         "Which way is up, for --camera and --random-lights [0,1,0]")
      ->type_name("X,Y,Z")
      ->group(group);
  DeclareFrameFlag(app,
                   group,
                   "Which frame of the --camera scene file, by its number, or where it has none "
                   "counted from 0 [the first]",
                   &flags->frame);
}

}  // namespace

void DeclareSceneFlags(CLI::App* app, SceneFlags* flags, const std::string& type_name) {
  app->add_option_function<std::string>(
         "scene",
         [flags](const std::string& text) {
           flags->scene = text;
           flags->generator.reset();
           if (IsGenerator(text)) ParseInto("SCENE", text, ParseGenerator, &flags->generator);
         },
         "A .glb, .gltf, .obj or .ply file; or \"generate\" for objects on a floor, as in "
         "generate:seed=1,objects=40,triangles=1100000,floor=20, or for a furnished room with "
         "windows, as in generate:kind=room,seed=5,triangles=150000")
      ->required()
      ->type_name(type_name);
  DeclareCamera(app, flags);
  const std::string group = "Lights";
  DeclareLightFlags(app, &flags->lights, group);
  DeclareOnlyFlag(app, group, &flags->only);
  app->add_option("--random-lights",
                  flags->num_random_lights,
                  "As many suns sun001 ..., uniform on the hemisphere around --up")
      ->type_name("COUNT")
      ->check(CLI::Range(1, kMaxRandomLights))
      ->group(group);
  app->add_option("--seed", flags->seed, "Of the random lights [1]")->type_name("N")->group(group);
}

absl::StatusOr<SceneGeneratorOptions> ParseGenerator(const std::string& text) {
  SceneGeneratorOptions options;
  if (text == kGenerate) return options;
  const std::vector<std::string> names = {"kind", "seed", "objects", "triangles", "floor"};
  std::string of_floor;                                         // a setting that a room has not
  const std::string settings = text.substr(sizeof(kGenerate));  // after the colon
  for (const absl::string_view setting : absl::StrSplit(settings, ',')) {
    const std::pair<std::string, std::string> pair =
        absl::StrSplit(setting, absl::MaxSplits('=', 1));
    const auto& [name, value] = pair;
    bool good = true;
    if (name == "objects" || name == "floor") of_floor = name;
    if (name == "kind") {
      if (value != "floor" && value != "room") {
        return absl::InvalidArgumentError(
            absl::StrCat("\"", text, "\": kind = \"", value, "\", want floor or room"));
      }
      options.kind = value == "room" ? SceneKind::kRoom : SceneKind::kFloor;
    } else if (name == "seed") {
      good = absl::SimpleAtoi(value, &options.seed);
    } else if (name == "objects") {
      good = absl::SimpleAtoi(value, &options.num_objects);
    } else if (name == "triangles") {
      good = absl::SimpleAtoi(value, &options.num_triangles);
    } else if (name == "floor") {
      good = absl::SimpleAtod(value, &options.floor_half_size);
    } else {
      return absl::InvalidArgumentError(
          absl::StrCat("\"",
                       text,
                       "\": there is no setting \"",
                       name,
                       "\", want some of kind=floor|room,seed=N,objects=N,triangles=N,"
                       "floor=HALF_SIZE",
                       DidYouMean(name, names)));
    }
    if (!good) {
      return absl::InvalidArgumentError(
          absl::StrCat("\"", text, "\": ", name, " = \"", value, "\" is not such a number"));
    }
  }
  if (options.kind == SceneKind::kRoom && !of_floor.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "\"", text, "\": a room has no setting \"", of_floor, "\", want seed and triangles"));
  }
  return options;
}

absl::StatusOr<PixelSize> ParsePixelSize(const std::string& text) {
  constexpr int64_t kMaxPixels = int64_t{1} << 25;  // 2.4 GB while rendering
  const std::optional<std::pair<int, int>> sides = ParseSides(text);
  if (!sides.has_value() || sides->first < 1 || sides->second < 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", text, "\" is no size, want WIDTHxHEIGHT in pixels such as 180x180"));
  }
  const PixelSize size = {sides->first, sides->second};
  if (int64_t{size.width} * size.height > kMaxPixels) {
    return absl::InvalidArgumentError(
        absl::StrCat(text, ": want at most ", kMaxPixels, " pixels, such as 8192x4096"));
  }
  return size;
}

absl::StatusOr<ViewFlags> ParseView(const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, ':');
  const auto refuse = [&text](absl::string_view what) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"",
                     text,
                     "\": ",
                     what,
                     ", want EYE:TARGET or EYE:TARGET:FOV_DEG such as "
                     "0,1.7,18:0,0.5,0:60, or a file"));
  };
  if (parts.size() < 2 || parts.size() > 3) {
    return refuse(absl::StrCat("has ", parts.size(), " parts between colons"));
  }
  ViewFlags view;
  const absl::StatusOr<Eigen::Vector3d> eye = ParseVector(parts[0]);
  if (!eye.ok()) return refuse(eye.status().message());
  view.eye = *eye;
  const absl::StatusOr<Eigen::Vector3d> target = ParseVector(parts[1]);
  if (!target.ok()) return refuse(target.status().message());
  view.target = *target;
  if (parts.size() == 3 && (!absl::SimpleAtod(parts[2], &view.fov_deg) ||
                            !(view.fov_deg >= 0.01 && view.fov_deg <= 179.0))) {
    return refuse(absl::StrCat("field of view = \"", parts[2], "\", want 0.01 to 179 degrees"));
  }
  return view;
}

}  // namespace lightfit::cli
