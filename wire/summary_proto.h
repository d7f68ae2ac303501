// wire/summary_proto.h
//
// SummarySet from and to lightfit.v1.SummaryFile.
// In:   a set; or a message that may come from anywhere.
// Out:  the message, the same for the same sums; or a set whose every value was checked.
#pragma once

#include "absl/status/statusor.h"
#include "lightfit/v1/summary.pb.h"
#include "wire/summary_set.h"

namespace lightfit {

v1::SummaryFile SummarySetToProto(const SummarySet& set);
v1::LightSummary LightSummaryToProto(const LightSummary& light);

// InvalidArgument names the field and says what it should be. Refused is what no sum of read-backs
// can be, and what this version does not know: fields, words of enumerations.
absl::StatusOr<SummarySet> SummarySetFromProto(const v1::SummaryFile& proto);

}  // namespace lightfit
