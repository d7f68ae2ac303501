#include "optimizer/readback/samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/stop.h"
#include "optimizer/readback/edge_normals.h"

namespace lightfit {

Sample Samples::At(size_t i) const {
  const Eigen::Vector3d X = ray_from_screen * Eigen::Vector4d(x[i], y[i], d[i], 1.0);
  // math.md (11): the ray's screen derivatives on the visible surface.
  const Eigen::Vector3d T1 = ray_from_screen.col(0) + d_x[i] * ray_from_screen.col(2);
  const Eigen::Vector3d T2 = ray_from_screen.col(1) + d_y[i] * ray_from_screen.col(2);
  const double V = X.dot(T1.cross(T2));
  Sample sample;
  sample.X = X;
  // math.md (1)
  sample.D.row(0) = T2.cross(X) / V;
  sample.D.row(1) = X.cross(T1) / V;
  sample.weight = weight[i];
  sample.edge_normal = has_edge_normals() ? Eigen::Vector2d(edge_normal_x[i], edge_normal_y[i])
                                          : Eigen::Vector2d::Zero();
  return sample;
}

void Samples::AppendFrom(const Samples& other, size_t i) {
  x.push_back(other.x[i]);
  y.push_back(other.y[i]);
  d.push_back(other.d[i]);
  d_x.push_back(other.d_x[i]);
  d_y.push_back(other.d_y[i]);
  weight.push_back(other.weight[i]);
  if (!other.has_edge_normals()) return;
  edge_normal_x.push_back(other.edge_normal_x[i]);
  edge_normal_y.push_back(other.edge_normal_y[i]);
}

namespace {

// Whether the plane of a boundary pixel is known as well as the options want it.
bool IsWanted(const BoundaryPixel& pixel, const SampleOptions& options) {
  return options.use_outlines || !pixel.is_outline;
}

enum class Facing : uint8_t { kAway, kEdgeOn, kTowards };

// By the plane that the depth tells.
Facing FacingByNormal(const BoundaryPixel& pixel,
                      const Light& light,
                      const SampleOptions& options) {
  const Eigen::Vector3d to_light = light.kind == Light::Kind::kPoint
                                       ? Eigen::Vector3d(light.position - pixel.position)
                                       : Eigen::Vector3d(-light.direction.stableNormalized());
  const double facing = pixel.normal.dot(to_light);
  if (facing <= 0.0) return Facing::kAway;
  // Also false for a light at the receiver, and for normals that are not finite.
  const bool faces_eye = pixel.eye_along_normal >= options.min_cos_eye * pixel.eye_distance;
  const bool is_seen = faces_eye && facing > options.min_cos_light * to_light.norm();
  return is_seen ? Facing::kTowards : Facing::kEdgeOn;
}

// As the read-back says, which must know; planes that contradict it are no good.
Facing FacingAsGiven(const BoundaryPixel& pixel,
                     const Readback& readback,
                     const Light& light,
                     const SampleOptions& options) {
  const Facing facing = FacingByNormal(pixel, light, options);
  const bool faces =
      (readback.facing_bits[readback.Index(pixel.x, pixel.y)] >> light.shadow_bit) & 1u;
  if (!faces) return Facing::kAway;
  return facing == Facing::kAway ? Facing::kEdgeOn : facing;
}

// Tells shadow edges from terminators: the borders between shadow and surfaces that are turned away
// from the light, whose bit is 0 because no shadow is looked up there.
class Terminators {
 public:
  Terminators(const Surfaces& surfaces,
              uint32_t bit,
              bool knows_facing,
              const ScratchVector<Facing>& facing)
      : surfaces_(surfaces), knows_facing_(knows_facing), bit_(bit), facing_(facing) {
    if (knows_facing_) return;
    row_begin_.reserve(surfaces.readback.height() + 1);
    for (size_t i = 0; i < surfaces.boundary.size(); ++i) {
      while (static_cast<int>(row_begin_.size()) <= surfaces.boundary[i].y) {
        row_begin_.push_back(i);
      }
    }
    row_begin_.resize(surfaces.readback.height() + 1, surfaces.boundary.size());
  }

  // Whether every neighbour without shadow of a shadowed pixel is turned away from the light. With
  // the third state: whether no neighbour is in the other state, lit or in shadow.
  bool Has(const BoundaryPixel& pixel) const {
    if (knows_facing_) {
      const uint32_t other = ~Word(pixel.x, pixel.y) & bit_;
      return !Is(other, pixel.x - 1, pixel.y) && !Is(other, pixel.x + 1, pixel.y) &&
             !Is(other, pixel.x, pixel.y - 1) && !Is(other, pixel.x, pixel.y + 1);
    }
    if ((Word(pixel.x, pixel.y) & bit_) == 0) return false;
    return IsShadowedOrAway(pixel.x - 1, pixel.y) && IsShadowedOrAway(pixel.x + 1, pixel.y) &&
           IsShadowedOrAway(pixel.x, pixel.y - 1) && IsShadowedOrAway(pixel.x, pixel.y + 1);
  }

 private:
  uint32_t Word(int x, int y) const {
    return surfaces_.readback.shadow_bits[static_cast<size_t>(y) * surfaces_.readback.width() + x];
  }

