// jobs/compare/json.h
//
// A comparison as lightfit.v1.Comparison, and as a JSON file.
// In:   LightComparisons and what they were made from.
// Out:  the message; a text file, the same bytes for the same comparison.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "jobs/compare/rows.h"
#include "jobs/compare/stage.h"
#include "lightfit/v1/comparison.pb.h"

namespace lightfit {

v1::Comparison ComparisonToProto(const std::string& source,
                                 const CompareStage& stage,
                                 const CompareOptions& options,
                                 absl::Span<const LightComparison> lights);

// Replaces `path` in one step, see WriteTextFileAtomically().
absl::Status WriteComparisonJson(const std::string& path, const v1::Comparison& comparison);

}  // namespace lightfit
