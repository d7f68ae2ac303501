// jobs/tune/json.h
//
// Tuned matrices as lightfit.v1.FitResult: the file that `lightfit fit` writes, with
// LightResult.tuning.
// In:   TunedLights and what they were made from.
// Out:  the message; wire/result_json.h writes it.
#pragma once

#include <string>

#include "absl/types/span.h"
#include "geometry/clip.h"
#include "jobs/compare/stage.h"
#include "jobs/tune/tune.h"
#include "lightfit/v1/result.pb.h"

namespace lightfit {

v1::FitResult TunedToProto(const std::string& source,
                           const CompareStage& stage,
                           const TuneOptions& options,
                           ClipConvention clip,
                           absl::Span<const TunedLight> lights);

}  // namespace lightfit
