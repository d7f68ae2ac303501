// jobs/add_summaries.h
//
// Summaries added up, for the service and for the command line.
// In:   sets, each with the name of its file or field.
// Out:  their sum; which two have the same frame; what people should know of it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "wire/summary_set.h"

namespace lightfit {

class SummaryAdder {
 public:
  // InvalidArgument, and the sum as it was: the set does not go with those before (its name goes
  // before the message), or has a frame that another one has too, and then both are named.
  absl::Status Add(const std::string& name, const SummarySet& set);

  const std::optional<SummarySet>& sum() const { return sum_; }

  // Frames of which nobody knows which they are, and numbers that several frames have.
  std::vector<std::string> Notes() const;

 private:
  std::optional<SummarySet> sum_;
  std::vector<std::pair<std::string, std::vector<FrameIdentity>>> added_;
};

}  // namespace lightfit
