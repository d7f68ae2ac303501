// io/given_matrices.h
//
// Light matrices that somebody else made, from JSON files: to be judged beside ours.
// In:   a result of `lightfit fit` (a matrix for each light by name), or one matrix:
//         {"map_from_world": M, "map": {"width": 1024, "height": 1024}}   texels, or
//         {"clip_from_world": M, "clip": "direct3d"}                      a renderer's
//       with M as 16 numbers, as 4 rows of 4, or as {"m": [16 numbers]}; row-major, column vectors;
//       and "border": "dark" where look-ups outside the map find shadow, else they find light.
//       Plans of several maps are refused.
// Out:  GivenMatrices, in the texels of the map that they are to be compared in.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "geometry/border.h"
#include "geometry/map_size.h"

namespace lightfit {

struct GivenMatrix {
  Eigen::Matrix4d map_from_world;
  Border border = Border::kLit;  // what look-ups outside the map find
};

struct GivenMatrices {
  std::string name;  // of the row

  std::optional<GivenMatrix> for_every_light;
  std::map<std::string, GivenMatrix> by_light;  // light name to matrix

  // NotFound says which lights there are.
  absl::StatusOr<GivenMatrix> Of(const std::string& light) const;
};

// `map` is the size to compare in: matrices of maps of another size are scaled to it. Without "map"
// a single map_from_world is in its texels already; without "clip" a clip_from_world is Vulkan's.
// Only rows 1, 2 and 4 count.
absl::StatusOr<GivenMatrices> ParseGivenMatrices(const std::string& name,
                                                 absl::string_view json,
                                                 MapSize map);
absl::StatusOr<GivenMatrices> ReadGivenMatrices(const std::string& name,
                                                const std::string& path,
                                                MapSize map);

}  // namespace lightfit
