// wire/map_sides_proto.h
//
// MapSizeRules to and from lightfit.v1.MapSizeRules of allocations and lightfit.v1.MapSides of
// plans, which have the same fields.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
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

// Sides and multiples that are 0 are the defaults. InvalidArgument names the field, as
// "rules.min_side = ...".
template <typename Proto>
absl::StatusOr<MapSizeRules> MapSidesFromProto(const Proto& proto, double margin_texels) {
  MapSizeRules rules;
  if (proto.multiple() != 0) rules.multiple = proto.multiple();
  rules.powers_of_two = proto.powers_of_two();
  if (proto.min_side() != 0) rules.min_side = proto.min_side();
  if (proto.max_side() != 0) rules.max_side = proto.max_side();
  if (absl::Status status = ValidateMapSizeRules(rules, margin_texels); !status.ok()) return status;
  return rules;
}

}  // namespace lightfit
