// bench/published/lloyd.cc : the figures of Lloyd et al. 2006, "Warping and Partitioning for Low
// Error Shadow Maps", as numbers and pictures.
//
// In:   their views, f/n and half angle; no scene. --steps: suns from overhead to the horizon.
// Out:  per figure what is to come out by the corrected equations, the closed form, and what is
//       measured on plans: rectangles and warps fitted to the corners of the view. Then the
//       worst of all lights over the light behind, which they found to be 2 to 3. --out: charts.
//
// Exit status 1 with --check when a closed form is not the figure's to its digits, a measurement is
// more than 1e-4 from the closed form, or a mean of figure 7 more than 10 % from what it should be.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "base/table.h"
#include "bench/published/lloyd_figures.h"
#include "methods/focused.h"
#include "methods/view_body.h"
#include "partition/published/face_partition.h"
#include "partition/published/storage_factor.h"
#include "partition/published/z_partition.h"
#include "tests/partition/published/lloyd_view.h"

namespace lightfit {
namespace {

using testing::InputOf;
using testing::kBehind;
using testing::kOverhead;
using testing::LloydFigures;

constexpr double kNoWarp = std::numeric_limits<double>::infinity();
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

double StorageOf(const absl::StatusOr<Plan>& plan, const MethodInput& input) {
  if (!plan.ok()) return kNothing;
  const absl::StatusOr<double> storage = StorageFactor(*plan, input);
  return storage.ok() ? *storage : kNothing;
}

double DepthStorage(const MethodInput& input, int num_maps, Method method) {
  ZPartitionOptions options;
  options.num_maps = num_maps;
  options.method = method;
  return StorageOf(ZPartition(input, options), input);
}

double FaceStorage(const MethodInput& input, int num_parts, bool has_near_face) {
  FacePartitionOptions options;
  options.num_parts = num_parts;
  options.has_near_face = has_near_face;
  return StorageOf(FacePartition(input, options), input);
}

// As the paper lays them: no warp, the sides along the view. Our focused maps are of least area.
double AlongViewStorage(const MethodInput& input, int num_maps) {
  const std::vector<double> depths =
      DepthSplits(input.camera.near, input.camera.far, num_maps, 1.0);
  MethodInput slice = input;
  slice.map = {1, 1};
  double sum = 0.0;
  for (int i = 0; i < num_maps; ++i) {
    slice.camera.near = depths[i];
    slice.camera.far = depths[i + 1];
    const absl::StatusOr<MethodMap> map = FocusedMap(slice, {.min_area_rotation = false});
    if (!map.ok()) return kNothing;
    const absl::StatusOr<BeamErrors> errors = MaxBeamErrors(
        map->map_from_world, slice.light, slice.camera, ViewBody(slice.camera, slice.receivers));
    sum += errors.ok() ? errors->u * errors->v : kNothing;
  }
  return sum;
}

std::string Digits(double value) {
  return std::isnan(value) ? std::string("-") : absl::StrFormat("%.6g", value);
}

// Rows of what should be, the closed form, and the measurement.
class FigureTable {
 public:
  explicit FigureTable(const std::string& name) {
    for (const char* column : {"", "figure", "formula", "measured"}) {
      table_.AddColumn("", column[0] == '\0' ? name : column);
    }
  }

  void Add(const std::string& name, double figure, double formula, double measured = kNothing) {
    constexpr double kThreeDigits = 6e-3, kMeasured = 1e-4;
    table_.AddRow({name, Digits(figure), Digits(formula), Digits(measured)});
    const bool is_off = std::abs(formula / figure - 1.0) > kThreeDigits ||
                        std::abs(measured / formula - 1.0) > kMeasured;
    num_off_ += is_off ? 1 : 0;
  }

  // Prints it, and says how many rows are off.
  int Finish() const {
    std::printf("%s\n", table_.Text().c_str());
    return num_off_;
  }

