#include "calls/finished_result.h"

#include "wire/proto_json.h"

namespace lightfit {

absl::StatusOr<v1::FitResult> FinishedResult(const FitReport& report,
                                             const std::vector<RequestLight>& lights) {
  v1::FitResult result = FitResultToProto(report);
  for (size_t i = 0; i < lights.size(); ++i) {
    if (!lights[i].status.ok()) result.mutable_lights(static_cast<int>(i))->clear_light();
  }
  if (absl::Status status = CheckFinite(result, "result"); !status.ok()) return status;
  return result;
}

}  // namespace lightfit
