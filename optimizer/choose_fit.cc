#include "optimizer/choose_fit.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/stop.h"
#include "optimizer/figures/foretell.h"
#include "optimizer/fit.h"
#include "optimizer/light_view.h"

namespace lightfit {

namespace {

// The best fit so far, by what is foretold over the samples that were asked for.
class Choice {
 public:
  Choice(const Surfaces& surfaces, const Light& light, MapSize map, const SampleOptions& samples)
      : surfaces_(surfaces), light_(light), map_(map), samples_(samples) {}

  // Takes the fit instead of the best so far if `below` of that one's forecast exceeds its own; a
  // dark border instead of a lit one only below kDarkBorderBelow.
  void Try(Border border, FitOptions options, double below = 1.0) {
    options.border = BorderChoice::kAutomatic;  // that of the view
    absl::StatusOr<LightMatrix> matrix = Foretold(border, options);
    if (!best_.has_value() || !best_->ok()) {
      if (!best_.has_value() || matrix.ok()) best_ = std::move(matrix);
      return;
    }
    if (!matrix.ok()) return;
    if (border == Border::kDark && (*best_)->border == Border::kLit) {
      below = std::min(below, kDarkBorderBelow);
    }
    if (*matrix->figures.wrong_share < below * *(*best_)->figures.wrong_share) {
      best_ = std::move(matrix);
    }
  }

  absl::StatusOr<LightMatrix> Best() && { return *std::move(best_); }

 private:
  absl::StatusOr<LightMatrix> Foretold(Border border, const FitOptions& options) const {
    const absl::StatusOr<LightView> view = ViewLight(surfaces_, light_, border, options);
    if (!view.ok()) return view.status();
    absl::StatusOr<LightMatrix> matrix = FitLight(*view, map_, options);
    if (!matrix.ok()) return matrix;
    const absl::StatusOr<double> share = ForetellWrongShare(
        surfaces_.readback, light_, matrix->map_from_world, map_, samples_, matrix->border);
    if (!share.ok()) return share.status();
    matrix->figures.wrong_share = *share;
    return matrix;
  }

  const Surfaces& surfaces_;
  const Light& light_;
  MapSize map_;
  const SampleOptions& samples_;
  std::optional<absl::StatusOr<LightMatrix>> best_;
};

}  // namespace

absl::StatusOr<LightMatrix> FitByForecast(const Surfaces& surfaces,
                                          const Light& light,
                                          MapSize map,
                                          const FitOptions& options) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  const bool knows_facing = surfaces.readback.KnowsFacing(light.shadow_bit);
  Choice choice(surfaces, light, map, options.samples);
  FitOptions coarse = options;
  coarse.use_fine_cover = false;
  choice.Try(Border::kLit, coarse);
  if (knows_facing) choice.Try(Border::kDark, coarse);
  if (surfaces.readback.fine_cover != nullptr && options.use_fine_cover) {
    choice.Try(Border::kLit, options);
    if (knows_facing) choice.Try(Border::kDark, options);
  }
  // Who asks for a method gets it. By shadow bits alone other methods are ranked wrongly too often:
  // docs/defaults.md.
  if (knows_facing && options.search == Search::kGlobal) {
    choice.Try(Border::kLit, FitOptions::Focused(options), kPeerBelow);
    choice.Try(Border::kLit, FitOptions::AsPublished(options), kPeerBelow);
  }
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  return std::move(choice).Best();
}

Border BorderByForecast(const Surfaces& surfaces,
                        const Light& light,
                        MapSize map,
                        const FitOptions& options,
                        Border current) {
  if (!ValidateLight(light).ok() || !surfaces.readback.KnowsFacing(light.shadow_bit)) {
    return Border::kLit;
  }
  Choice choice(surfaces, light, map, options.samples);
  const Border other = current == Border::kLit ? Border::kDark : Border::kLit;
  choice.Try(current, options);
  choice.Try(other, options, kDarkBorderBelow);
  const absl::StatusOr<LightMatrix> best = std::move(choice).Best();
  return best.ok() ? best->border : current;
}

}  // namespace lightfit
