// render/shipped/texel_grid.h
//
// Equal square maps whose texels are counted on, with a texel more on every side.
// In:   side and number of the maps.
// Out:  the number of a texel, and the texel of a number.
//
// The phases of a judge move maps by parts of a texel. Where maps meet without an end, as two
// paraboloids or the pages of a level do, a receiver that is moved over the edge of its own map is
// still served: it asks the texel beyond, whose centre has a ray like any other.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lightfit {

struct TexelGrid {
  struct Texel {
    int map = 0, column = 0, row = 0;  // -1 <= column, row <= side
  };

  int side = 0;  // texels of a map, without the one more
  int num_maps = 0;

  int stride() const { return side + 2; }
  int64_t num_texels() const { return int64_t{num_maps} * stride() * stride(); }

  // At a place of a map, texels; one further off than the texels on the sides asks one of these.
  int32_t NumberAt(int map, const Eigen::Vector2d& place) const {
    const auto whole = [this](double x) {
      return static_cast<int>(std::clamp(std::floor(x), -1.0, static_cast<double>(side)));
    };
    return NumberOf({map, whole(place.x()), whole(place.y())});
  }

  int32_t NumberOf(const Texel& texel) const {
    return (texel.map * stride() + texel.row + 1) * stride() + texel.column + 1;
  }

  Texel TexelOf(int32_t number) const {
    const int row = number / stride();
    return {row / stride(), number % stride() - 1, row % stride() - 1};
  }

  static Eigen::Vector2d CentreOf(const Texel& texel) {
    return {texel.column + 0.5, texel.row + 0.5};
  }
};

}  // namespace lightfit
