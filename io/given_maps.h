// io/given_maps.h
//
// Shadow maps that somebody else set up, from JSON files: to be judged beside ours.
// In:   a result of `lightfit fit` (a matrix or a plan for each light by name), or one matrix:
//         {"map_from_world": M, "map": {"width": 1024, "height": 1024}}   texels, or
//         {"clip_from_world": M, "clip": "direct3d"}                      a renderer's
//       with M as 16 numbers, as 4 rows of 4, or as {"m": [16 numbers]}; row-major, column vectors;
//       and "border": "dark" where look-ups outside the map find shadow, else they find light.
// Out:  GivenSetUp: single matrices in the texels of the map that they are to be compared in, as
//       plans of one; plans with the sizes, the border and the guard that the file says.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "geometry/light.h"
#include "geometry/map_size.h"
#include "partition/plan.h"

namespace lightfit {

struct GivenMaps {
  Plan plan;
  double guard_texels = 0.0;  // as PlanLookUp has it
};

struct GivenSetUp {
  std::string name;  // of the row

  std::optional<GivenMaps> for_every_light;
  std::map<std::string, GivenMaps> by_light;  // light name to maps

  std::string path = "";  // for errors; empty: of no file

  // NotFound says which lights there are, InvalidArgument which map is not one of the light.
  absl::StatusOr<GivenMaps> Of(const Light& light) const;
};

// `map` is the size to compare in: single matrices of maps of another size are scaled to it, a
// light's "plan", of one map too, keeps its sizes. Without "map" a single map_from_world is in its
// texels already; without "clip" a clip_from_world is Vulkan's. Only rows 1, 2 and 4 count.
absl::StatusOr<GivenSetUp> ParseGivenMaps(const std::string& name,
                                          absl::string_view json,
                                          MapSize map);
absl::StatusOr<GivenSetUp> ReadGivenMaps(const std::string& name,
                                         const std::string& path,
                                         MapSize map);

}  // namespace lightfit
