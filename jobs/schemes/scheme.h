// jobs/schemes/scheme.h
//
// A way to set up the shadow maps of one light, by whomever: the rows that are held against one
// another.
// In:   what the camera sees, a light; what is known of them without casting a ray.
// Out:  Scheme: a name, and how its maps are made; SchemeMaps, what a light then has.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "geometry/border.h"
#include "geometry/light.h"
#include "methods/method.h"
#include "optimizer/readback/surfaces.h"
#include "partition/plan.h"
#include "partition/shipped/clipmap_pages.h"
#include "partition/shipped/paraboloid.h"

namespace lightfit {

// Filled by a rasteriser, which draws casters straight between their corners; a pair alone is
// filled by the rays of its texels.
struct RasterisedPair {
  ParaboloidPair pair;
};

struct SchemeMaps {
  // A single map is the plan of one.
  std::variant<Plan, ParaboloidPair, RasterisedPair, PagedMap> maps;

  double guard_texels = 0.0;  // of a plan, see PlanLookUp; the others filter in ways of their own
  std::string note = "";      // empty, or how the scheme fell back

  // In all than schemes may have: of plans that were made elsewhere.
  bool has_other_texels = false;
};

// Null where the maps are no matrices.
const Plan* PlanOf(const SchemeMaps& maps);

// The map of a plan of one; null for all else.
const PlanMap* OnlyMap(const SchemeMaps& maps);

// What receivers find that no map may be asked about. Nobody is outside of paraboloids.
Border BorderOf(const SchemeMaps& maps);

int NumMaps(const SchemeMaps& maps);  // halves and pages are maps
int64_t NumTexels(const SchemeMaps& maps);

// Whether a plan can be looked up, see PlanLookUp::Create(); all else is as its maker left it.
absl::Status ValidateMaps(const SchemeMaps& maps, const Light& light);

struct SchemeInput {
  const MethodInput& view;  // light and map are left open
  const absl::StatusOr<Surfaces>& surfaces;
  const Light& light;
};

struct Scheme {
  using SetUp = std::function<absl::StatusOr<SchemeMaps>(const SchemeInput&)>;

  std::string name;
  SetUp set_up;
};

}  // namespace lightfit
