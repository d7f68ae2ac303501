// calls/request_lights.h
//
// The lights of a request, those that cannot be used apart.
// In:   repeated v1::Light.
// Out:  lights with their shadow bits, and a status for each.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "lightfit/v1/light.pb.h"

namespace lightfit {

// InvalidArgument unless there are 1 to kMaxLights.
absl::Status CheckNumLights(int num_lights);

struct RequestLight {
  Light light;          // its name and shadow_bit when the status is not ok
  absl::Status status;  // InvalidArgument: this light cannot be used
};

// InvalidArgument as a whole without lights, with too many, and with names that are missing or
// taken, as results could not be told apart.
absl::StatusOr<std::vector<RequestLight>> LightsOfRequest(
    const google::protobuf::RepeatedPtrField<v1::Light>& lights);

}  // namespace lightfit
