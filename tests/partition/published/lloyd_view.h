// tests/partition/published/lloyd_view.h
//
// The views of Lloyd et al. 2006 as input of a method, and what their figures are to show.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "methods/method.h"
#include "methods/view_body.h"
#include "partition/published/lloyd_error.h"

namespace lightfit::testing {

inline const Eigen::Vector3d kOverhead(0.0, -1.0, 0.0);
inline const Eigen::Vector3d kBehind(0.0, 0.0, -1.0);

// To which storage is as Lloyd has it: the budget's whole texels, and the millionth of a map around
// what it serves.
inline constexpr double kFourDigits = 1e-4;

// A level, square view along -z from the origin, its whole frustum inside the receivers, and a sun.
// The budget is large, so that whole numbers of texels do not show.
inline MethodInput InputOf(const LloydView& view, const Eigen::Vector3d& sun) {
  MethodInput input;
  input.light = Light::Directional("sun", sun);
  input.camera = *LookAtCamera(Eigen::Vector3d::Zero(),
                               -Eigen::Vector3d::UnitZ(),
                               Eigen::Vector3d::UnitY(),
                               2.0 * view.half_angle_rad,
                               256,
                               256);
  input.camera.near = view.near;
  input.camera.far = view.far;
  const double reach = 2.0 * view.far * (1.0 + std::tan(view.half_angle_rad));
  input.receivers = {Eigen::Vector3d::Constant(-reach), Eigen::Vector3d::Constant(reach)};
  input.map = {16384, 16384};
  return input;
}

// Directions of suns above the viewer, at equal steps of both angles, `steps` from overhead down to
// the horizon and four times as many around.
inline std::vector<Eigen::Vector3d> SunsAbove(int steps) {
  std::vector<Eigen::Vector3d> suns;
  for (int i = 0; i < steps; ++i) {
    const double down = 0.5 * M_PI * (i + 0.5) / steps;
    for (int j = 0; j < 4 * steps; ++j) {
      const double around = 0.5 * M_PI * (j + 0.5) / steps;
      suns.emplace_back(
          -std::sin(down) * std::cos(around), -std::cos(down), -std::sin(down) * std::sin(around));
    }
  }
  return suns;
}

// Figure 13: the first number of maps, in steps of four, with which splits by faces need fewer
// texels under a light behind than splits by depth.
inline int FirstMapsOfFaces(const LloydView& view) {
  int maps = 4;
  while (BehindFaceWarpStorage(view, 0.25 * maps) >= BehindStorage(view, maps)) maps += 4;
  return maps;
}

// What the figures show by the corrected equations, to the digits given.
struct LloydFigures {
  // Figure 5, n = 1, f = 20: last factors of (7) and (8) at near and far, for n' = n, that of
  // light-space perspective maps, and no warp; of the second also the least value and its depth.
  static constexpr double kZTermPsm[2] = {0.05, 1.0};
  static constexpr double kZTermLispsm[2] = {0.2236, 0.2236};
  static constexpr double kZTermLispsmLeast = 0.1336, kDepthOfLeast = 4.477;
  static constexpr double kZTermUnwarped[2] = {1.0, 0.05};
  static constexpr double kXTermAtNear[3] = {0.05, 0.2236, 1.0};
  static constexpr double kXTermAtFar = 0.05;

  // Figure 6, alpha = 100, theta = 45 degrees: M_x, M_z and the storage factor at eta = -1, 0, 1.
  static constexpr double kOfEta[3][3] = {
      {100.0, 49.5, 4950.0}, {10.0, 4.95, 49.5}, {1.0, 49.5, 49.5}};

  // Figure 10, alpha = 1000, theta = 30 degrees: overhead, split by depth and warped.
  static constexpr int kParts[6] = {1, 2, 3, 4, 8, 16};
  static constexpr double kOverheadWarp[6] = {865.0, 53.0, 23.4, 16.0, 9.50, 7.48};
  static constexpr double kOverheadLimit = 5.98;

  // Figure 12, the same view, by number of maps.
  static constexpr int kBehindMaps[7] = {1, 2, 4, 8, 12, 16, 20};
  static constexpr double kBehind[7] = {1e6, 2000.0, 126.0, 45.0, 37.9, 37.9, 39.9};
  static constexpr int kBehindFaceMaps[5] = {4, 8, 12, 16, 20};
  static constexpr double kBehindFaceWarp[5] = {1999.0, 124.0, 55.0, 38.0, 30.8};
  static constexpr int kOverheadMaps[2] = {4, 8};
  static constexpr double kOverhead[2] = {90.1, 22.5};

  // Figure 13: FirstMapsOfFaces().
  static constexpr double kAlphas[10] = {5, 10, 20, 50, 100, 200, 500, 1000, 5000, 10000};
  static constexpr int kFirstMaps[10] = {8, 8, 8, 12, 12, 16, 16, 20, 20, 24};

  // Figure 7, theta = 30 degrees: geometric means over the suns above, at alpha and parts:
  // unwarped, warped, and the faces warped. They depend a little on where suns are counted.
  struct Mean {
    double alpha;
    int parts;
    double unwarped, warped, faces;
  };
  static constexpr Mean kMeans[2] = {{20.0, 1, 476.0, 47.0, 31.0}, {1000.0, 4, 140.0, 43.0, 32.0}};
};

}  // namespace lightfit::testing
