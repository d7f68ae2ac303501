#include "cli/flags/scene_inputs.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/flags/fit_inputs.h"
#include "geometry/sized_camera.h"
#include "io/camera_file.h"
#include "render/random_suns.h"
#include "scenes/gltf_view.h"
#include "scenes/scene_file.h"

namespace lightfit::cli {
namespace {

std::string PointText(const Eigen::Vector3d& point) {
  return absl::StrFormat("(%g, %g, %g)", point.x(), point.y(), point.z());
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

// Width by height of the image that the file's camera has; 0 when it says none, or cannot be read.
double RatioOfFile(const std::string& path, const std::optional<FrameNumber>& frame) {
  const absl::StatusOr<StatedCamera> file = ReadCameraFile(path, frame);
  if (!file.ok()) return 0.0;
  const Camera& camera = file->camera;
  return HasSize(camera) ? static_cast<double>(camera.width) / camera.height : FrameRatio(camera);
}

}  // namespace

absl::Status CheckSceneNeeds(const SceneFlags& flags, std::vector<std::string> missing) {
  const LightFlags& lights = flags.lights;
  if (lights.path.empty() && lights.extra.empty() && flags.num_random_lights == 0 &&
      !TakesLightsOfScene(flags)) {
    missing.insert(missing.begin(),
                   "no lights: want --lights FILE, --light NAME=sun:X,Y,Z or --random-lights "
                   "COUNT");
  }
  if (CameraPath(flags).empty()) {
    missing.insert(missing.begin(),
                   "no camera: want --camera EYE:TARGET such as --camera 0,1.7,18:0,0.5,0, or "
                   "--camera FILE");
  }
  if (missing.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrJoin(missing, "; "));
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

PixelSize DefaultImageSize(const SceneFlags& flags, int height) {
  constexpr double kMostWidth = 8192.0;
  const std::string path = CameraPath(flags);
  const double ratio =
      flags.view.has_value() || path.empty() ? 0.0 : RatioOfFile(path, flags.frame);
  if (!(ratio > 0.0)) return {height, height};
  return {static_cast<int>(std::clamp(std::round(height * ratio), 1.0, kMostWidth)), height};
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

}  // namespace lightfit::cli
