#include "partition/shipped/paraboloid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "partition/shipped/equal_squares.h"

namespace lightfit {

namespace {

ParaboloidPlace PlaceOf(const ParaboloidPair& pair, const Eigen::Vector3d& direction) {
  ParaboloidPlace place;
  place.half = pair.HalfFromWorld(0).row(2).dot(direction) >= 0.0 ? 0 : 1;
  const Eigen::Vector2d uv = ParaboloidFromDirection(pair.HalfFromWorld(place.half) * direction);
  const double size = pair.size;
  // The rim touches the square's sides.
  const double most = std::nextafter(size, 0.0);
  for (int axis = 0; axis < 2; ++axis) {
    place.texel(axis) = std::clamp(0.5 * size * (uv(axis) + 1.0), 0.0, most);
  }
  return place;
}

}  // namespace

Eigen::Vector2d ParaboloidFromDirection(const Eigen::Vector3d& d) {
  return d.head<2>() / (1.0 + d.z());
}

Eigen::Vector3d DirectionFromParaboloid(const Eigen::Vector2d& uv) {
  const double squared = uv.squaredNorm();
  return Eigen::Vector3d(2.0 * uv.x(), 2.0 * uv.y(), 1.0 - squared) / (1.0 + squared);
}

double ParaboloidDensity(double d_z) { return 1.0 / ((1.0 + d_z) * (1.0 + d_z)); }

Eigen::Matrix3d ParaboloidPair::HalfFromWorld(int half) const {
  Eigen::Matrix3d frame = FrameAlong(normal);
  // Half a turn about x.
  if (half == 1) frame.bottomRows<2>() *= -1.0;
  return frame;
}

ParaboloidPlace ParaboloidPair::At(const Eigen::Vector3d& world) const {
  const Eigen::Vector3d direction = (world - centre).stableNormalized();
  if (!(direction.squaredNorm() > 0.0)) return {};
  return PlaceOf(*this, direction);
}

TexelRay ParaboloidPair::RayAt(const ParaboloidPlace& place) const {
  const Eigen::Vector2d uv = 2.0 / size * place.texel - Eigen::Vector2d::Ones();
  return {centre, HalfFromWorld(place.half).transpose() * DirectionFromParaboloid(uv)};
}

std::vector<ParaboloidPlace> ParaboloidPair::FilterAt(
    const Eigen::Vector3d& world, absl::Span<const Eigen::Vector2d> offsets_texels) const {
  const ParaboloidPlace middle = At(world);
  if (middle.half < 0) return {};
  const Eigen::Matrix3d half_from_world = HalfFromWorld(middle.half);
  const Eigen::Vector3d d = half_from_world * (world - centre).stableNormalized();
  const Eigen::Vector2d uv = ParaboloidFromDirection(d);
  // The derivative of the inverse: two vectors of length 1 + d_z, across each other and d.
  const double r_squared = uv.squaredNorm();
  const double u = uv.x(), v = uv.y();
  Eigen::Matrix<double, 3, 2> direction_from_uv;
  direction_from_uv << 1.0 + r_squared - 2.0 * u * u, -2.0 * u * v,  //
      -2.0 * u * v, 1.0 + r_squared - 2.0 * v * v,                   //
      -2.0 * u, -2.0 * v;
  direction_from_uv *= 2.0 / ((1.0 + r_squared) * (1.0 + r_squared));
  std::vector<ParaboloidPlace> places;
  places.reserve(offsets_texels.size());
  for (const Eigen::Vector2d& offset : offsets_texels) {
    const Eigen::Vector3d there = d + direction_from_uv * (2.0 / size * offset);
    places.push_back(PlaceOf(*this, half_from_world.transpose() * there.stableNormalized()));
  }
  return places;
}

int64_t NumTexels(const ParaboloidPair& pair) { return 2 * int64_t{pair.size} * pair.size; }

absl::StatusOr<ParaboloidPair> MakeParaboloidPair(const Light& light,
                                                  const Eigen::Vector3d& normal,
                                                  int64_t max_texels) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (light.kind != Light::Kind::kPoint) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "light \"%s\": paraboloids are for point lights. The rays of a directional light are "
        "parallel: cascades are for it",
        light.name));
  }
  const double length = normal.stableNorm();
  if (!(length > 0.0) || !std::isfinite(length)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": normal = (%g, %g, %g), want finite and non-zero: the axis of the first half",
        light.name,
        normal.x(),
        normal.y(),
        normal.z()));
  }
  const absl::StatusOr<MapSize> size = EqualSquares(light, max_texels, 2);
  if (!size.ok()) return size.status();
  ParaboloidPair pair;
  pair.light_name = light.name;
  pair.centre = light.position;
  pair.normal = normal.stableNormalized();
  pair.size = size->width;
  return pair;
}

}  // namespace lightfit
