// wire/options_proto.h
//
// FitOptions as lightfit.v1.FitOptions, every field set, and back.
#pragma once

#include "absl/status/statusor.h"
#include "lightfit/v1/options.pb.h"
#include "optimizer/fit_options.h"

namespace lightfit {

v1::FitOptions FitOptionsToProto(const FitOptions& options);

// What is absent or unspecified keeps its default. InvalidArgument names the field when its word is
// not one that this version knows, or its value is out of range.
absl::StatusOr<FitOptions> FitOptionsFromProto(const v1::FitOptions& proto);

}  // namespace lightfit
