// bench/published/mikkelsen.cc : which of two maps serves the pixels, with a plane between them.
//
// In:   the scenes of bench/scene_set.h, lights in turn over their cameras, two thirds suns and one
//       third lamps; a budget of 400x400 texels; focused maps beside perspective and beside
//       light-space perspective ones.
// Out:  per scene, suns and lamps apart, as figures 8 to 10 of the paper by numbers: the share of
//       the pixels that the warped map serves after one round, after all, and in the round that is
//       kept; how large texels are on the screen over that of the first round; how much of the
//       first round's extent, as the light sees it, the two maps of the last round have; and how
//       often planes settle.
//
// Mikkelsen 2007; docs/published_plans.md. Nothing is judged by its picture. Scenes whose file is
// absent are named and left out. Under a minute.
#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "bench/scene_run.h"
#include "geometry/homography.h"
#include "geometry/polygon.h"
#include "jobs/compare/stage.h"
#include "methods/light_body.h"
#include "partition/published/refocused_maps.h"

namespace lightfit {
namespace {

struct Arguments {
  SceneArguments scenes = {.num_lights = 12, .seed = 7};
  int num_rounds = 20;
};

constexpr int kReadback = 180;
constexpr std::array kWarped = {Method::kPerspective, Method::kLispsm};

// Shares of surface pixels.
struct Served {
  double first = 0.0, second = 0.0, none = 0.0;
};

Served ServedBy(const SurfaceImage& image, const Plan& plan, const Light& light) {
  Served served;
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, light);
  if (!look_up.ok() || image.num_surface == 0) return served;
  const double share = 1.0 / static_cast<double>(image.num_surface);
  for (const SurfacePoint& pixel : image.pixels) {
    if (!pixel.is_surface()) continue;
    const int map = look_up->At(pixel.position).map;
    (map < 0 ? served.none : map == 0 ? served.first : served.second) += share;
  }
  return served;
}

// Share of the surface pixels whose side of the plane is another one.
double Moved(const SurfaceImage& image,
             const Eigen::RowVector4d& plane,
             const Eigen::RowVector4d& other) {
  int64_t num_moved = 0;
  for (const SurfacePoint& pixel : image.pixels) {
    if (!pixel.is_surface()) continue;
    const Eigen::Vector4d world = pixel.position.homogeneous();
    num_moved += (plane.dot(world) >= 0.0) != (other.dot(world) >= 0.0) ? 1 : 0;
  }
  return static_cast<double>(num_moved) / static_cast<double>(image.num_surface);
}

// Area of the map's rectangle in the light's plane; infinite when a corner lies behind it.
double ExtentOf(const PlanMap& map, const LightBody& body) {
  const Eigen::Matrix3d map_from_ray =
      HomographyOfRows(body, map.map_from_world({0, 1, 3}, Eigen::all));
  const Eigen::Matrix3d ray_from_map = map_from_ray.inverse();
  std::array<Eigen::Vector2d, 4> corners;
  const double width = map.size.width, height = map.size.height;
  const std::array<Eigen::Vector2d, 4> texels = {
      Eigen::Vector2d(0.0, 0.0), {width, 0.0}, {width, height}, {0.0, height}};
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d ray = ray_from_map * texels[i].homogeneous();
    if (!(ray.z() * ray_from_map(2, 2) > 0.0)) return HUGE_VAL;
    corners[i] = ray.hnormalized();
  }
  return 0.5 * std::abs(Cross(corners[2] - corners[0], corners[3] - corners[1]));
}

// Over lights of one kind.
struct Table {
  int num_lights = 0;
  int num_single = 0;   // the round that is kept has one map
  int num_settled = 0;  // less than 0.1 % of the pixels change sides in the last round
  int num_ended = 0;    // a side became empty
  double one_round = 0.0, last_round = 0.0, kept_round = 0.0;  // of the pixels, by the second map
  double none = 0.0;                                           // of the pixels, in the round kept
  double log_last = 0.0, log_kept = 0.0;                       // of texels over the first round's
  double kept_index = 0.0;
  int num_extents = 0;
  std::array<double, 2> log_extent = {};

  void Add(const Table& other) {
    num_lights += other.num_lights;
    num_single += other.num_single;
    num_settled += other.num_settled;
    num_ended += other.num_ended;
    one_round += other.one_round;
    last_round += other.last_round;
    kept_round += other.kept_round;
    none += other.none;
    log_last += other.log_last;
    log_kept += other.log_kept;
    kept_index += other.kept_index;
    num_extents += other.num_extents;
    for (int k = 0; k < 2; ++k) log_extent[k] += other.log_extent[k];
  }
};

// Of a round: the share that the second method's map serves.
double WarpedShare(const CompareStage& stage, const RefocusRound& round, const Light& light) {
  const Served served = ServedBy(stage.readback_surfaces, round.plan, light);
  return round.only == 0 ? 0.0 : round.only == 1 ? served.first : served.second;
}

