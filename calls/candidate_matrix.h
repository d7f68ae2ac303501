// calls/candidate_matrix.h
//
// A matrix that the caller set up.
// In:   v1::CandidateMatrix.
// Out:  map_from_world, texels of its own map.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "geometry/map_size.h"
#include "lightfit/v1/service.pb.h"

namespace lightfit {

// `map` is the candidate's. InvalidArgument names the field.
absl::StatusOr<Eigen::Matrix4d> MapFromWorldOf(const v1::CandidateMatrix& candidate, MapSize map);

}  // namespace lightfit
