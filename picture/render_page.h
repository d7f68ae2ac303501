// picture/render_page.h
//
// What the camera sees under one light, with its exact shadows: a plain grey rendering.
// In:   surfaces and their true lighting.
// Out:  a Image of the image's size.
#pragma once

#include "absl/types/span.h"
#include "geometry/light.h"
#include "picture/image.h"
#include "render/surface_image.h"
#include "render/true_lighting.h"

namespace lightfit {

// Lit surfaces by the cosine between normal and light; the rest dark, with a little of the cosine
// towards the eye, so that shapes can be told in shadow.
Image DrawLighting(const SurfaceImage& image,
                   absl::Span<const Lighting> lighting,
                   const Light& light);

}  // namespace lightfit
