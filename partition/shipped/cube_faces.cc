#include "partition/shipped/cube_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "absl/strings/str_format.h"
#include "geometry/light_map.h"
#include "partition/shipped/equal_squares.h"
#include "partition/shipped/receiver_pixels.h"

namespace lightfit {

namespace {

// Half the width of a face at unit distance.
constexpr double kHalfWidth = 1.0 + 1e-9;

// Rows: u, v and the axis of a face, right-handed.
Eigen::Matrix3d FrameOfFace(const CubeAxes& axes, int face) {
  const int along = face / 2;
  const bool against = face % 2 == 1;
  Eigen::Matrix3d frame;
  frame.row(0) = axes.row((along + (against ? 2 : 1)) % 3);
  frame.row(1) = axes.row((along + (against ? 1 : 2)) % 3);
  frame.row(2) = (against ? -1.0 : 1.0) * axes.row(along);
  return frame;
}

absl::Status ValidateLamp(const Light& light) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  if (light.kind == Light::Kind::kPoint) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrFormat(
      "light \"%s\": a cube map is for point lights. The rays of a directional light are parallel: "
      "cascades are for it",
      light.name));
}

// Of what a read-back sees, from the light.
std::vector<Eigen::Vector3d> OffsetsOfReceivers(const Surfaces& surfaces, const Light& light) {
  std::vector<Eigen::Vector3d> offsets;
  ForEachReceiverPixel(surfaces, [&](const ReceiverPixel& pixel) {
    for (const Eigen::Vector3d& point : pixel.points) offsets.emplace_back(point - light.position);
  });
  return offsets;
}

uint32_t FacesOf(const CubeAxes& axes, absl::Span<const Eigen::Vector3d> offsets) {
  uint32_t faces = 0;
  for (size_t i = 0; i < offsets.size() && faces != kAllFaces; ++i) {
    faces |= 1u << FaceOf(axes, offsets[i]);
  }
  return faces;
}

DepthRange DepthsOf(const CubeAxes& axes, absl::Span<const Eigen::Vector3d> offsets) {
  DepthRange depth = {std::numeric_limits<double>::infinity(), 0.0};
  for (const Eigen::Vector3d& offset : offsets) {
    const double along = (axes * offset).cwiseAbs().maxCoeff();
    depth = {std::min(depth.near, along), std::max(depth.far, along)};
  }
  // A receiver at the light itself.
  constexpr double kLeastShare = 1e-6;
  depth.far = std::max(depth.far, std::numeric_limits<double>::min() / kLeastShare);
  depth.near = std::max(depth.near, kLeastShare * depth.far);
  return depth;
}

}  // namespace

int FaceOf(const CubeAxes& axes, const Eigen::Vector3d& offset) {
  const Eigen::Vector3d along = axes * offset;
  Eigen::Index axis = 0;
  along.cwiseAbs().maxCoeff(&axis);
  return static_cast<int>(2 * axis) + (along(axis) < 0.0 ? 1 : 0);
}

const std::vector<CubeAxes>& CubeRotations() {
  static const std::vector<CubeAxes>* const rotations = [] {
    constexpr int kNumRotations = 60;
    // Points of the unit cube that leave no large gaps: multiples of powers of the root of
    // x^4 = x + 1. Shoemake 1992 makes uniform rotations of uniform points.
    constexpr double kRoot = 1.2207440846057596;
    auto* const list = new std::vector<CubeAxes>(1, CubeAxes::Identity());
    for (int i = 1; i < kNumRotations; ++i) {
      const auto share = [i](double step) { return i * step - std::floor(i * step); };
      const double radius = share(1.0 / kRoot);
      const double first = 2.0 * M_PI * share(1.0 / (kRoot * kRoot));
      const double second = 2.0 * M_PI * share(1.0 / (kRoot * kRoot * kRoot));
      const double a = std::sqrt(1.0 - radius), b = std::sqrt(radius);
      list->push_back(
          Eigen::Quaterniond(
              b * std::cos(second), a * std::sin(first), a * std::cos(first), b * std::sin(second))
              .normalized()
              .toRotationMatrix());
    }
    return list;
  }();
  return *rotations;
}

