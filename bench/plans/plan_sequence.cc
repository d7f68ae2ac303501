// bench/plans/plan_sequence.cc : what stable plans of several maps cost over a shot, and save in
// crawl.
//
// In:   a folder of read-backs (by default shot_walk beside the repository) with scene.json; or
//       --boxes N: walks through random scenes.
// Out:  per light and over all: energy over that of the plan fitted to each frame, and over that of
//       one map fitted to each; maps redrawn and plans replaced; crawl; pixels that no map holds
//       and the border answers wrongly; milliseconds per frame. Of one map and of plans, fitted to
//       each frame and tracked at several stabilities.
#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/number.h"
#include "base/table.h"
#include "bench/inputs.h"
#include "optimizer/fit.h"
#include "optimizer/readback/needed_surfaces.h"
#include "optimizer/tracking/tracker.h"
#include "partition/tracking/plan_crawl.h"
#include "partition/tracking/plan_tracker.h"
#include "tests/testing/box_scene.h"

namespace lightfit {
namespace {

struct Arguments {
  std::string folder = DefaultReadbackFolder() + "/shot_walk";
  int frames = 1000;
  int num_maps = 4;
  int side = 1024;
  int boxes = 0;
  bool choose = false;
  bool per_frame = false;
  std::vector<double> stabilities = {0.25, 0.5, 0.75, 1.0};
};

struct Frame {
  Input input;
  Readback readback;
  std::optional<Surfaces> surfaces;
};

// What a row makes of a light's frame.
struct Made {
  Plan plan;
  double energy = 0.0;
  int num_redrawn = 0;
  bool is_new = false;
};

struct Mean {
  double sum = 0.0;
  int count = 0;
  void Add(double value) {
    if (!std::isfinite(value)) return;  // without an edge in view there is no energy
    sum += value;
    ++count;
  }
  double Value() const { return count > 0 ? sum / count : NAN; }
};

struct Totals {
  Mean log_ratio, log_ratio_to_one, drift, edge_crawl, milliseconds;
  int num_maps = 0, num_redrawn = 0, num_new = 0, num_outside = 0, num_failed = 0;

  void Add(const Totals& other) {
    for (Mean Totals::*mean : {&Totals::log_ratio,
                               &Totals::log_ratio_to_one,
                               &Totals::drift,
                               &Totals::edge_crawl,
                               &Totals::milliseconds}) {
      (this->*mean).sum += (other.*mean).sum;
      (this->*mean).count += (other.*mean).count;
    }
    num_maps += other.num_maps;
    num_redrawn += other.num_redrawn;
    num_new += other.num_new;
    num_outside += other.num_outside;
    num_failed += other.num_failed;
  }
};

// A sequence of one light, frame by frame.
class Row {
 public:
  virtual ~Row() = default;
  virtual absl::StatusOr<Made> Make(const Frame& frame, const Light& light) = 0;
};

class TrackedMap : public Row {
 public:
  TrackedMap(const TrackerOptions& options, MapSize size) : tracker_(options), size_(size) {}
  absl::StatusOr<Made> Make(const Frame& frame, const Light& light) override {
    const TrackedMatrices tracked = tracker_.Update(*frame.surfaces, {&light, 1}, size_);
    if (!tracked[0].ok()) return tracked[0].status();
    const TrackedMatrix& matrix = *tracked[0];
    const bool stays =
        matrix.action == TrackerAction::kKept || matrix.action == TrackerAction::kShifted;
    LightPlan plan;
    plan.light_name = light.name;
    plan.maps.push_back(matrix.matrix);
    return Made{PlanOf(plan), matrix.matrix.figures.energy, stays ? 0 : 1, !stays};
  }

 private:
  Tracker tracker_;
  MapSize size_;
};

class TrackedMaps : public Row {
 public:
  TrackedMaps(const PlanTrackerOptions& options, const Light& light) : tracker_(light, options) {}
  absl::StatusOr<Made> Make(const Frame& frame, const Light&) override {
    const absl::StatusOr<TrackedPlan> tracked = tracker_.Update(*frame.surfaces);
    if (!tracked.ok()) return tracked.status();
    return Made{
        PlanOf(tracked->plan), tracked->plan.energy, tracked->NumRedrawn(), tracked->is_new};
  }

 private:
  PlanTracker tracker_;
};

int NumOutside(const Frame& frame, const Light& light, const Plan& plan) {
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, light);
  if (!look_up.ok()) return -1;
  const NeededSurfaces needed(*frame.surfaces, light, plan.border);
  int num_outside = 0;
  for (int y = 0; y < frame.readback.height(); ++y) {
    for (int x = 0; x < frame.readback.width(); ++x) {
      const size_t pixel = frame.readback.Index(x, y);
      if ((needed.words()[pixel] >> light.shadow_bit & 1) == 0) continue;
      if (!frame.surfaces->affine_depth.IsSurface(frame.readback.depth[pixel])) continue;
      const double d = frame.surfaces->affine_depth.At(x, y, frame.readback.depth[pixel]);
      const Eigen::Vector4d world =
          frame.surfaces->world_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0);
      num_outside += look_up->At(world.hnormalized()).map < 0 ? 1 : 0;
    }
  }
  return num_outside;
}

