// picture/compare_page.h
//
// The shadow images of all methods for one light, side by side, wrong pixels marked; under each the
// same crop enlarged.
// In:   a CompareStage with truth, and a LightComparison with its images.
// Out:  a Canvas. First the truth, then lightfit, then the others from the fewest wrong pixels up;
// of
//       methods without maps a line says why.
#pragma once

#include <string>

#include "jobs/compare/rows.h"
#include "jobs/compare/stage.h"
#include "picture/canvas.h"
#include "picture/compare_choice.h"
#include "picture/text.h"

namespace lightfit {

struct ComparePictureOptions {
  std::string title;       // the scene's name
  std::string maps;        // of every method: "map 400 x 400 texels"
  bool has_plans = false;  // whether methods may have several maps
  int phases = 1;          // that counts are means over; shadows are those of the first
  Bias bias = Bias::kIdeal;
};

Canvas DrawComparePicture(const CompareStage& stage,
                          const LightComparison& light,
                          const ComparePictureOptions& options,
                          const Typeface& typeface);

}  // namespace lightfit
