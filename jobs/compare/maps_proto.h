// jobs/compare/maps_proto.h
//
// What a method draws for a light, as a message.
// In:   SchemeMaps of any kind.
// Out:  lightfit.v1.MethodMaps: enough to draw and look up the maps elsewhere.
#pragma once

#include "jobs/schemes/scheme.h"
#include "lightfit/v1/comparison.pb.h"

namespace lightfit {

v1::MethodMaps MapsToProto(const SchemeMaps& drawn);

}  // namespace lightfit
