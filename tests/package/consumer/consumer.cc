// The smallest program that uses the installed library: a camera straight above a floor, a square
// shadow in the middle of the image, one slanted light.
#include <cstdint>
#include <cstdio>
#include <vector>

#include "lightfit/optimizer/fit.h"
#include "lightfit/partition/fit_plan.h"

int main() {
  constexpr int kSize = 32;
  constexpr float kHeight = 10.0f;
  std::vector<float> depth(kSize * kSize, kHeight);
  std::vector<uint32_t> shadow_bits(kSize * kSize, 0);
  for (int y = kSize / 4; y < kSize / 2; ++y) {
    for (int x = kSize / 4; x < kSize / 2; ++x) shadow_bits[y * kSize + x] = 1;
  }
  const auto camera = lightfit::LookAtCamera(
      {0, 0, kHeight}, {0, 0, 0}, Eigen::Vector3d::UnitY(), /*vertical_fov_rad=*/1.0, kSize, kSize);
  if (!camera.ok()) return 1;

  const lightfit::Light sun = lightfit::Light::Directional("sun", {0.3, 0.1, -1.0});
  const lightfit::MapSize map{256, 256};
  const auto fit =
      lightfit::FitLight({*camera, depth, lightfit::DepthKind::kCameraZ, shadow_bits}, sun, map);
  std::printf("fit: %s\n", fit.ok() ? "OK" : fit.status().ToString().c_str());

  const lightfit::Readback readback = {*camera, depth, lightfit::DepthKind::kCameraZ, shadow_bits};
  const auto surfaces = lightfit::FindSurfaces(readback, 1u << sun.shadow_bit, {});
  lightfit::PlanOptions options;
  options.max_maps = 2;
  const auto plan = lightfit::FitPlan(*surfaces, sun, options);
  std::printf("plan: %s\n", plan.ok() ? "OK" : plan.status().ToString().c_str());

  const auto empty = lightfit::FitLight(lightfit::Readback(), sun, map);
  std::printf("empty read-back: %s\n", empty.status().ToString().c_str());
  return fit.ok() && fit->map_from_world.allFinite() && plan.ok() && !empty.ok() ? 0 : 1;
}
