// wire/options_proto.h
//
// FitOptions as lightfit.v1.FitOptions, every field set, and back; the same of MapSizeRules.
#pragma once

#include "absl/status/statusor.h"
#include "lightfit/v1/options.pb.h"
#include "optimizer/fit_options.h"
#include "optimizer/sizing/map_sizes.h"

namespace lightfit {

v1::FitOptions FitOptionsToProto(const FitOptions& options);

// What is absent or unspecified keeps its default. InvalidArgument names the field when its word is
// not one that this version knows, or its value is out of range.
absl::StatusOr<FitOptions> FitOptionsFromProto(const v1::FitOptions& proto);

v1::MapSizeRules MapSizeRulesToProto(const MapSizeRules& rules);

// Sides and multiples that are 0 are the defaults. InvalidArgument names the field, as
// "rules.min_side = ...".
absl::StatusOr<MapSizeRules> MapSizeRulesFromProto(const v1::MapSizeRules& proto,
                                                   double margin_texels);

}  // namespace lightfit
