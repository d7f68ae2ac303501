// wire/result_json.h
//
// Results as lightfit.v1.FitResult, and as JSON files.
// In:   LightMatrix or LightPlan per light, with the energies of other methods to compare with.
// Out:  v1::FitResult; a JSON text file, the same bytes for the same result.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/camera.h"
#include "geometry/clip.h"
#include "geometry/light.h"
#include "lightfit/v1/result.pb.h"
#include "optimizer/evaluate.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "partition/fit_plan.h"
#include "partition/plan_options.h"
#include "wire/matrix_proto.h"

namespace lightfit {

// A plan and what it comes to.
struct PlanFit {
  LightPlan plan;
  Figures figures;  // of all its maps, judged as the yardsticks are
  double guard_texels = 0.0;
};

// One light's fit beside its yardsticks, all judged by EvaluateMatrix() with the same options.
struct LightFit {
  Light light;
  absl::StatusOr<LightMatrix> matrix = absl::UnknownError("not fitted");
  // Of a plan of several maps, where there is one, the answer instead of `matrix`; of one map
  // beside it, which is the same.
  std::optional<PlanFit> plan;
  std::optional<double> wrong_share;    // of `matrix`, foretold: 0 ... 1
  std::optional<Figures> focused;       // of the usual focused map: Search::kFocused
  std::optional<Figures> as_published;  // of FitOptions::AsPublished()
  std::optional<Figures> one_map;       // beside a plan: of a single map of as many texels
  std::optional<double>
      time_ms;  // only when asked for: results with times are never the same twice
};

// Makes the plan the light's answer; its only map, where it has one, is the light's matrix too.
void SetPlan(LightPlan plan, const Figures& figures, double guard_texels, LightFit* fit);

struct FitReport {
  std::string source;  // where the read-back came from, usually the file's name
  Camera camera;
  DepthKind depth_kind = DepthKind::kCameraZ;
  FitOptions options;
  std::optional<PlanOptions> plan_options;  // where plans were asked for
  MapSize map;                              // else
  ClipConvention clip = ClipConvention::Vulkan();
  std::vector<LightFit> lights;
};

v1::FitResult FitResultToProto(const FitReport& report);

// Parts of it. Median, p99 and worst footprint only `with_quantiles`.
v1::FootprintStatistics FootprintToProto(const FootprintStatistics& footprint, bool with_quantiles);
v1::FacingSource FacingSourceToProto(FacingSource source);
v1::SampleCounts SampleCountsToProto(const SampleCounts& counts);

// JSON with named fields in schema order and numbers that read back exactly. NaN and infinity are
// refused (an infinite far plane is left out instead).
absl::StatusOr<std::string> FitResultToJson(const v1::FitResult& result);

// Replaces `path` in one step: written under a temporary name in the same folder, then renamed.
absl::Status WriteFitResultJson(const std::string& path, const v1::FitResult& result);

absl::StatusOr<v1::FitResult> ReadFitResultJson(const std::string& path);

}  // namespace lightfit
