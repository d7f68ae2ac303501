#include "cli/flags/scene_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "base/suggest.h"
#include "cli/flags/fit_flags.h"
#include "cli/flags/fit_inputs.h"
#include "cli/flags/size_flags.h"
#include "geometry/resized_camera.h"
#include "geometry/sized_camera.h"
#include "io/camera_file.h"
#include "render/random_suns.h"
#include "scenes/gltf_view.h"
#include "scenes/scene_file.h"

namespace lightfit::cli {
namespace {

constexpr int kMaxRandomLights = 100'000;
constexpr char kGenerate[] = "generate";

std::string PointText(const Eigen::Vector3d& point) {
  return absl::StrFormat("(%g, %g, %g)", point.x(), point.y(), point.z());
}

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
  app->add_option("--frame", flags->frame, "Which frame of the --camera scene file, from 0 [0]")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber)
      ->group(group);
}

absl::StatusOr<Camera> CameraFromFile(const SceneFlags& flags,
                                      const std::string& path,
                                      int width,
                                      int height) {
  constexpr double kAspectTolerance = 0.01;  // sizes are rounded to pixels
  absl::StatusOr<StatedCamera> file = ReadCameraFile(path, flags.frame);
  if (!file.ok()) return file.status();
  const absl::StatusOr<Camera> sized = SizedCamera(file->camera, width, height);
  if (!sized.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", sized.status().message()));
  }
  const Camera& camera = *sized;
  const double scale_x = static_cast<double>(width) / camera.width;
  const double scale_y = static_cast<double>(height) / camera.height;
  if (!(std::abs(scale_x / scale_y - 1.0) <= kAspectTolerance)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "--camera %s: its image is %dx%d, %dx%d is asked for: want the same ratio of width to "
        "height, such as %dx%d",
        path,
        camera.width,
        camera.height,
        width,
        height,
        width,
        std::max(1, static_cast<int>(std::lround(scale_x * camera.height)))));
  }
  return ResizedCamera(camera, width, height);
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

absl::StatusOr<LoadedScene> LoadScene(const SceneFlags& flags) {
  Scene scene;
  int64_t num_dropped = 0;
  if (flags.generator.has_value()) {
    absl::StatusOr<Scene> generated = GenerateScene(*flags.generator);
    if (!generated.ok()) return generated.status();
    scene = *std::move(generated);
  } else {
    absl::StatusOr<SceneFile> file = ReadScene(flags.scene);
    if (!file.ok()) return file.status();
    scene = std::move(file->scene);
    num_dropped = file->num_dropped;
  }
  absl::StatusOr<RayCaster> caster = RayCaster::Build(std::move(scene));
  if (!caster.ok()) return caster.status();
  num_dropped += caster->num_dropped_triangles();
  const std::string title = flags.generator.has_value()
                                ? flags.scene
                                : std::filesystem::path(flags.scene).filename().string();
  return LoadedScene{*std::move(caster), title, num_dropped};
}

std::string CameraPath(const SceneFlags& flags) {
  const bool is_of_scene =
      flags.camera.empty() && IsGltf(flags.scene) && !ContentsOf(flags.scene).cameras.empty();
  return is_of_scene ? flags.scene : flags.camera;
}

bool TakesLightsOfScene(const SceneFlags& flags) {
  return flags.lights.path.empty() && flags.lights.extra.empty() && flags.num_random_lights == 0 &&
         IsGltf(flags.scene) && ContentsOf(flags.scene).num_lights > 0;
}

absl::StatusOr<Camera> MakeViewCamera(const SceneFlags& flags, int width, int height) {
  const std::string path = CameraPath(flags);
  if (path.empty()) {
    return absl::InvalidArgumentError(
        "no camera: want --camera EYE:TARGET such as --camera 0,1.7,18:0,0.5,0, or --camera FILE");
  }
  if (!flags.view.has_value()) return CameraFromFile(flags, path, width, height);
  const ViewFlags& view = *flags.view;
  const Eigen::Vector3d forward = view.target - view.eye;
  if (!(forward.norm() > 0.0)) {
    return absl::InvalidArgumentError(absl::StrCat("--camera ",
                                                   flags.camera,
                                                   ": eye and target are both ",
                                                   PointText(view.eye),
                                                   ", want two points"));
  }
  constexpr double kLeastSine = 1e-6;
  const Eigen::Vector3d up = flags.up.stableNormalized();
  if (!(forward.stableNormalized().cross(up).norm() > kLeastSine)) {
    return absl::InvalidArgumentError(absl::StrCat("--up = ",
                                                   PointText(flags.up),
                                                   " is zero or along the view from ",
                                                   PointText(view.eye),
                                                   " to ",
                                                   PointText(view.target),
                                                   ", want another direction, such as --up ",
                                                   std::abs(up.z()) < 0.5 ? "0,0,1" : "1,0,0"));
  }
  return LookAtCamera(view.eye, view.target, up, view.fov_deg * M_PI / 180.0, width, height);
}

absl::StatusOr<std::vector<Light>> SceneLights(const SceneFlags& flags) {
  LightFlags given = flags.lights;
  if (TakesLightsOfScene(flags)) given.path = flags.scene;
  absl::StatusOr<std::vector<Light>> lights = ReadLights(given);
  if (!lights.ok()) return lights.status();
  if (flags.num_random_lights > 0) {
    if (!(flags.up.norm() > 0.0)) {
      return absl::InvalidArgumentError("--up = (0, 0, 0), want a direction for --random-lights");
    }
    std::set<std::string> names;
    for (const Light& light : *lights) names.insert(light.name);
    for (Light& light : RandomSuns(flags.num_random_lights, flags.seed, flags.up)) {
      if (names.count(light.name) > 0) {
        return absl::InvalidArgumentError(
            absl::StrFormat("light \"%s\": is given and among the %d of --random-lights, want "
                            "another name for the given one",
                            light.name,
                            flags.num_random_lights));
      }
      light.shadow_bit = static_cast<int>(lights->size() % kMaxLights);
      lights->push_back(std::move(light));
    }
  }
  if (lights->empty()) {
    return absl::InvalidArgumentError(
        "no lights: want --lights FILE, --light NAME=sun:X,Y,Z or --random-lights COUNT");
  }
  return ChooseLights(*lights, flags.only);
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
