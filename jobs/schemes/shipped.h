// jobs/schemes/shipped.h
//
// Schemes that engines ship: cascades of a sun, its pages, cubes and paraboloids of a lamp.
// In:   a budget.
// Out:  Schemes; those for the other kind of light say so when they are set up.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "jobs/schemes/budget.h"
#include "jobs/schemes/scheme.h"
#include "partition/shipped/cube_faces.h"

namespace lightfit {

// Of a sun or a lamp: "stable4", "SDSM4".
std::vector<Scheme> CascadeSchemes(const SchemeBudget& budget);

// Of a sun: the pages of a virtual shadow map, of 128 x 128 texels each where the budget has four
// of these, else of the largest power of two.
Scheme PagesScheme(const std::string& name, const SchemeBudget& budget);

// Of a lamp. Faces are looked up without a guard, as hardware filters across their edges.
Scheme CubeScheme(const std::string& name,
                  const CubeFacesOptions& options,
                  const SchemeBudget& budget);

// Of a lamp: without a normal the plane between the halves is where footprints are least.
enum class PairFill { kByRays, kByRaster };
Scheme PairScheme(const std::string& name,
                  const std::optional<Eigen::Vector3d>& normal,
                  PairFill fill,
                  const SchemeBudget& budget);

// All of them: cascades, "pages", "cube", "cube, turned", "paraboloids", "paraboloids, drawn".
std::vector<Scheme> ShippedSchemes(const SchemeBudget& budget);

}  // namespace lightfit
