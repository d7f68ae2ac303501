#include "partition/shipped/receiver_pixels.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "base/stop.h"

namespace lightfit {

void ForEachReceiverPixel(const Surfaces& surfaces,
                          absl::FunctionRef<void(const ReceiverPixel&)> visit) {
  const Readback& readback = surfaces.readback;
  SampleOptions options = surfaces.options;
  options.use_outlines = false;
  constexpr double kHalf = 0.5;
  constexpr double kCorners[4][2] = {
      {-kHalf, -kHalf}, {kHalf, -kHalf}, {kHalf, kHalf}, {-kHalf, kHalf}};
  ReceiverPixel pixel;
  for (int y = 0; y < readback.height(); ++y) {
    if (StopRequested()) return;
    for (int x = 0; x < readback.width(); ++x) {
      const double depth = readback.depth[readback.Index(x, y)];
      if (!surfaces.affine_depth.IsSurface(depth)) continue;
      const double d = surfaces.affine_depth.At(x, y, depth);
      DepthGradient gradient = {d, 0.0, 0.0};
      if (!DepthGradientAt(readback, surfaces.affine_depth, options, x, y, &gradient)) {
        gradient = {d, 0.0, 0.0};
      }
      const auto world = [&](double right, double down) -> Eigen::Vector3d {
        double there = d + right * gradient.d_x + down * gradient.d_y;
        if (!readback.camera.orthographic) there = std::clamp(there, 0.5 * d, 2.0 * d);
        return (surfaces.world_from_screen *
                Eigen::Vector4d(x + kHalf + right, y + kHalf + down, there, 1.0))
            .hnormalized();
      };
      pixel.x = x;
      pixel.y = y;
      pixel.points[0] = world(0.0, 0.0);
      for (int i = 0; i < 4; ++i) pixel.points[i + 1] = world(kCorners[i][0], kCorners[i][1]);
      visit(pixel);
    }
  }
}

}  // namespace lightfit
