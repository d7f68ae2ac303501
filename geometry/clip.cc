#include "geometry/clip.h"

namespace lightfit {

Eigen::Matrix4d ClipFromMap(MapSize map, const ClipConvention& clip) {
  const double y_sign = clip.y_up ? -1.0 : 1.0;
  Eigen::Matrix4d clip_from_map = Eigen::Matrix4d::Identity();
  clip_from_map(0, 0) = 2.0 / map.width;
  clip_from_map(0, 3) = -1.0;
  clip_from_map(1, 1) = y_sign * 2.0 / map.height;
  clip_from_map(1, 3) = -y_sign;
  switch (clip.depth) {
    case ClipConvention::Depth::kZeroToOne:
      break;
    case ClipConvention::Depth::kMinusOneToOne:
      clip_from_map(2, 2) = 2.0;
      clip_from_map(2, 3) = -1.0;
      break;
    case ClipConvention::Depth::kReversedZeroToOne:
      clip_from_map(2, 2) = -1.0;
      clip_from_map(2, 3) = 1.0;
      break;
  }
  return clip_from_map;
}

}  // namespace lightfit
