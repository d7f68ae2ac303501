#include "cli/compare_inputs.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/suggest.h"
#include "cli/flags/standard_streams.h"
#include "optimizer/tracking/keep_matrix.h"
#include "render/sight.h"

namespace lightfit::cli {
namespace {

absl::Status ReadSceneInputs(const CompareFlags& flags, CompareInputs* inputs) {
  if (absl::Status status = CheckSceneNeeds(flags.scene); !status.ok()) return status;
  absl::StatusOr<std::vector<Light>> lights = SceneLights(flags.scene);
  if (!lights.ok()) return lights.status();
  inputs->lights = *std::move(lights);
  inputs->light_status.resize(inputs->lights.size());
  const PixelSize screen =
      flags.screen.value_or(DefaultImageSize(flags.scene, kDefaultScreenHeight));
  const absl::StatusOr<Camera> camera = MakeViewCamera(flags.scene, screen.width, screen.height);
  if (!camera.ok()) return camera.status();
  absl::StatusOr<LoadedScene> scene = LoadScene(flags.scene);
  if (!scene.ok()) return scene.status();
  inputs->scene = std::make_unique<LoadedScene>(*std::move(scene));
  inputs->title = inputs->scene->title;
  if (inputs->scene->num_dropped > 0) {
    inputs->warnings.push_back(absl::StrFormat(
        "%d triangles without area or with bad coordinates ignored", inputs->scene->num_dropped));
  }
  const PixelSize readback = flags.readback.value_or(DefaultReadbackSize(screen));
  absl::StatusOr<CompareStage> stage =
      MakeStage(inputs->scene->caster, *camera, readback.width, readback.height);
  if (!stage.ok()) return stage.status();
  inputs->stage = *std::move(stage);
  const absl::StatusOr<std::string> sight = CheckSight(inputs->scene->caster, inputs->stage.screen);
  if (!sight.ok()) return sight.status();
  if (!sight->empty()) inputs->warnings.push_back(*sight);
  return absl::OkStatus();
}

FitFlags ReadbackFlags(const CompareFlags& flags) {
  FitFlags fit = flags.fit;
  fit.readback_path = flags.scene.scene;
  fit.lights = flags.scene.lights;
  fit.only = flags.scene.only;
  fit.camera_path = flags.scene.camera;
  fit.frame = flags.scene.frame;
  return fit;
}

absl::Status ReadReadbackInputs(const CompareFlags& flags, CompareInputs* inputs) {
  if (flags.scene.num_random_lights > 0) {
    return absl::InvalidArgumentError(
        "--random-lights: a read-back holds the shadows of its own lights only, want --lights FILE "
        "or --light NAME=sun:X,Y,Z; or compare on a scene");
  }
  if (flags.scene.view.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--camera ",
                     flags.scene.camera,
                     ": a read-back has a camera of its own; leave it out, or give a file"));
  }
  if (!flags.picture_path.empty()) {
    return absl::InvalidArgumentError(
        "--picture: a read-back has no true shadows to draw; compare on a scene, or draw "
        "footprints with lightfit fit --picture");
  }
  absl::StatusOr<FitInputs> readback = ReadFitInputs(ReadbackFlags(flags));
  if (!readback.ok()) return readback.status();
  inputs->readback = std::make_unique<FitInputs>(*std::move(readback));
  inputs->title = absl::StrCat(
      WithStreamNames(flags.scene.scene), " (", inputs->readback->notes.OriginText(), ")");
  for (std::string& warning : inputs->readback->notes.Warnings()) {
    inputs->warnings.push_back(std::move(warning));
  }
  inputs->lights = inputs->readback->lights;
  inputs->light_status = inputs->readback->file.light_status;
  absl::StatusOr<CompareStage> stage = MakeStage(inputs->readback->file.View());
  if (!stage.ok()) return stage.status();
  inputs->stage = *std::move(stage);
  return absl::OkStatus();
}

// The camera of the next frame, and how to call it.
absl::StatusOr<Camera> NextCamera(const CompareFlags& flags,
                                  const SurfaceImage& screen,
                                  std::string* title) {
  if (!flags.crawl.next_frame.has_value()) {
    const CameraStep step = flags.crawl.step.value_or(DefaultCameraStep(screen));
    *title = absl::StrCat("the camera moves ", CameraStepText(step));
    return Stepped(screen.camera, step);
  }
  SceneFlags scene = flags.scene;
  scene.frame = FrameNumber::Whole(*flags.crawl.next_frame);
  if (scene.view.has_value()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--next-frame ",
                     scene.frame->Text(),
                     ": --camera ",
                     scene.camera,
                     " is a single view, want --camera FILE with frames; or --camera-step"));
  }
  *title = absl::StrCat("frame ", scene.frame->Text(), " of ", scene.camera);
  return MakeViewCamera(scene, screen.camera.width, screen.camera.height);
}