absl::Status AddLight(
    const CompareStage& stage, const Light& light, Method warped, int num_rounds, Table* table) {
  MethodInput input = stage.view;
  input.light = light;
  input.map = {400, 400};
  RefocusOptions options;
  options.second = warped;
  options.max_rounds = num_rounds;
  const absl::StatusOr<RefocusRounds> result = RefocusMaps(input, options);
  if (!result.ok()) return result.status();
  const std::vector<RefocusRound>& rounds = result->rounds;
  const RefocusRound &first = rounds.front(), &last = rounds.back(), &best = rounds[result->best];

  ++table->num_lights;
  table->one_round += WarpedShare(stage, first, light);
  table->last_round += WarpedShare(stage, last, light);
  table->kept_round += WarpedShare(stage, best, light);
  table->none += ServedBy(stage.readback_surfaces, best.plan, light).none;
  table->num_single += best.plan.maps.size() == 1 ? 1 : 0;
  table->log_last += std::log(last.texel_side / first.texel_side);
  table->log_kept += std::log(best.texel_side / first.texel_side);
  table->kept_index += static_cast<double>(result->best) + 1.0;
  if (last.plan.maps.size() == 1) {
    ++table->num_ended;
    return absl::OkStatus();
  }
  const double moved =
      rounds.size() < 3
          ? 1.0
          : Moved(stage.readback_surfaces, last.plane, rounds[rounds.size() - 2].plane);
  table->num_settled += moved < 1e-3 ? 1 : 0;
  const absl::StatusOr<LightBody> body = BodyInView(input);
  if (!body.ok()) return absl::OkStatus();
  std::array<double, 2> logs;
  for (int k = 0; k < 2; ++k) {
    logs[k] = std::log(ExtentOf(last.plan.maps[k], *body) / ExtentOf(first.plan.maps[k], *body));
  }
  if (!std::isfinite(logs[0] + logs[1])) return absl::OkStatus();
  ++table->num_extents;
  for (int k = 0; k < 2; ++k) table->log_extent[k] += logs[k];
  return absl::OkStatus();
}

void PrintHead(Method warped) {
  std::printf("\n== focused and %s\n", MethodName(warped));
  std::printf(
      "%30s %% by the warped map   %% by   texels/first  extent/first  round   of the lights\n",
      "");
  std::printf(
      "%-16s %-6s %4s     one   last  kept    none    last  kept    focus  warp   kept   "
      "settled ended single\n",
      "",
      "",
      "num");
}

void Print(const std::string& name, const char* kind, const Table& table) {
  if (table.num_lights == 0) return;
  const double n = table.num_lights;
  std::string extents = "    -     -";
  if (table.num_extents > 0) {
    extents = absl::StrFormat("%5.2f %5.2f",
                              std::exp(table.log_extent[0] / table.num_extents),
                              std::exp(table.log_extent[1] / table.num_extents));
  }
  std::printf(
      "%-16s %-6s %4d   %5.1f  %5.1f %5.1f   %5.2f   %5.2f %5.2f   %s   %5.1f   %7d %5d %6d\n",
      name.c_str(),
      kind,
      table.num_lights,
      100.0 * table.one_round / n,
      100.0 * table.last_round / n,
      100.0 * table.kept_round / n,
      100.0 * table.none / n,
      std::exp(table.log_last / n),
      std::exp(table.log_kept / n),
      extents.c_str(),
      table.kept_index / n,
      table.num_settled,
      table.num_ended,
      table.num_single);
  std::fflush(stdout);
}

absl::Status Run(const Arguments& arguments) {
  std::array<std::array<Table, 2>, kWarped.size()> all;
  std::vector<std::string> names;
  std::vector<std::array<std::array<Table, 2>, kWarped.size()>> scenes;
  absl::Status status = ForEachScene(arguments.scenes, [&](size_t index) -> absl::Status {
    const SceneCase& scene = SceneCases()[index];
    const absl::StatusOr<RayCaster> caster = LoadSceneCase(scene, arguments.scenes.folder);
    if (!caster.ok()) return caster.status();
    const absl::StatusOr<std::vector<CompareStage>> stages = MakeStages(scene, *caster, kReadback);
    if (!stages.ok()) return stages.status();
    const std::vector<Light> lights =
        DrawLights(scene, *caster, arguments.scenes.num_lights, arguments.scenes.seed);
    names.push_back(scene.name);
    scenes.emplace_back();
    for (size_t i = 0; i < lights.size(); ++i) {
      const int kind = lights[i].kind == Light::Kind::kPoint ? 1 : 0;
      for (size_t w = 0; w < kWarped.size(); ++w) {
        absl::Status added = AddLight((*stages)[ViewOf(i, *stages)],
                                      lights[i],
                                      kWarped[w],
                                      arguments.num_rounds,
                                      &scenes.back()[w][kind]);
        // A lamp among its receivers has no map of any method.
        if (!added.ok() && !absl::IsFailedPrecondition(added)) return added;
      }
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  for (size_t w = 0; w < kWarped.size(); ++w) {
    PrintHead(kWarped[w]);
    for (const int kind : {0, 1}) {
      for (size_t i = 0; i < scenes.size(); ++i) {
        Print(names[i], kind == 0 ? "suns" : "lamps", scenes[i][w][kind]);
        all[w][kind].Add(scenes[i][w][kind]);
      }
    }
    Print("all", "suns", all[w][0]);
    Print("all", "lamps", all[w][1]);
  }
  return absl::OkStatus();
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("Separating planes: which of two maps serves the pixels.");
  lightfit::DeclareLights(&app, "--lights", &arguments.scenes);
  app.add_option("--rounds", arguments.num_rounds, "At most")->capture_default_str();
  lightfit::DeclareScenes(&app, &arguments.scenes);
  CLI11_PARSE(app, argc, argv);
  return lightfit::ExitCodeOf("mikkelsen", lightfit::Run(arguments));
}
