#include "bench/plans/draw_lamp.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "methods/view_body.h"
#include "optimizer/light_view.h"
#include "render/clearance.h"
#include "render/generator/dice.h"

namespace lightfit {

namespace {

// Distance from the eye: half of what is seen is nearer.
double MedianDistance(const SurfaceImage& image) {
  std::vector<double> distances;
  for (const SurfacePoint& pixel : image.pixels) {
    if (!pixel.is_surface()) continue;
    distances.push_back((pixel.position - EyePosition(image.camera)).norm());
  }
  if (distances.empty()) return 0.0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

}  // namespace

bool HasSingleMap(const LitStage& lit, Cover cover) {
  FitOptions options;
  options.cover = cover;
  const absl::StatusOr<LightView> view = ViewLight(**lit.surfaces, lit.light, options);
  return view.ok() && view->cover.ok();
}

std::optional<LitStage> DrawLamp(const CompareStage& stage,
                                 const std::string& name,
                                 uint64_t seed) {
  constexpr int kAttempts = 100;
  const double least_clearance = 2e-3 * stage.caster->bounds().diagonal().norm();
  const SurfaceImage& image = stage.readback_surfaces;
  const int width = image.camera.width, height = image.camera.height;
  const Eigen::Vector3d eye = EyePosition(image.camera);
  const double median = MedianDistance(image);
  Dice dice(seed);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const int column = width / 4 + dice.Below(width / 2);
    const int row = height / 4 + dice.Below(height / 2);
    const double share = dice.Uniform(0.3, 0.9);
    const SurfacePoint& seen = image.pixels[static_cast<size_t>(row) * width + column];
    if (!seen.is_surface()) continue;
    const Eigen::Vector3d sight = seen.position - eye;
    const double distance = share * std::min(sight.norm(), median);
    const Eigen::Vector3d position = eye + distance * sight.normalized();
    if (!(Clearance(*stage.caster, position) > least_clearance)) continue;
    LitStage lit = Lit(stage, Light::Point(name, position));
    if (lit.surfaces->ok() && !HasSingleMap(lit, Cover::kReceivers)) return lit;
  }
  return std::nullopt;
}

}  // namespace lightfit
