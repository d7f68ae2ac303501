// methods/focused.h
//
// The focused map: unwarped, tight around what is in view. What the warping methods fall back to.
// In:   MethodInput.
// Out:  the map of the rectangle around the body as the light sees it.
//
// Chong & Gortler 2007, 3: the view frustum is projected onto the light's near plane, intersected
// with the light frustum's extent there, and enclosed in a rectangle of least area. Here the body
// is intersected in space, which is never larger, and a point light's image plane lies across the
// middle of the body's rays, as where a spot light is aimed at what is in view.
//
// Nothing in view: the standard map, and the note says so.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "methods/method.h"

namespace lightfit {

struct FocusedOptions {
  // The rectangle of least area. Otherwise its sides lie along and across the view as the light
  // sees it, v along: what the warps turn into as they fade, and what OGRE fits.
  bool min_area_rotation = true;
};

absl::StatusOr<MethodMap> FocusedMap(const MethodInput& input, const FocusedOptions& options = {});

// FocusedMap() in place of another method, which the note begins with: "focused: <why>".
absl::StatusOr<MethodMap> FocusedInstead(const MethodInput& input, const std::string& why);

}  // namespace lightfit
