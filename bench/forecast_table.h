// bench/forecast_table.h
//
// How well wrong pixels are foretold.
// In:   per scene and light the measured and the foretold wrong pixels of several matrices.
// Out:  text: scatter over lights, between the matrices of one light, and how many pairs are ranked
//       wrongly.
#pragma once

#include <string>
#include <vector>

namespace lightfit {

class ForecastTable {
 public:
  struct Pixels {
    double measured = 0.0, foretold = 0.0;
  };

  // `rows` of one light, always the same matrices in the same order; `ours` is the row that scatter
  // over lights is of. Lights on which it has fewer than 30 wrong pixels tell nothing and are left
  // out.
  void Add(const std::string& scene, const std::vector<Pixels>& rows, size_t ours);

  // One line for each scene, in the order they came, and one for all lights.
  std::string Text(const std::string& title) const;

 private:
  struct Light {
    std::string scene;
    std::vector<Pixels> rows;
    size_t ours;
  };
  std::vector<Light> lights_;
};

}  // namespace lightfit
