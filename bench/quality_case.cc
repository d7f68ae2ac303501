#include "bench/quality_case.h"

#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "bench/matrix_check.h"
#include "optimizer/fit.h"

namespace lightfit {

FitOptions QualityObjective() {
  const FitOptions published = FitOptions::AsPublished();
  FitOptions options;
  options.samples = published.samples;
  options.metric = published.metric;
  options.cover = published.cover;
  return options;
}

std::vector<Method> QualityMethods() {
  FitOptions line_search = QualityObjective();
  line_search.search = Search::kRotationLineSearch;
  FitOptions refined = QualityObjective();
  refined.search = Search::kRotationLineSearchRefined;
  FitOptions focused = QualityObjective();
  focused.search = Search::kFocused;
  focused.affine = Affine::kMinAreaRectangle;
  focused.ray_space = RaySpace::kLightSpace;
  return {{"default", QualityObjective()},
          {"line_search_refined", refined},
          {"line_search", line_search},
          {"as_published", FitOptions::AsPublished()},
          {"focused", focused}};
}

double QualityCase::EnergyOf(const std::string& method) const {
  for (const MethodResult& result : results) {
    if (result.method == method) return result.energy;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

absl::StatusOr<QualityCase> MeasureQuality(const std::string& input,
                                           const Readback& readback,
                                           const Light& light,
                                           MapSize map,
                                           const BruteForceOptions& brute_force) {
  absl::StatusOr<Summary> summary = Summarize(readback, light, QualityObjective());
  if (!summary.ok()) return summary.status();
  if (summary->counts.used < QualityObjective().samples.min_samples) {
    return absl::FailedPreconditionError(
        absl::StrCat("light \"", light.name, "\": ", summary->counts.used, " samples"));
  }
  absl::StatusOr<MatrixCheck> check =
      MatrixCheck::Create(readback, light, QualityObjective().samples);
  if (!check.ok()) return check.status();

  QualityCase result;
  result.input = input;
  result.light = light.name;
  result.map = map;
  result.num_samples = static_cast<int>(summary->counts.used);
  double energy_start = 0.0;
  for (const Method& method : QualityMethods()) {
    const absl::StatusOr<LightMatrix> matrix = FitLight(readback, light, map, method.options);
    if (!matrix.ok()) {
      // Where one method finds a map all must.
      if (result.results.empty()) return matrix.status();
      return absl::InternalError(absl::StrCat(method.name, ": ", matrix.status().message()));
    }
    const MatrixQuality quality = check->Measure(matrix->map_from_world, map);
    result.results.push_back({method.name,
                              quality.energy,
                              matrix->figures.energy,
                              quality.outside_texels,
                              matrix->search.evaluations});
    if (method.name == "default") energy_start = matrix->search.energy_start;
  }
  const double least = BruteForceFit(*summary, map, QualityObjective(), brute_force).energy;
  result.results.push_back({"start", energy_start, energy_start});
  result.results.push_back({"brute_force", least, least});
  return result;
}

}  // namespace lightfit
