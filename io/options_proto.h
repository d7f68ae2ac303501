// io/options_proto.h
//
// FitOptions as lightfit.v1.FitOptions, every field set.
#pragma once

#include "lightfit/v1/options.pb.h"
#include "optimizer/fit_options.h"

namespace lightfit {

v1::FitOptions FitOptionsToProto(const FitOptions& options);

}  // namespace lightfit
