// calls/request_fields.h
//
// Fields that several requests have.
// In:   their messages.
// Out:  what the library takes; InvalidArgument names the field.
#pragma once

#include <Eigen/Core>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/clip.h"
#include "lightfit/v1/result.pb.h"
#include "lightfit/v1/service.pb.h"
#include "optimizer/fit_options.h"
#include "wire/matrix_proto.h"

namespace lightfit {

// FitRequest.map and its like, with room for the options' margin.
absl::StatusOr<MapSize> MapSizeOfRequest(const v1::MapSize& map, const FitOptions& options);

// FitRequest.clip and its like. Absent: Vulkan's.
template <typename Request>
absl::StatusOr<ClipConvention> ClipOfRequest(const Request& request) {
  if (!request.has_clip()) return ClipConvention::Vulkan();
  return ClipConventionFromProto(request.clip(), "clip");
}

// Texels of a map of the candidate's own size, which is `map`.
absl::StatusOr<Eigen::Matrix4d> MapFromWorldOf(const v1::CandidateMatrix& candidate, MapSize map);

// What a call returns whose CallContext::stop says stop.
absl::Status StoppedError();

}  // namespace lightfit
