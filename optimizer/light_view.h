// optimizer/light_view.h
//
// One light in one read-back: made once, and all that is asked about the light is asked of it.
// In:   Surfaces, a Light, FitOptions that say which samples count and what the map must cover.
// Out:  LightView {cover, samples}; optimizer/fit.h and optimizer/evaluate.h ask it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>

#include "absl/status/statusor.h"
#include "geometry/light.h"
#include "optimizer/energy/summary.h"
#include "optimizer/fit_options.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"

namespace lightfit {

// For a dark border samples are told from terminators by the third state, where it is known. For a
// lit one they are by the depth's normals even so: those that these take for edges by mistake are
// where dark surfaces meet ones turned away, which is where wrong pixels are in rooms that are
// mostly dark, and without them a map would serve its few lit patches alone (docs/defaults.md).
struct LightView {
  const Surfaces* surfaces;  // must outlive the view, as must the light
  const Light* light;

  SampleOptions sample_options;  // that `samples` were chosen by
  Border border;                 // that `cover` and `samples` are for

  // What the map must have room for, or why no single map has: FailedPrecondition as
  // CoverReceivers(). Somebody's matrix can be judged all the same.
  absl::StatusOr<RayCover> cover;

  // In the cover's normalised rays, which keep precision however far the light is; in light space
  // where there is no cover, as receivers surround the light and it is near enough for that. May be
  // none. They have edge normals where FitOptions::metric counts what lies across edges.
  Samples samples;

  FacingSource facing() const { return surfaces->readback.FacingOf(light->shadow_bit); }

  Eigen::Matrix3d normalized_from_ray() const {
    return cover.ok() ? cover->normalized_from_ray : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  }
};

// Here and below: CancelledError once a StopScope says so.

// Of `options` count `samples`, `cover`, `border` (lit where it is kAutomatic: ViewLight(...,
// Border)) and whether `metric` needs edge normals. InvalidArgument
// for a light that cannot be used, or samples that the surfaces were not found for
// (FindSurfaces()).
absl::StatusOr<LightView> ViewLight(const Surfaces& surfaces,
                                    const Light& light,
                                    const FitOptions& options);
absl::StatusOr<LightView> ViewLight(const Surfaces& surfaces,
                                    const Light& light,
                                    Border border,
                                    const FitOptions& options);

// InvalidArgument for options that the view was not made with, but for the cover and min_samples:
// figures would be of other samples than was asked, and nobody could tell. All that take a view
// ask.
absl::Status CheckServes(const LightView& view, const FitOptions& options);

// The samples summed up in the metric. Requires view.cover.ok().
Summary SummaryOfView(const LightView& view, const FitOptions& options);

// What `ask` says of the light's view in a read-back that nobody else asks: the calls on a
// read-back are this around those on a view. Errors are also those of options, light and read-back.
template <typename Ask>
auto AskView(const Readback& readback,
             const Light& light,
             const FitOptions& options,
             const Ask& ask) -> decltype(ask(std::declval<const LightView&>())) {
  if (absl::Status status = ValidateFitOptions(options); !status.ok()) return status;
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  const absl::StatusOr<Surfaces> surfaces =
      FindSurfaces(readback, uint32_t{1} << light.shadow_bit, options.samples);
  if (!surfaces.ok()) return surfaces.status();
  const absl::StatusOr<LightView> view = ViewLight(*surfaces, light, options);
  if (!view.ok()) return view.status();
  return ask(*view);
}

}  // namespace lightfit