absl::StatusOr<Plan> PlanOfFaces(const Light& light,
                                 const CubeAxes& axes,
                                 uint32_t faces,
                                 DepthRange depth,
                                 int64_t max_texels) {
  if (absl::Status status = ValidateLamp(light); !status.ok()) return status;
  constexpr double kNotRotated = 1e-9;
  if (!((axes * axes.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <=
        kNotRotated) ||
      axes.determinant() < 0.0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": the cube's axes are not orthonormal and right-handed", light.name));
  }
  if (faces == 0 || faces > kAllFaces) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": faces = %d, want some of the bits of %d", light.name, faces, kAllFaces));
  }
  if (!(depth.near > 0.0) || !(depth.far >= depth.near) || !std::isfinite(depth.far)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": depth = %g ... %g, want 0 < near <= far, finite",
                        light.name,
                        depth.near,
                        depth.far));
  }
  const absl::StatusOr<MapSize> size = EqualSquares(light, max_texels, std::popcount(faces));
  if (!size.ok()) return size.status();
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(light);
  const double half = 0.5 * size->width;
  Plan plan;
  plan.light_name.assign(light.name.begin(), light.name.end());
  for (int face = 0; face < kNumFaces; ++face) {
    if ((faces >> face & 1u) == 0) continue;
    Eigen::Matrix3d map_from_face = Eigen::Matrix3d::Identity();
    map_from_face(0, 0) = map_from_face(1, 1) = half / kHalfWidth;
    map_from_face(0, 2) = map_from_face(1, 2) = half;
    const Eigen::Matrix3d face_from_ray =
        FrameOfFace(axes, face) * ray_from_world.leftCols<3>().transpose();
    const absl::StatusOr<Eigen::Matrix4d> map_from_world =
        FinishMap(map_from_face * face_from_ray, ray_from_world, light, depth, depth.near);
    if (!map_from_world.ok()) return map_from_world.status();
    PlanMap map;
    map.map_from_world = *map_from_world;
    map.size = *size;
    plan.maps.push_back(map);
  }
  return plan;
}

double SumOfFootprints(const CubeAxes& axes, absl::Span<const DirectionSample> samples) {
  std::array<Eigen::Matrix3d, kNumFaces> frames;
  for (int face = 0; face < kNumFaces; ++face) frames[face] = FrameOfFace(axes, face);
  double sum = 0.0;
  for (const DirectionSample& sample : samples) {
    const Eigen::Matrix3d& frame = frames[FaceOf(axes, sample.direction)];
    // math.md (2): of the inverse of diag(1/2, 1/2, 1) frame the first two columns are 2 a, 2 b.
    const double w = frame.row(2).dot(sample.direction);
    const double squared = (frame.topRows<2>() * sample.G * frame.topRows<2>().transpose()).trace();
    sum += sample.weight * w * std::sqrt(2.0 * std::max(squared, 0.0));
  }
  return sum;
}

absl::StatusOr<Plan> CubeFaces(const Surfaces& surfaces,
                               const Light& light,
                               const Samples& samples,
                               int64_t max_texels,
                               const CubeFacesOptions& options) {
  if (absl::Status status = ValidateLamp(light); !status.ok()) return status;
  const std::vector<Eigen::Vector3d> offsets = OffsetsOfReceivers(surfaces, light);
  if (absl::Status status = CheckStop(light); !status.ok()) return status;
  const auto needed_faces = [&](const CubeAxes& axes) {
    return options.needed_faces_only ? FacesOf(axes, offsets) : kAllFaces;
  };
  CubeAxes best = CubeAxes::Identity();
  if (options.turned) {
    const std::vector<DirectionSample> directions =
        DirectionSamples(light, samples, options.weights);
    double least = std::numeric_limits<double>::infinity();
    for (const CubeAxes& axes : CubeRotations()) {
      if (absl::Status status = CheckStop(light); !status.ok()) return status;
      // The side of n squares of one budget falls as the root of n.
      const double sum =
          std::sqrt(std::popcount(needed_faces(axes))) * SumOfFootprints(axes, directions);
      if (sum < least) {
        least = sum;
        best = axes;
      }
    }
  }
  return PlanOfFaces(light, best, needed_faces(best), DepthsOf(best, offsets), max_texels);
}

}  // namespace lightfit
