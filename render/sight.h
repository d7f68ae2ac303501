// render/sight.h
//
// Whether a camera stands where somebody would put it.
// In:   a RayCaster, what the camera sees of it.
// Out:  an error, a warning, or nothing to complain of.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "render/ray_caster.h"
#include "render/surface_image.h"

namespace lightfit {

// What is wrong with what the camera sees: nothing at all or a surface that its eye touches (an
// error), or a sight that suggests an eye inside an object (a warning, empty when there is none).
absl::StatusOr<std::string> CheckSight(const RayCaster& caster, const SurfaceImage& image);

}  // namespace lightfit
