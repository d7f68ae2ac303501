// optimizer/readback/sample_options.h
//
// Which pixels of the read-back count, and how much.
#pragma once

#include "absl/status/status.h"

namespace lightfit {

struct SampleOptions {
  // A pixel is rejected as lying on a depth discontinuity when the second difference of affine
  // depth exceeds this share of the larger first difference, along x or y. In (0, 1].
  // Chong & Gortler 2.4 threshold the "acceleration in z"; no number is given there.
  double max_depth_bend = 0.5;

  // ... unless the second difference is below this share of the depth itself: a surface facing the
  // camera has first differences near zero, where their ratio is only rounding noise. >= 0.
  double depth_noise = 1e-5;

  // Whether pixels at a depth discontinuity count as well: shadow edges run along outlines, and on
  // thin things there is nothing else. Their derivative is that of the side that continues.
  bool use_outlines = true;

  // Whether a shadow's border with surfaces that are turned away from the light counts as an edge.
  // Nothing is lit on either side of it.
  bool use_terminators = false;

  // Surfaces closer to edge-on than this are rejected: cosine between the surface normal and the
  // direction to the light, or to the eye. In [0, 1). Under a low sun the whole floor is nearly
  // edge-on to the light, and where its shadows lie.
  double min_cos_light = 0.002;
  double min_cos_eye = 0.01;

  // Fewer boundary samples than this are not searched for: the optimum would serve one corner of
  // one shadow. They get the focused map, StopReason::kTooFewSamples. >= 1.
  int min_samples = 8;

  // Half width of the window, in pixels, over which the direction of a shadow edge is estimated
  // (the metrics across the edge only). 1 ... 8.
  int edge_window = 2;

  bool operator==(const SampleOptions&) const = default;
};

// InvalidArgument names the field as options.samples.FIELD.
absl::Status ValidateSampleOptions(const SampleOptions& options);

}  // namespace lightfit