  // Whether a surface faces the light and has this shadow bit.
  bool Is(uint32_t shadow, int x, int y) const {
    const size_t pixel = surfaces_.readback.Index(x, y);
    return (surfaces_.readback.facing_bits[pixel] & bit_) != 0 &&
           (surfaces_.readback.shadow_bits[pixel] & bit_) == shadow &&
           surfaces_.affine_depth.IsSurface(surfaces_.readback.depth[pixel]);
  }

  // Whether nothing is lit there. A neighbour without shadow is a boundary pixel itself, unless no
  // plane is known there.
  bool IsShadowedOrAway(int x, int y) const {
    if ((Word(x, y) & bit_) != 0) return true;
    const float depth = surfaces_.readback.depth[surfaces_.readback.Index(x, y)];
    if (!surfaces_.affine_depth.IsSurface(depth)) return true;
    const auto begin = surfaces_.boundary.begin();
    const auto found =
        std::lower_bound(begin + row_begin_[y],
                         begin + row_begin_[y + 1],
                         x,
                         [](const BoundaryPixel& pixel, int column) { return pixel.x < column; });
    return found != begin + row_begin_[y + 1] && found->x == x &&
           facing_[found - begin] == Facing::kAway;
  }

  const Surfaces& surfaces_;
  bool knows_facing_;
  uint32_t bit_;
  const ScratchVector<Facing>& facing_;  // by boundary pixel
  ScratchVector<size_t> row_begin_;      // in Surfaces::boundary
};

}  // namespace

Samples SelectSamples(const Surfaces& surfaces,
                      const Light& light,
                      const SampleOptions& options,
                      const Eigen::Matrix3d& normalized_from_ray,
                      bool with_edge_normals,
                      FacingSource source) {
  const bool is_given =
      source == FacingSource::kGiven && surfaces.readback.KnowsFacing(light.shadow_bit);
  const uint32_t bit = uint32_t{1} << light.shadow_bit;
  Samples samples;
  samples.ray_from_screen = normalized_from_ray * RayFromWorld(light) * surfaces.world_from_screen;
  samples.counts = surfaces.counts[light.shadow_bit];
  for (auto* array : {&samples.x, &samples.y, &samples.d, &samples.d_x, &samples.d_y}) {
    array->reserve(samples.counts.candidates);
  }
  const EdgeNormals edge_normals(
      surfaces.readback, surfaces.affine_depth, light.shadow_bit, options.edge_window);
  ScratchVector<Facing> facing;
  facing.reserve(surfaces.boundary.size());
  for (const BoundaryPixel& pixel : surfaces.boundary) {
    if (IsStopped(facing.size())) return samples;
    const bool is_candidate = (pixel.lights & bit) != 0 && IsWanted(pixel, options);
    if (!is_candidate) {
      facing.push_back(Facing::kTowards);
    } else if (is_given) {
      facing.push_back(FacingAsGiven(pixel, surfaces.readback, light, options));
    } else {
      facing.push_back(FacingByNormal(pixel, light, options));
    }
  }
  const Terminators terminators(surfaces, bit, is_given, facing);
  for (size_t i = 0; i < surfaces.boundary.size() && !IsStopped(i); ++i) {
    const BoundaryPixel& pixel = surfaces.boundary[i];
    if ((pixel.lights & bit) == 0) continue;
    if (!IsWanted(pixel, options)) {
      ++samples.counts.discontinuity;
      continue;
    }
    if (facing[i] == Facing::kAway || (!options.use_terminators && terminators.Has(pixel))) {
      ++samples.counts.facing_away;
      continue;
    }
    if (facing[i] == Facing::kEdgeOn) {
      ++samples.counts.edge_on;
      continue;
    }
    samples.x.push_back(pixel.x + 0.5);
    samples.y.push_back(pixel.y + 0.5);
    samples.d.push_back(pixel.d);
    samples.d_x.push_back(pixel.d_x);
    samples.d_y.push_back(pixel.d_y);
    if (with_edge_normals) {
      const Eigen::Vector2d normal = edge_normals.At(pixel.x, pixel.y);
      samples.edge_normal_x.push_back(normal.x());
      samples.edge_normal_y.push_back(normal.y());
    }
  }
  samples.weight.assign(samples.size(), 1.0);
  samples.counts.used = static_cast<int64_t>(samples.size());
  return samples;
}

Samples SamplesServed(const Samples& samples) {
  Samples served;
  served.ray_from_screen = samples.ray_from_screen;
  served.counts = samples.counts;
  for (size_t i = 0; i < samples.size() && !IsStopped(i); ++i) {
    const Eigen::Vector3d X =
        samples.ray_from_screen * Eigen::Vector4d(samples.x[i], samples.y[i], samples.d[i], 1.0);
    const double limit = kSquaresServed * X.z();
    if (std::abs(X.x()) <= limit && std::abs(X.y()) <= limit) {
      served.AppendFrom(samples, i);
    } else {
      ++served.counts.beyond_map;
    }
  }
  served.counts.used = static_cast<int64_t>(served.size());
  return served;
}

Samples SamplesInFront(const Samples& samples, const Eigen::RowVector3d& axis) {
  Samples front;
  front.ray_from_screen = samples.ray_from_screen;
  front.counts = samples.counts;
  for (size_t i = 0; i < samples.size() && !IsStopped(i); ++i) {
    if (!(axis.dot(samples.At(i).X) > 0.0)) continue;
    front.AppendFrom(samples, i);
  }
  return front;
}

}  // namespace lightfit
