// bench/published/lloyd_figures.h
//
// The charts of Lloyd et al. 2006, figures 5, 6, 7, 10, 12 and 13, drawn from the corrected
// equations; figure 7 from storage factors that were measured.
// In:   storage factors over the suns above the viewer; a folder.
// Out:  lloyd5.png ... lloyd13.png there.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"

namespace lightfit {

// One disc of figure 7: a value for each of SunsAbove(steps), in that order.
struct LloydDisc {
  std::string name;
  std::vector<double> storage;
};

absl::Status DrawLloydFigures(const std::string& folder,
                              const std::vector<LloydDisc>& discs,
                              int steps);

}  // namespace lightfit
