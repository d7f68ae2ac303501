#include "cli/render.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/output_file.h"
#include "base/progress.h"
#include "base/suggest.h"
#include "base/table.h"
#include "base/text_file.h"
#include "cli/exit_code.h"
#include "cli/flags/render_flags.h"
#include "cli/flags/scene_inputs.h"
#include "cli/unusable_lights.h"
#include "io/readback_exr_write.h"
#include "picture/canvas.h"
#include "picture/png.h"
#include "picture/render_page.h"
#include "render/readback_image.h"
#include "render/sight.h"
#include "wire/light_proto.h"
#include "wire/proto_json.h"

namespace lightfit::cli {
namespace {

PixelSize PictureSize(const RenderFlags& flags) {
  return flags.picture_size.width > 0 ? flags.picture_size : flags.size;
}

absl::Status CheckNeeds(const RenderFlags& flags) {
  std::vector<std::string> missing;
  if (flags.output_path.empty() && flags.picture_path.empty()) {
    missing.emplace_back(
        "nothing to write: want -o FILE.exr for a read-back, --picture FILE.png, or both");
  }
  return CheckSceneNeeds(flags.scene, std::move(missing));
}

absl::Status CheckOutputs(const RenderFlags& flags) {
  for (const auto& [flag, path] : {std::pair{"--output", flags.output_path},
                                   std::pair{"--picture", flags.picture_path},
                                   std::pair{"--lights-out", flags.lights_path}}) {
    if (path.empty()) continue;
    if (absl::Status status = CheckWritable(flag, path); !status.ok()) return status;
  }
  const PixelSize picture = PictureSize(flags);
  if (!flags.picture_path.empty() && std::max(picture.width, picture.height) > kMaxCanvasSide) {
    return absl::InvalidArgumentError(
        absl::StrFormat("--picture-size %dx%d: want at most %d pixels along each side of a picture",
                        picture.width,
                        picture.height,
                        kMaxCanvasSide));
  }
  return absl::OkStatus();
}

// The light to draw.
absl::StatusOr<Light> PictureLight(const RenderFlags& flags, const std::vector<Light>& lights) {
  if (flags.picture_light.empty()) return lights.front();
  std::vector<std::string> names;
  names.reserve(lights.size());
  for (const Light& light : lights) {
    if (light.name == flags.picture_light) return light;
    names.push_back(light.name);
  }
  return absl::InvalidArgumentError(absl::StrCat("--picture-light ",
                                                 flags.picture_light,
                                                 ": there is no such light, want one of ",
                                                 absl::StrJoin(names, ", "),
                                                 DidYouMean(flags.picture_light, names)));
}

// What is taken from the scene's file beside its triangles; empty when nothing.
std::string TakenFromScene(const SceneFlags& flags) {
  const bool has_camera = flags.camera.empty(), has_lights = TakesLightsOfScene(flags);
  if (!has_camera && !has_lights) return "";
  return absl::StrCat(has_camera ? "camera" : "",
                      has_camera && has_lights ? " and " : "",
                      has_lights ? "lights" : "",
                      " of ",
                      flags.scene,
                      "\n");
}

// What the verb works on.
struct Inputs {
  LoadedScene scene;
  Camera camera;
  std::vector<Light> lights;
};

absl::StatusOr<Inputs> ReadInputs(const RenderFlags& flags) {
  absl::StatusOr<std::vector<Light>> lights = SceneLights(flags.scene);
  if (!lights.ok()) return lights.status();
  if (absl::Status status = ValidateLights(*lights); !status.ok()) return status;
  if (absl::Status status = PictureLight(flags, *lights).status(); !status.ok()) return status;
  absl::StatusOr<Camera> camera = MakeViewCamera(flags.scene, flags.size.width, flags.size.height);
  if (!camera.ok()) return camera.status();
  absl::StatusOr<LoadedScene> scene = LoadScene(flags.scene);
  if (!scene.ok()) return scene.status();
  return Inputs{*std::move(scene), *std::move(camera), *std::move(lights)};
}

// What is computed before anything is printed, so that the progress bar has the terminal to itself.
struct Outcome {
  ReadbackImage readback;
  int64_t num_surface = 0;
  std::vector<LightingCounts> counts;  // per light
  std::string warning;                 // of CheckSight()
  Image picture;
};

absl::StatusOr<Outcome> Render(const RenderFlags& flags, const Inputs& inputs) {
  const RayCaster& caster = inputs.scene.caster;
  const bool draws = !flags.picture_path.empty();
  Progress progress(static_cast<int>(inputs.lights.size()) + (draws ? 2 : 1), flags.quiet);
  progress.Begin("casting rays");
  const absl::StatusOr<SurfaceImage> image = RenderSurfaces(caster, inputs.camera);
  if (!image.ok()) return image.status();
  absl::StatusOr<std::string> warning = CheckSight(caster, *image);
  if (!warning.ok()) return warning.status();
  Outcome outcome;
  outcome.warning = *std::move(warning);
  outcome.num_surface = image->num_surface;
  outcome.readback = ReadbackOf(*image);
  progress.Advance();
  for (const Light& light : inputs.lights) {
    progress.Begin(absl::StrCat("shadows of ", light.name));
    const std::vector<Lighting> lighting = TrueLighting(caster, *image, light);
    AddShadow(lighting, light.shadow_bit, &outcome.readback);
    outcome.counts.push_back(CountLighting(lighting));
    progress.Advance();
  }
  if (!draws) return outcome;
  progress.Begin("drawing");
  const PixelSize size = PictureSize(flags);
  const absl::StatusOr<Camera> camera = MakeViewCamera(flags.scene, size.width, size.height);
  if (!camera.ok()) return camera.status();
  const absl::StatusOr<SurfaceImage> surfaces = RenderSurfaces(caster, *camera);
  if (!surfaces.ok()) return surfaces.status();
  const absl::StatusOr<Light> light = PictureLight(flags, inputs.lights);
  if (!light.ok()) return light.status();
  outcome.picture = DrawLighting(*surfaces, TrueLighting(caster, *surfaces, *light), *light);
  return outcome;
}

std::string ReportText(const Inputs& inputs, const Outcome& outcome) {
  const auto percent = [](int64_t part, int64_t whole) {
    return absl::StrFormat("%.1f %%", 100.0 * static_cast<double>(part) / whole);
  };
  const LoadedScene& scene = inputs.scene;
  std::string text = absl::StrCat(scene.title, ": ", scene.num_triangles(), " triangles");
  if (scene.num_dropped > 0) absl::StrAppend(&text, " (", scene.num_dropped, " bad ones dropped)");
  absl::StrAppend(&text,
                  ", ",
                  inputs.camera.width,
                  "x",
                  inputs.camera.height,
                  " pixels, ",
                  percent(outcome.num_surface, outcome.readback.depth.size()),
                  " of them surfaces, which are\n");
  Table table;
  for (const char* name : {"light", "lit", "shadowed", "facing away"}) table.AddColumn("", name);
  for (size_t i = 0; i < inputs.lights.size(); ++i) {
    const LightingCounts& counts = outcome.counts[i];
    table.AddRow({inputs.lights[i].name,
                  percent(counts.lit, outcome.num_surface),
                  percent(counts.shadowed, outcome.num_surface),
                  percent(counts.facing_away, outcome.num_surface)});
  }
  return absl::StrCat(text, table.Text());
}

void PrintWarnings(const Inputs& inputs, const Outcome& outcome) {
  if (!outcome.warning.empty()) PrintWarning(outcome.warning);
  for (size_t i = 0; i < inputs.lights.size(); ++i) {
    const LightingCounts& counts = outcome.counts[i];
    const std::string light = absl::StrCat("light \"", inputs.lights[i].name, "\": ");
    if (counts.lit == 0) {
      PrintWarning(absl::StrCat(light,
                                "lights nothing that the camera sees (",
                                counts.facing_away,
                                " pixels face away, ",
                                counts.shadowed,
                                " are in shadow): there is no shadow edge to fit"));
    } else if (counts.shadowed == 0) {
      PrintWarning(absl::StrCat(
          light, "casts no shadow that the camera sees: there is no shadow edge to fit"));
    }
  }
}

absl::Status WriteLights(const std::string& path, const std::vector<Light>& lights) {
  v1::LightList list;
  for (const Light& light : lights) *list.add_lights() = LightToProto(light);
  const absl::StatusOr<std::string> json = ProtoToJson(list);
  if (!json.ok()) return json.status();
  return WriteTextFileAtomically(path, *json);
}

absl::Status WriteOutputs(const RenderFlags& flags, const Inputs& inputs, const Outcome& outcome) {
  if (!flags.output_path.empty()) {
    absl::Status status =
        WriteReadbackExr(flags.output_path, outcome.readback.View(), inputs.lights);
    if (!status.ok()) return status;
  }
  if (!flags.lights_path.empty()) {
    if (absl::Status status = WriteLights(flags.lights_path, inputs.lights); !status.ok()) {
      return status;
    }
  }
  if (flags.picture_path.empty()) return absl::OkStatus();
  return WritePng(Canvas(outcome.picture), flags.picture_path);
}

int RunRender(RenderFlags flags) {
  if (absl::Status status = CheckNeeds(flags); !status.ok()) return Fail(kExitBadInput, status);
  if (flags.size.width == 0) flags.size = DefaultImageSize(flags.scene, kDefaultReadbackHeight);
  if (absl::Status status = CheckOutputs(flags); !status.ok()) return Fail(kExitBadInput, status);
  const absl::StatusOr<Inputs> inputs = ReadInputs(flags);
  if (!inputs.ok()) return Fail(kExitBadInput, inputs.status());
  const absl::StatusOr<Outcome> outcome = Render(flags, *inputs);
  if (!outcome.ok()) return Fail(kExitBadInput, outcome.status());
  if (!flags.quiet) {
    std::fputs((TakenFromScene(flags.scene) + ReportText(*inputs, *outcome)).c_str(), stdout);
    std::fflush(stdout);
  }
  PrintWarnings(*inputs, *outcome);
  if (absl::Status status = WriteOutputs(flags, *inputs, *outcome); !status.ok()) {
    return Fail(kExitBadInput, status);
  }
  const absl::StatusOr<std::vector<ListedLight>> lights = ListLights(flags.scene.lights);
  return lights.ok() && PrintUnusable(*lights, "shadow") > 0 ? kExitIncomplete : kExitOk;
}

}  // namespace

std::function<int()> DeclareRender(CLI::App* app) {
  const auto flags = std::make_shared<RenderFlags>();
  DeclareRenderFlags(app, flags.get());
  return [flags] { return RunRender(*flags); };
}

}  // namespace lightfit::cli
