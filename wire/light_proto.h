// wire/light_proto.h
//
// Light from and to lightfit.v1.Light, and lists of lights.
// In:   a light; or a message that may come from anywhere.
// Out:  the message; or lights that are valid and have names of their own.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "geometry/light.h"
#include "lightfit/v1/light.pb.h"

namespace lightfit {

absl::StatusOr<Light> LightFromProto(const v1::Light& proto);
v1::Light LightToProto(const Light& light);

// As ValidateLight(), and that it has a name of reasonable length.
absl::Status ValidateNamedLight(const Light& light);

// InvalidArgument: more than kMaxLights.
absl::Status TooManyLightsError(int64_t count);

// InvalidArgument: an earlier light has its name.
absl::Status NameTakenError(const Light& light);

// Distinct names, at most kMaxLights, each of them valid.
absl::Status ValidateLights(absl::Span<const Light> lights);

}  // namespace lightfit
