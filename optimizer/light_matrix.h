// optimizer/light_matrix.h
//
// The result of a fit: one matrix for one light, and how good it is.
#pragma once

#include <Eigen/Core>
#include <string>

#include "base/scratch.h"
#include "geometry/border.h"
#include "geometry/map_size.h"
#include "optimizer/figures/figures.h"
#include "optimizer/readback/readback.h"
#include "optimizer/search/search_result.h"

namespace lightfit {

struct LightMatrix {
  ScratchString light_name;
  MapSize map;

  // What a look-up outside the map must find. The matrix is of no use with the other.
  Border border = Border::kLit;

  // How the fit knew which surfaces face the light.
  FacingSource facing = FacingSource::kGuessed;

  // Homogeneous (u w, v w, z w, w) of a world point: u, v in texels, (0, 0) the first texel's
  // corner, z in [0, 1] over the receivers, w > 0 on every receiver. Column vectors. In the middle
  // of the rays w is 1 for a directional light, and the distance along them for a point light.
  Eigen::Matrix4d map_from_world = Eigen::Matrix4d::Identity();

  // Over the samples of the fit's own options; the energy is what was minimised.
  Figures figures;
  SearchReport search;

  // "sun: 1024x1024, energy 12.3 (start 20.1), rms 0.12 px, worst 0.8 px, converged"
  std::string BriefReport() const;
};

}  // namespace lightfit
