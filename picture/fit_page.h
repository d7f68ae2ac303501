// picture/fit_page.h
//
// The picture of a fit: per light what the image and the map look like before and after.
// In:   the read-back, and per light the focused matrix and the final one.
// Out:  a Canvas, ready for WritePng().
//
// One row per light: the read-back coloured by the footprint of the focused map and of the fitted
// one, on one scale, then both maps with what lands in them. Of a plan: by that of the single map
// and of the plan, then which pixel asks which map, and what lands in each. A light without a
// matrix or plan has its message instead.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "jobs/fit_comparison.h"
#include "optimizer/readback/surfaces.h"
#include "picture/canvas.h"
#include "picture/text.h"

namespace lightfit {

struct PictureOptions {
  std::string title;          // usually the read-back's file name
  std::string maps;           // their sizes: "shadow map 1024 x 1024 texels"
  SampleOptions samples;      // as used by the fit
  std::string final_label;    // what "after" is, for the panel titles: "lightfit", "as published"
  double guard_texels = 0.0;  // of plans
  bool has_plans = false;     // whether plans were asked for
};

absl::StatusOr<Canvas> DrawPicture(const Surfaces& surfaces,
                                   const std::vector<FitComparison>& lights,
                                   const PictureOptions& options,
                                   const Typeface& typeface);

}  // namespace lightfit
