// wire/map_sides_proto.h
//
// The sizes that maps may have, in messages.
// In:   MapSizeRules; or lightfit.v1.MapSizeRules of allocations and lightfit.v1.MapSides of plans,
//       which have the same fields.
// Out:  the one of the other.
#pragma once

#include "optimizer/sizing/map_sizes.h"

namespace lightfit {

template <typename Proto>
Proto MapSidesToProto(const MapSizeRules& rules) {
  Proto proto;
  proto.set_multiple(rules.multiple);
  proto.set_powers_of_two(rules.powers_of_two);
  proto.set_min_side(rules.min_side);
  proto.set_max_side(rules.max_side);
  return proto;
}

// Sides and multiples that are 0 are the defaults. ValidateMapSizeRules() is the caller's to ask.
template <typename Proto>
MapSizeRules MapSidesFromProto(const Proto& proto) {
  MapSizeRules rules;
  if (proto.multiple() != 0) rules.multiple = proto.multiple();
  rules.powers_of_two = proto.powers_of_two();
  if (proto.min_side() != 0) rules.min_side = proto.min_side();
  if (proto.max_side() != 0) rules.max_side = proto.max_side();
  return rules;
}

}  // namespace lightfit