struct Own {
  double plan, one_map;  // energies
};

// All frames of one light in one row. `own`: of each frame; `is_one`: of one map.
Totals Measure(const std::vector<Frame>& frames,
               const Light& light,
               bool is_one,
               bool per_frame,
               Row* row,
               const std::vector<Own>& own) {
  Totals totals;
  std::optional<Made> before;
  const Frame* frame_before = nullptr;
  for (size_t i = 0; i < frames.size(); ++i) {
    const Frame& frame = frames[i];
    const auto begin = std::chrono::steady_clock::now();
    absl::StatusOr<Made> made = row->Make(frame, light);
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
    totals.milliseconds.Add(time.count());
    if (!made.ok()) {
      ++totals.num_failed;
      before.reset();
      continue;
    }
    totals.log_ratio.Add(std::log(made->energy / (is_one ? own[i].one_map : own[i].plan)));
    totals.log_ratio_to_one.Add(std::log(made->energy / own[i].one_map));
    totals.num_maps += static_cast<int>(made->plan.maps.size());
    totals.num_redrawn += made->num_redrawn;
    totals.num_new += made->is_new ? 1 : 0;
    totals.num_outside += NumOutside(frame, light, made->plan);
    double edge = 0.0;
    if (before.has_value()) {
      const absl::StatusOr<Crawl> crawl =
          MeasurePlanCrawl({frame_before->readback, before->plan},
                           {frame.readback, made->plan, &*frame.surfaces},
                           light);
      if (crawl.ok() && crawl->num_points > 0) totals.drift.Add(crawl->phase_drift_texels);
      if (crawl.ok() && crawl->num_edge_points > 0) totals.edge_crawl.Add(crawl->edge_crawl_px);
      if (crawl.ok()) edge = crawl->edge_crawl_px;
    }
    if (per_frame) {
      std::printf("  %s %s: %d of %zu redrawn%s, energy %.3f, edge crawl %.4f, %.1f ms\n",
                  light.name.c_str(),
                  frame.input.name.c_str(),
                  made->num_redrawn,
                  made->plan.maps.size(),
                  made->is_new ? " (new)" : "",
                  made->energy / (is_one ? own[i].one_map : own[i].plan),
                  edge,
                  time.count());
    }
    before = *std::move(made);
    frame_before = &frame;
  }
  return totals;
}

Table NewTable(const std::string& light) {
  Table table;
  table.AddColumn("", light);
  table.AddColumn("energy", "/ own");
  table.AddColumn("energy", "/ one map");
  table.AddColumn("maps", "redrawn");
  table.AddColumn("maps", "of");
  table.AddColumn("", "new plans");
  table.AddColumn("phase drift", "texels");
  table.AddColumn("edge crawl", "pixels");
  table.AddColumn("pixels", "outside");
  table.AddColumn("", "ms");
  table.AddColumn("without", "a plan");
  return table;
}

void AddRow(const std::string& name, const Totals& totals, Table* table) {
  table->AddRow({name,
                 FigureText(std::exp(totals.log_ratio.Value())),
                 FigureText(std::exp(totals.log_ratio_to_one.Value())),
                 absl::StrCat(totals.num_redrawn),
                 absl::StrCat(totals.num_maps),
                 absl::StrCat(totals.num_new),
                 FigureText(totals.drift.Value()),
                 FigureText(totals.edge_crawl.Value()),
                 absl::StrCat(totals.num_outside),
                 FigureText(totals.milliseconds.Value()),
                 absl::StrCat(totals.num_failed)});
}

absl::StatusOr<std::vector<Frame>> ReadFrames(const Arguments& arguments) {
  std::vector<Frame> frames;
  for (int i = 1; i <= arguments.frames; ++i) {
    absl::StatusOr<Input> input = ReadInput(arguments.folder, absl::StrFormat("%04d", i));
    if (!input.ok()) {
      if (i > 1) break;
      return input.status();
    }
    frames.push_back({*std::move(input), {}, std::nullopt});
  }
  return frames;
}

// A walk through a random scene: ahead and to the side, turning slowly.
std::vector<Frame> BoxFrames(uint64_t seed, int num_frames) {
  constexpr int kSide = 180;
  constexpr double kStep = 0.15, kTurn_rad = 0.01;  // metres and radians a frame
  const BoxScene scene = MakeBoxScene(seed);
  const std::vector<Light> lights = RandomLights(scene, seed, 3);
  const Camera start = RandomCamera(scene, seed, kSide, kSide);
  const double side = seed % 2 == 0 ? 1.0 : -1.0;
  std::vector<Frame> frames;
  for (int i = 0; i < num_frames; ++i) {
    Camera camera = start;
    Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
    moved.rotate(Eigen::AngleAxisd(side * kTurn_rad * i, Eigen::Vector3d::UnitY()));
    moved.translate(-kStep * i * Eigen::Vector3d(0.4 * side, 0.0, 1.0));
    camera.camera_from_world = moved.matrix() * start.camera_from_world;
    SyntheticReadback image = Render(scene, camera, lights);
    Frame& frame = frames.emplace_back();
    frame.input.name = absl::StrFormat("boxes/%d/%02d", seed, i + 1);
    frame.input.lights = lights;
    frame.input.camera = camera;
    frame.input.depth = std::move(image.depth);
    frame.input.shadow_bits = std::move(image.shadow_bits);
    frame.input.facing_bits = std::move(image.facing_bits);
    frame.input.facing_lights = 0x7;
  }
  return frames;
}

