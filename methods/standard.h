// methods/standard.h
//
// The standard map: the whole light frustum, whatever the camera sees.
// In:   MethodInput; the camera plays no part.
// Out:  the map of the rectangle of least area around all receivers, unwarped.
//
// A directional light's map is orthographic. A point light's image plane is across the middle of
// the cone of rays to the box. FailedPrecondition when the box surrounds the light.
#pragma once

#include "absl/status/statusor.h"
#include "methods/method.h"

namespace lightfit {

absl::StatusOr<MethodMap> StandardMap(const MethodInput& input);

}  // namespace lightfit