absl::StatusOr<CompareStage> NextSceneStage(const CompareFlags& flags, CompareInputs* inputs) {
  if (!flags.crawl.next_readback_path.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--next-readback ",
                     flags.crawl.next_readback_path,
                     ": the next frame of a scene is rendered, want --camera-step or --next-frame "
                     "instead"));
  }
  const absl::StatusOr<Camera> camera =
      NextCamera(flags, inputs->stage.screen, &inputs->next_title);
  if (!camera.ok()) return camera.status();
  const Readback& readback = inputs->stage.readback;
  absl::StatusOr<CompareStage> stage =
      MakeStage(inputs->scene->caster, *camera, readback.width(), readback.height());
  if (!stage.ok()) return stage;
  const absl::StatusOr<std::string> sight = CheckSight(inputs->scene->caster, stage->screen);
  if (!sight.ok()) return sight.status();
  return stage;
}

absl::StatusOr<CompareStage> NextReadbackStage(const CompareFlags& flags, CompareInputs* inputs) {
  if (flags.crawl.step.has_value()) {
    return absl::InvalidArgumentError(
        "--camera-step: a read-back has one camera only, want --next-readback FILE.exr; or compare "
        "on a scene");
  }
  if (flags.crawl.next_readback_path.empty()) {
    return absl::InvalidArgumentError(
        "--crawl: want the next frame of the read-back, --next-readback FILE.exr");
  }
  FitFlags fit = ReadbackFlags(flags);
  fit.readback_path = flags.crawl.next_readback_path;
  if (flags.crawl.next_frame.has_value()) {
    fit.frame = FrameNumber::Whole(*flags.crawl.next_frame);
  } else if (fit.frame.has_value()) {
    fit.frame->millionths += FrameNumber::kUnit;
  }
  absl::StatusOr<FitInputs> readback = ReadFitInputs(fit);
  if (!readback.ok()) return readback.status();
  for (size_t i = 0; i < inputs->lights.size() && i < readback->lights.size(); ++i) {
    if (IsSameLight(inputs->lights[i], readback->lights[i])) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        "light \"",
        inputs->lights[i].name,
        "\": it moves to the next frame, and then its shadows do whatever its texels do: there is "
        "no crawl to measure; leave it out with --only"));
  }
  inputs->next_readback = std::make_unique<FitInputs>(*std::move(readback));
  inputs->next_title = flags.crawl.next_readback_path;
  for (std::string& warning : inputs->next_readback->notes.Warnings()) {
    inputs->warnings.push_back(std::move(warning));
  }
  return MakeStage(inputs->next_readback->file.View());
}

absl::Status ReadNextFrame(const CompareFlags& flags, CompareInputs* inputs) {
  if (!flags.crawl.is_wanted) return absl::OkStatus();
  absl::StatusOr<CompareStage> stage =
      flags.is_readback() ? NextReadbackStage(flags, inputs) : NextSceneStage(flags, inputs);
  if (stage.ok()) {
    absl::StatusOr<NextFrame> next = MakeNextFrame(inputs->stage, *std::move(stage));
    if (!next.ok()) return next.status();
    inputs->next = std::make_unique<NextFrame>(*std::move(next));
    inputs->options.next = inputs->next.get();
    if (!SeesAnythingTwice(*inputs->next)) {
      inputs->warnings.emplace_back(
          "no surface is seen in both frames, so there is no crawl to measure; want a smaller step "
          "of the camera");
    }
    return absl::OkStatus();
  }
  return absl::Status(stage.status().code(),
                      absl::StrCat("next frame: ", stage.status().message()));
}

absl::Status CheckPictureLight(const std::string& name, const std::vector<Light>& lights) {
  if (name.empty()) return absl::OkStatus();
  std::vector<std::string> names;
  names.reserve(lights.size());
  for (const Light& light : lights) names.push_back(light.name);
  if (std::find(names.begin(), names.end(), name) != names.end()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--picture-light ", name, ": there is no such light", DidYouMean(name, names)));
}

}  // namespace

absl::StatusOr<CompareInputs> ReadCompareInputs(const CompareFlags& flags) {
  CompareInputs inputs;
  inputs.options.map = flags.map;
  inputs.options.fit = flags.fit.options;
  inputs.options.judge = flags.judge;
  const std::optional<PlanOptions> plan = PlanOptionsOf(flags.fit.plan, flags.fit.options);
  if (plan.has_value()) SetPlan(*plan, &inputs.options);
  for (const MatrixFlag& matrix : flags.matrices) {
    absl::StatusOr<GivenSetUp> given = ReadGivenMaps(matrix.name, matrix.path, inputs.options.map);
    if (!given.ok()) return given.status();
    inputs.options.given.push_back(*std::move(given));
  }
  absl::Status status =
      flags.is_readback() ? ReadReadbackInputs(flags, &inputs) : ReadSceneInputs(flags, &inputs);
  if (!status.ok()) return status;
  status = ReadNextFrame(flags, &inputs);
  if (!status.ok()) return status;
  status = CheckPictureLight(flags.picture_light, inputs.lights);
  if (!status.ok()) return status;
  return inputs;
}

}  // namespace lightfit::cli