absl::Status FindAllSurfaces(std::vector<Frame>* frames) {
  for (Frame& frame : *frames) {
    frame.readback = frame.input.View();
    absl::StatusOr<Surfaces> surfaces =
        FindSurfaces(frame.readback, LightMask(frame.input.lights), {});
    if (!surfaces.ok()) return surfaces.status();
    frame.surfaces.emplace(*std::move(surfaces));
  }
  return absl::OkStatus();
}

using Results = std::vector<std::pair<std::string, Totals>>;

// All lights of one sequence.
void MeasureSequence(const std::vector<Frame>& frames,
                     const Arguments& arguments,
                     Results* results) {
  const MapSize size = {arguments.side, arguments.side};
  PlanOptions plan;
  plan.max_maps = arguments.num_maps;
  plan.texels = int64_t{size.width} * size.height;
  plan.choose_by_forecast = arguments.choose;
  std::vector<double> stabilities = {0.0};
  stabilities.insert(stabilities.end(), arguments.stabilities.begin(), arguments.stabilities.end());
  for (const Light& light : frames.front().input.lights) {
    std::vector<Own> own;
    for (const Frame& frame : frames) {
      const absl::StatusOr<LightPlan> plan_of_frame = FitPlan(*frame.surfaces, light, plan);
      const absl::StatusOr<LightMatrix> map_of_frame = FitLight(*frame.surfaces, light, size);
      own.push_back({plan_of_frame.ok() ? plan_of_frame->energy : NAN,
                     map_of_frame.ok() ? map_of_frame->figures.energy : NAN});
    }
    Table table = NewTable(light.name);
    size_t index = 0;
    const auto measure = [&](const std::string& name, bool is_one, Row&& row) {
      if (arguments.per_frame) std::printf("%s\n", name.c_str());
      const Totals totals = Measure(frames, light, is_one, arguments.per_frame, &row, own);
      AddRow(name, totals, &table);
      if (index == results->size()) results->push_back({name, {}});
      (*results)[index++].second.Add(totals);
    };
    for (const bool is_one : {true, false}) {
      for (const double stability : stabilities) {
        const std::string name =
            absl::StrCat(is_one ? "one map" : absl::StrCat(arguments.num_maps, " maps"),
                         ", ",
                         stability == 0.0 ? std::string("per frame")
                                          : absl::StrFormat("stability %g", stability));
        if (is_one) {
          measure(name, true, TrackedMap(TrackerOptions::ForStability(stability), size));
        } else {
          PlanTrackerOptions options = PlanTrackerOptions::ForStability(stability);
          options.plan = plan;
          measure(name, false, TrackedMaps(options, light));
        }
      }
    }
    std::printf("%s\n", table.Text().c_str());
  }
}

absl::Status Run(const Arguments& arguments) {
  Results results;
  for (int seed = 1; seed <= arguments.boxes; ++seed) {
    std::vector<Frame> frames = BoxFrames(seed, std::min(arguments.frames, 24));
    if (absl::Status status = FindAllSurfaces(&frames); !status.ok()) return status;
    MeasureSequence(frames, arguments, &results);
  }
  if (arguments.boxes == 0) {
    absl::StatusOr<std::vector<Frame>> frames = ReadFrames(arguments);
    if (!frames.ok()) return frames.status();
    if (absl::Status status = FindAllSurfaces(&*frames); !status.ok()) return status;
    MeasureSequence(*frames, arguments, &results);
  }
  Table table = NewTable("all");
  for (const auto& [name, totals] : results) AddRow(name, totals, &table);
  std::printf("%s", table.Text().c_str());
  return absl::OkStatus();
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  lightfit::Arguments arguments;
  CLI::App app("What stable plans of several maps cost over a shot, and save in crawl.");
  app.add_option("--shot", arguments.folder, "Folder with frames 0001.exr ... and scene.json")
      ->capture_default_str();
  app.add_option("--frames", arguments.frames, "The first so many")->capture_default_str();
  app.add_option("--maps", arguments.num_maps, "Of a plan")->capture_default_str();
  app.add_option("--map", arguments.side, "Side of the one map; a plan has as many texels")
      ->capture_default_str();
  app.add_option("--stability", arguments.stabilities)->delimiter(',')->capture_default_str();
  app.add_option("--boxes", arguments.boxes, "Walks through so many random scenes instead");
  app.add_flag("--choose", arguments.choose, "Plans of fewer maps too, by forecast");
  app.add_flag("--per-frame", arguments.per_frame, "A line for every frame");
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = lightfit::Run(arguments);
  if (status.ok()) return 0;
  std::fprintf(stderr, "plan_sequence: %s\n", std::string(status.message()).c_str());
  return 1;
}