 private:
  Table table_;
  int num_off_ = 0;
};

int PrintFigure5() {
  const LloydView view = {1.0, 20.0, M_PI / 4.0};
  const auto z_term = [&](double warp, double z) {
    return ZError(view, warp, z) * ImageBeamWidth(view, 1.0) / (view.far - view.near);
  };
  FigureTable table("Figure 5, last factors of (8) and (7)");
  const std::pair<const char*, double> warps[] = {
      {"n' = n", view.near}, {"light-space", LispsmWarp(view)}, {"no warp", kNoWarp}};
  const double* z_figures[] = {
      LloydFigures::kZTermPsm, LloydFigures::kZTermLispsm, LloydFigures::kZTermUnwarped};
  for (int i = 0; i < 3; ++i) {
    const auto& [name, warp] = warps[i];
    table.Add(absl::StrFormat("along, %s, near", name), z_figures[i][0], z_term(warp, view.near));
    table.Add(absl::StrFormat("along, %s, far", name), z_figures[i][1], z_term(warp, view.far));
    table.Add(absl::StrFormat("across, %s, near", name),
              LloydFigures::kXTermAtNear[i],
              XError(view, warp, view.near) / view.far);
    table.Add(absl::StrFormat("across, %s, far", name),
              LloydFigures::kXTermAtFar,
              XError(view, warp, view.far) / view.far);
  }
  // (n' - n + z)^2 / z is least at z = n' - n.
  const double depth = LispsmWarp(view) - view.near;
  table.Add("along, light-space, least",
            LloydFigures::kZTermLispsmLeast,
            z_term(LispsmWarp(view), depth));
  table.Add("... at depth", LloydFigures::kDepthOfLeast, depth);
  return table.Finish();
}

int PrintFigure6() {
  const LloydView view = {1.0, 100.0, M_PI / 4.0};
  FigureTable table("Figure 6, f/n = 100, theta = 45");
  for (const int i : {0, 1, 2}) {
    const double warp = WarpOfEta(view, i - 1.0);
    const double* figures = LloydFigures::kOfEta[i];
    table.Add(absl::StrFormat("M_x, eta = %d", i - 1), figures[0], MaxXError(view, warp));
    table.Add(absl::StrFormat("M_z, eta = %d", i - 1), figures[1], MaxZError(view, warp));
    table.Add(absl::StrFormat("storage, eta = %d", i - 1), figures[2], WarpStorage(view, warp));
  }
  return table.Finish();
}

int PrintFigure10() {
  const LloydView view = {1.0, 1000.0, M_PI / 6.0};
  const MethodInput input = InputOf(view, kOverhead);
  FigureTable table("Figure 10, overhead, f/n = 1000, theta = 30");
  for (size_t i = 0; i < std::size(LloydFigures::kParts); ++i) {
    const int parts = LloydFigures::kParts[i];
    table.Add(absl::StrFormat("ZP+W, slices %d", parts),
              LloydFigures::kOverheadWarp[i],
              OverheadWarpStorage(view, parts),
              DepthStorage(input, parts, Method::kLispsm));
  }
  table.Add("limit, logarithmic", LloydFigures::kOverheadLimit, LogarithmicZError(view));
  return table.Finish();
}

int PrintFigure12() {
  const LloydView view = {1.0, 1000.0, M_PI / 6.0};
  const MethodInput behind = InputOf(view, kBehind), overhead = InputOf(view, kOverhead);
  FigureTable table("Figure 12, f/n = 1000, theta = 30");
  for (size_t i = 0; i < std::size(LloydFigures::kBehindMaps); ++i) {
    const int maps = LloydFigures::kBehindMaps[i];
    table.Add(absl::StrFormat("behind, ZP, maps %d", maps),
              LloydFigures::kBehind[i],
              BehindStorage(view, maps),
              DepthStorage(behind, maps, Method::kFocused));
  }
  for (size_t i = 0; i < std::size(LloydFigures::kBehindFaceMaps); ++i) {
    const int parts = LloydFigures::kBehindFaceMaps[i] / 4;
    table.Add(absl::StrFormat("behind, FP+ZP+W, maps %d", 4 * parts),
              LloydFigures::kBehindFaceWarp[i],
              BehindFaceWarpStorage(view, parts),
              FaceStorage(behind, parts, /*has_near_face=*/true));
  }
  for (size_t i = 0; i < std::size(LloydFigures::kOverheadMaps); ++i) {
    const int maps = LloydFigures::kOverheadMaps[i];
    table.Add(absl::StrFormat("overhead, ZP, maps %d", maps),
              LloydFigures::kOverhead[i],
              OverheadStorage(view, maps),
              DepthStorage(overhead, maps, Method::kFocused));
  }
  const double best = BestPartsBehind(view);
  table.Add("behind, ZP, best number of maps", kNothing, best);
  table.Add("... storage there", kNothing, BehindStorage(view, best));
  return table.Finish();
}

int PrintFigure13() {
  FigureTable table("Figure 13, first number of maps with which FP+ZP+W needs less");
  for (size_t i = 0; i < std::size(LloydFigures::kAlphas); ++i) {
    const LloydView view = {1.0, LloydFigures::kAlphas[i], M_PI / 6.0};
    const int maps = testing::FirstMapsOfFaces(view);
    table.Add(absl::StrFormat("f/n = %g", view.far), LloydFigures::kFirstMaps[i], maps);
  }
  return table.Finish();
}

double GeometricMean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += std::log(value);
  return std::exp(sum / static_cast<double>(values.size()));
}

std::vector<double> OverSuns(const LloydView& view,
                             int steps,
                             const std::function<double(const MethodInput&)>& storage) {
  std::vector<double> values;
  for (const Eigen::Vector3d& sun : testing::SunsAbove(steps)) {
    values.push_back(storage(InputOf(view, sun)));
  }
  return values;
}

// The discs are those of the paper: no warp, warped, and the faces warped.
int PrintFigure7(int steps, std::vector<LloydDisc>* discs) {
  constexpr double kWhereSunsAreCounted = 0.1;
  Table table;
  for (const char* name : {"Figure 7, geometric means", "figure", "mean", "largest"}) {
    table.AddColumn("", name);
  }
  int num_off = 0;
  for (const LloydFigures::Mean& mean : LloydFigures::kMeans) {
    const LloydView view = {1.0, mean.alpha, M_PI / 6.0};
    const int parts = mean.parts;
    const auto add = [&](const std::string& name, double figure, const auto& storage) {
      const std::vector<double> values = OverSuns(view, steps, storage);
      const double mean_value = GeometricMean(values);
      const std::string title = absl::StrFormat("f/n = %g, parts %d, %s", view.far, parts, name);
      table.AddRow({title,
                    Digits(figure),
                    Digits(mean_value),
                    Digits(*std::max_element(values.begin(), values.end()))});
      if (std::isnan(figure)) return;
      num_off += std::abs(mean_value / figure - 1.0) > kWhereSunsAreCounted ? 1 : 0;
      discs->push_back({title, values});
    };
    add("no warp, along the view", mean.unwarped, [&](const MethodInput& input) {
      return AlongViewStorage(input, parts);
    });
    add("warped", mean.warped, [&](const MethodInput& input) {
      return DepthStorage(input, parts, Method::kLispsm);
    });
    add("faces, warped", mean.faces, [&](const MethodInput& input) {
      return FaceStorage(input, parts, /*has_near_face=*/true);
    });
    add("no warp, least area", kNothing, [&](const MethodInput& input) {
      return DepthStorage(input, parts, Method::kFocused);
    });
    add("warped, simple n", kNothing, [&](const MethodInput& input) {
      return DepthStorage(input, parts, Method::kLispsmSimple);
    });
    add("faces, stretched over the near plane", kNothing, [&](const MethodInput& input) {
      return FaceStorage(input, parts, /*has_near_face=*/false);
    });
  }
  std::printf("%s\n", table.Text().c_str());
  return num_off;
}

int PrintWorstLights(int steps) {
  constexpr double kMost = 3.0;
  Table table;
  for (const char* name : {"Worst light / behind", "ZP", "ZP+W", "FP+ZP+W"}) {
    table.AddColumn("", name);
  }
  int num_off = 0;
  for (const double alpha : {20.0, 1000.0}) {
    for (const int parts : {1, 2, 4, 8}) {
      const LloydView view = {1.0, alpha, M_PI / 6.0};
      std::vector<std::string> cells = {absl::StrFormat("f/n = %g, parts %d", alpha, parts)};
      const auto add = [&](double behind, const auto& storage) {
        const std::vector<double> values = OverSuns(view, steps, storage);
        const double ratio = *std::max_element(values.begin(), values.end()) / behind;
        cells.push_back(absl::StrFormat("%.3f", ratio));
        num_off += ratio < kMost ? 0 : 1;
      };
      const auto by_depth = [&](Method method) {
        return [=](const MethodInput& input) { return DepthStorage(input, parts, method); };
      };
      add(BehindStorage(view, parts), by_depth(Method::kFocused));
      add(BehindStorage(view, parts), by_depth(Method::kLispsm));
      add(BehindFaceWarpStorage(view, parts), [&](const MethodInput& input) {
        return FaceStorage(input, parts, /*has_near_face=*/false);
      });
      table.AddRow(cells);
    }
  }
  std::printf("%s\n", table.Text().c_str());
  return num_off;
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): options are ours
  int steps = 24;
  bool check = false;
  std::string out;
  CLI::App app("Repeats figures 5, 6, 7, 10, 12 and 13 of Lloyd et al. 2006.");
  app.add_option("--steps", steps, "Suns from overhead to the horizon")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--out", out, "Folder for the charts, lloyd5.png ... lloyd13.png");
  app.add_flag("--check", check, "Fail when a number is off");
  CLI11_PARSE(app, argc, argv);
  std::vector<lightfit::LloydDisc> discs;
  int num_off = lightfit::PrintFigure5() + lightfit::PrintFigure6();
  num_off += lightfit::PrintFigure7(steps, &discs);
  num_off += lightfit::PrintFigure10() + lightfit::PrintFigure12() + lightfit::PrintFigure13();
  num_off += lightfit::PrintWorstLights(steps);
  std::printf("%d numbers off\n", num_off);
  if (!out.empty()) {
    std::error_code error;
    std::filesystem::create_directories(out, error);
    const absl::Status status = lightfit::DrawLloydFigures(out, discs, steps);
    if (!status.ok()) {
      std::fprintf(stderr, "lloyd: %s\n", std::string(status.message()).c_str());
      return 1;
    }
  }
  return check && num_off > 0 ? 1 : 0;
}
