// jobs/schemes/budget.h
//
// What all schemes that are held against one another may spend alike.
// In:   the size of a single map, how many maps there may be, and the filter's width.
// Out:  SchemeBudget, and the texels of it.
#pragma once

#include <cstdint>

#include "geometry/map_size.h"

namespace lightfit {

struct SchemeBudget {
  MapSize map;                // of a single map; all maps together have at most its texels
  int num_maps = 4;           // of schemes that can have any number
  double guard_texels = 0.0;  // as PlanLookUp: half the width of a filter

  int64_t texels() const { return int64_t{map.width} * map.height; }
};

}  // namespace lightfit
