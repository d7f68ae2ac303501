// optimizer/figures/foretell.h
//
// How many shadow pixels a matrix will get wrong, foretold from the read-back alone.
// In:   Readback, Light, a matrix and the size of its map.
// Out:  the share of the image's pixels that will be wrong, with nearest texels and an ideal bias.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "optimizer/readback/readback.h"
#include "optimizer/readback/sample_options.h"

namespace lightfit {

// A pixel is shadowed as the centre of its texel is, which lies up to half a texel away: at
// J_screen_map delta on the screen, delta anywhere in [-1/2, 1/2]^2. Foretold is the mean over
// delta and over pixels of the difference between the pixel's shadow bit and the read-back's bits,
// interpolated on the same surface, at that place; and all dark pixels outside the map. To first
// order, for edges that are straight and far apart, that is math.md (12); where texels are larger
// than shadows it stays below twice their area.   math.md (13)
//
// In 0 ... 1. Compared with what exact ray casting measures the figure is right within a factor of
// two or so from scene to scene, and ranks matrices on one image better than that
// (docs/defaults.md). InvalidArgument for a read-back, light or matrix that cannot be used;
// CancelledError once a StopScope says so.
absl::StatusOr<double> ForetellWrongShare(const Readback& readback,
                                          const Light& light,
                                          const Eigen::Matrix4d& map_from_world,
                                          MapSize map,
                                          const SampleOptions& options = {});

}  // namespace lightfit
