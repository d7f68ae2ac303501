// jobs/schemes/asked_maps.h
//
// Which of a light's maps each pixel of an image asks.
// In:   SchemeMaps, a light, what the camera sees.
// Out:  a number for each pixel, for pictures.
#pragma once

#include <vector>

#include "geometry/light.h"
#include "jobs/schemes/scheme.h"
#include "render/surface_image.h"

namespace lightfit {

// Row-major: the map in the plan, the half of a pair, the level of a page from the finest that is
// there; -1 for the background, and where no map may be asked. Of valid maps (ValidateMaps()).
std::vector<int> AskedMaps(const SchemeMaps& maps, const Light& light, const SurfaceImage& image);

}  // namespace lightfit
