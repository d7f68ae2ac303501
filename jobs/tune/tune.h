// jobs/tune/tune.h
//
// The fit of one light tuned on the true wrong pixels: what is left to win where the scene is at
// hand.
// In:   a CompareStage with a scene, a light, options, a journal.
// Out:  TunedLight: the fit and the best map found around it, with the wrong pixels of both.
//
// All eight degrees of freedom of the map are searched from the fit on. The border stays that of
// the fit. Values are means over 4 phases of the map's texels (render/judge.h). As the least of
// many values that jump about is part luck, 49 other phases choose among the best few and the fit;
// and both maps are counted at 16 more in the end, which neither has seen.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "jobs/compare/stage.h"
#include "jobs/tune/journal.h"
#include "optimizer/fit_options.h"
#include "optimizer/light_matrix.h"
#include "render/judge.h"

namespace lightfit {

inline constexpr int kTunePhases = 4;
inline constexpr int kFinalPhases = 49;
inline constexpr int kCheckPhases = 16;

struct TuneOptions {
  MapSize map = {400, 400};
  FitOptions fit;
  Bias bias = Bias::kIdeal;      // whose wrong pixels are minimised
  double constant_share = 2e-4;  // JudgeOptions

  int evaluations = 600;  // of maps, each light; >= 1, the first is the fit
  uint64_t seed = 1;

  // Called after each evaluation with the least value so far; for a progress bar.
  std::function<void(double)> after_evaluation;
};

// InvalidArgument naming the option.
absl::Status ValidateTuneOptions(const TuneOptions& options);

// One map and its wrong pixels, of all pixels of the screen.
struct TunedMap {
  LightMatrix matrix;
  int64_t wrong = 0;               // at the phases that are tuned on
  int64_t check = 0;               // at kCheckPhases
  std::optional<double> foretold;  // share of wrong pixels foretold from the read-back
};

struct TunedLight {
  Light light;
  absl::Status status;  // why there is no matrix
  TunedMap fit;
  TunedMap tuned;  // the fit again, where nothing better was found
  int evaluations = 0;
};

// `number` is the light's in the journal. Fails as a whole, beside TunedLight::status, only when
// the journal cannot be written.
absl::StatusOr<TunedLight> TuneLight(const CompareStage& stage,
                                     const Light& light,
                                     const TuneOptions& options,
                                     int number,
                                     Journal* journal);

// What a journal's values depend on: scene, screen, lights, options and version, as a checksum. Not
// the number of evaluations: a larger one goes on.
std::string TuneKey(const CompareStage& stage,
                    absl::Span<const Light> lights,
                    const TuneOptions& options);

// How many times as many wrong pixels the fits have as the tuned maps, over the lights that have a
// matrix.
struct TuneTotals {
  int num_lights = 0;
  int64_t fit_wrong = 0, tuned_wrong = 0, fit_check = 0, tuned_check = 0;

  // Geometric means of (wrong + 1) / (tuned + 1), as MethodTotals::Pixels::mean_ratio.
  double mean_ratio = 1.0, mean_check_ratio = 1.0;
};
TuneTotals TotalsOf(absl::Span<const TunedLight> lights);

}  // namespace lightfit
