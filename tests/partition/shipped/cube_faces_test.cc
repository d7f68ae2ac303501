#include "partition/shipped/cube_faces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <stop_token>

#include "base/stop.h"
#include "geometry/homography.h"
#include "optimizer/energy/footprint.h"
#include "partition/shipped/receiver_pixels.h"
#include "tests/partition/shipped/surrounded_lamp.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;
using testing::SurroundedLamp;

Plan WholeCube(const Light& light, const CubeAxes& axes, int64_t max_texels) {
  return *PlanOfFaces(light, axes, kAllFaces, {1.0, 100.0}, max_texels);
}

TEST(CubeFaces, HaveTheDensityOfTheInverseCubeOfTheCosine) {
  constexpr double kTolerance = 1e-6;  // of central differences
  Random random(1);
  const Light light = Light::Point("lamp", random.InCube(3.0));
  const CubeAxes axes = random.Rotation();
  const Plan plan = WholeCube(light, axes, 6 * 100 * 100);
  const double texels = static_cast<double>(NumTexels(plan));
  const auto look_up = PlanLookUp::Create(plan, light);
  ASSERT_THAT(look_up, IsOk());
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d d = random.UnitVector();
    const PlanPlace place = look_up->At(light.position + d);
    ASSERT_GE(place.map, 0);
    const Eigen::Matrix3d frame = FrameAlong(d);
    const auto texel = [&](const Eigen::Vector3d& world) -> Eigen::Vector2d {
      const Eigen::Vector4d at = plan.maps[place.map].map_from_world * world.homogeneous();
      return at.head<2>() / at.w();
    };
    constexpr double kStep = 1e-5;
    Eigen::Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector3d step = kStep * frame.row(axis).transpose();
      jacobian.col(axis) =
          (texel(light.position + d + step) - texel(light.position + d - step)) / (2.0 * kStep);
    }
    const double cosine = (axes * d).cwiseAbs().maxCoeff();
    EXPECT_NEAR(
        std::abs(jacobian.determinant()) / (texels / 24.0 / std::pow(cosine, 3)), 1.0, kTolerance);
    EXPECT_GT(jacobian.determinant(),
              0.0);  // not mirrored: (x, y, away from the light) is right-handed
  }
}

TEST(CubeFaces, CoverTheSphereEachDirectionOnce) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    const Light light = Light::Point("lamp", random.InCube(3.0));
    const CubeAxes axes = random.Rotation();
    const Plan plan = WholeCube(light, axes, 1000);
    ASSERT_EQ(plan.maps.size(), 6u);
    const auto look_up = PlanLookUp::Create(plan, light);
    ASSERT_THAT(look_up, IsOk());
    for (int i = 0; i < 2000; ++i) {
      Eigen::Vector3d along = random.UnitVector();
      // A third of them on an edge of the cube, and of those some at a corner.
      if (i % 3 == 0) along.y() = random.Coin() ? along.x() : -along.x();
      if (i % 9 == 0) along.z() = random.Coin() ? along.x() : -along.x();
      const Eigen::Vector3d world =
          light.position + random.LogUniform(0.1, 100.0) * (axes.transpose() * along);
      int num_faces = 0;
      Eigen::Vector2d texel;
      for (int k = 0; k < 6; ++k) num_faces += look_up->IsAskable(k, world, &texel) ? 1 : 0;
      EXPECT_GE(look_up->At(world).map, 0);
      Eigen::Vector3d sorted = along.cwiseAbs();
      std::sort(sorted.data(), sorted.data() + 3);
      if (sorted(2) > (1.0 + 1e-6) * sorted(1)) {
        EXPECT_EQ(num_faces, 1);
        EXPECT_EQ(look_up->At(world).map, FaceOf(axes, world - light.position));
      } else {
        EXPECT_GE(num_faces, 1);
      }
    }
  }
}

TEST(CubeFaces, LeaveOutThoseWithoutReceiversAndShareTheirTexels) {
  int num_left_out = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const SurroundedLamp lamp(seed);
    const Surfaces surfaces = lamp.FindSurfaces();
    const auto plan = CubeFaces(surfaces, lamp.light, {}, 60'000);
    ASSERT_THAT(plan, IsOk());
    // Twin: the face of each point by comparing the six dot products.
    std::set<int> needed;
    double near = 1e300, far = 0.0;
    ForEachReceiverPixel(surfaces, [&](const ReceiverPixel& pixel) {
      for (const Eigen::Vector3d& point : pixel.points) {
        const Eigen::Vector3d offset = point - lamp.light.position;
        int best = 0;
        double most = -1.0;
        for (int face = 0; face < 6; ++face) {
          const double along = (face % 2 == 0 ? 1.0 : -1.0) * offset(face / 2);
          if (along > most) best = face, most = along;
        }
        needed.insert(best);
        near = std::min(near, most);
        far = std::max(far, most);
      }
    });
    EXPECT_EQ(plan->maps.size(), needed.size());
    num_left_out += 6 - static_cast<int>(needed.size());
    const int side = static_cast<int>(std::sqrt(60'000.0 / needed.size()));
    for (const PlanMap& map : plan->maps) EXPECT_EQ(map.size.width, side);
    EXPECT_LE(NumTexels(*plan), 60'000);
    const auto look_up = PlanLookUp::Create(*plan, lamp.light);
    ASSERT_THAT(look_up, IsOk());
    ForEachReceiverPixel(surfaces, [&](const ReceiverPixel& pixel) {
      for (const Eigen::Vector3d& point : pixel.points) {
        const PlanPlace place = look_up->At(point);
        ASSERT_GE(place.map, 0);
        const Eigen::Vector4d at = plan->maps[place.map].map_from_world * point.homogeneous();
        EXPECT_GE(at.z() / at.w(), -1e-6);
        EXPECT_LE(at.z() / at.w(), 1.0 + 1e-6);
      }
    });
    CubeFacesOptions all;
    all.needed_faces_only = false;
    EXPECT_EQ(CubeFaces(surfaces, lamp.light, {}, 60'000, all)->maps.size(), 6u);
  }
  EXPECT_GT(num_left_out, 4);
}

// Rotations with the least angle to each other, the cube's own 24 turns counted.
double AngleBetweenCubes(const CubeAxes& a, const CubeAxes& b) {
  double most = -1.0;
  const Eigen::Matrix3d turn = a * b.transpose();
  int order[3] = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
      for (int i = 0; i < 3; ++i) own(i, order[i]) = (signs >> i & 1) != 0 ? -1.0 : 1.0;
      if (own.determinant() > 0.0) most = std::max(most, (own * turn).trace());
    }
  } while (std::next_permutation(order, order + 3));
  return std::acos(std::clamp(0.5 * (most - 1.0), -1.0, 1.0));
}

TEST(CubeRotations, AreSixtyTurnsThatLieApartAndLeaveNoLargeGap) {
  const std::vector<CubeAxes>& rotations = CubeRotations();
  ASSERT_EQ(rotations.size(), 60u);
  EXPECT_EQ(rotations[0], CubeAxes::Identity());
  double closest = 1e300;
  for (size_t i = 0; i < rotations.size(); ++i) {
    EXPECT_LE((rotations[i] * rotations[i].transpose() - CubeAxes::Identity()).norm(), 1e-12);
    EXPECT_GT(rotations[i].determinant(), 0.0);
    for (size_t j = 0; j < i; ++j) {
      closest = std::min(closest, AngleBetweenCubes(rotations[i], rotations[j]));
    }
  }
  double widest_gap = 0.0;
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const CubeAxes axes = random.Rotation();
    double nearest = 1e300;
    for (const CubeAxes& rotation : rotations) {
      nearest = std::min(nearest, AngleBetweenCubes(axes, rotation));
    }
    widest_gap = std::max(widest_gap, nearest);
  }
  std::printf("closest two %.1f degrees, widest gap %.1f degrees\n",
              closest * 180.0 / M_PI,
              widest_gap * 180.0 / M_PI);
  EXPECT_GT(closest, 1.0 * M_PI / 180.0);
  EXPECT_LT(widest_gap, 35.0 * M_PI / 180.0);
}

// Twin: the footprint of each sample in the map that the plan's look-up asks, by math.md (2).
double SumInPlan(const Plan& plan, const SurroundedLamp& lamp, const Samples& samples) {
  const auto look_up = PlanLookUp::Create(plan, lamp.light);
  double sum = 0.0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample sample = samples.At(i);
    const Eigen::Vector3d world =
        lamp.light.position +
        RayFromWorld(lamp.light).leftCols<3>().transpose() * sample.X.normalized();
    const PlanPlace place = look_up->At(world);
    if (place.map < 0) return -1.0;
    const auto map_from_ray = MapFromRay(plan.maps[place.map].map_from_world, lamp.light);
    sum += sample.weight * Footprint(*map_from_ray, sample).norm() / std::sqrt(2.0);
  }
  return sum;
}

TEST(CubeFaces, TurnToTheRotationOfTheLeastFootprints) {
  constexpr double kTolerance = 1e-6;  // the faces are wider than 90 degrees by 1e-9
  int num_turned = 0;
  double log_ratio[2] = {0.0, 0.0};
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const SurroundedLamp lamp(seed);
    const Surfaces surfaces = lamp.FindSurfaces();
    const Samples samples = lamp.Select(surfaces);
    if (samples.size() < 20) continue;
    ++num_turned;
    const std::vector<DirectionSample> directions = DirectionSamples(lamp.light, samples);
    std::vector<Eigen::Vector3d> offsets;
    ForEachReceiverPixel(surfaces, [&](const ReceiverPixel& pixel) {
      for (const Eigen::Vector3d& point : pixel.points) {
        offsets.emplace_back(point - lamp.light.position);
      }
    });
    // So many that rounding sides to whole texels does not matter.
    constexpr int64_t kTexels = 6 * 5000 * 5000;
    for (const bool needed_only : {false, true}) {
      CubeFacesOptions options;
      options.needed_faces_only = needed_only;
      options.turned = true;
      const auto plan = CubeFaces(surfaces, lamp.light, samples, kTexels, options);
      ASSERT_THAT(plan, IsOk());
      const double turned = SumInPlan(*plan, lamp, samples);
      ASSERT_GT(turned, 0.0);
      double least = 1e300;
      for (const CubeAxes& axes : CubeRotations()) {
        uint32_t faces = needed_only ? 0 : kAllFaces;
        for (const Eigen::Vector3d& offset : offsets) faces |= 1u << FaceOf(axes, offset);
        const double sum =
            SumInPlan(*PlanOfFaces(lamp.light, axes, faces, {1.0, 100.0}, kTexels), lamp, samples);
        least = std::min(least, sum);
        if (!needed_only) {
          EXPECT_NEAR(SumOfFootprints(axes, directions) / 5000.0 / sum, 1.0, kTolerance);
        }
      }
      EXPECT_NEAR(turned / least, 1.0, needed_only ? 3e-4 : kTolerance);  // sides are 5000 or more
      options.turned = false;
      const double fixed =
          SumInPlan(*CubeFaces(surfaces, lamp.light, samples, kTexels, options), lamp, samples);
      EXPECT_LE(turned, (1.0 + 3e-4) * fixed);
      log_ratio[needed_only ? 1 : 0] += std::log(turned / fixed);
    }
  }
  std::printf("footprints of the turned cube over the fixed one: %.3f, of needed faces %.3f\n",
              std::exp(log_ratio[0] / num_turned),
              std::exp(log_ratio[1] / num_turned));
  EXPECT_GT(num_turned, 3);
}

TEST(CubeFaces, SayWhatIsWrong) {
  const testing::PlaneReadback floor = testing::FloorReadback();
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  const Light lamp = Light::Point("lamp", {0.0, 0.0, 1.0});
  const Light sun = Light::Directional("sun", {0.0, 0.0, -1.0});
  for (const absl::Status& status :
       {CubeFaces(*surfaces, sun, {}, 1000).status(),
        PlanOfFaces(sun, CubeAxes::Identity(), 1, {1.0, 2.0}, 1000).status()}) {
    EXPECT_THAT(status,
                StatusIs(absl::StatusCode::kFailedPrecondition,
                         ::testing::AllOf(HasSubstr("sun"), HasSubstr("cascades are for it"))));
  }
  const auto invalid = [](const absl::StatusOr<Plan>& plan, const char* what) {
    EXPECT_THAT(plan, StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(what)));
  };
  const CubeAxes axes = CubeAxes::Identity();
  invalid(PlanOfFaces(lamp, 2.0 * axes, kAllFaces, {1.0, 2.0}, 1000), "axes");
  invalid(PlanOfFaces(lamp, -axes, kAllFaces, {1.0, 2.0}, 1000), "right-handed");
  invalid(PlanOfFaces(lamp, axes, 0, {1.0, 2.0}, 1000), "faces = 0");
  invalid(PlanOfFaces(lamp, axes, 64, {1.0, 2.0}, 1000), "faces = 64");
  invalid(PlanOfFaces(lamp, axes, 1, {0.0, 2.0}, 1000), "0 < near");
  invalid(PlanOfFaces(lamp, axes, kAllFaces, {1.0, 2.0}, 5), "at least 6");
  std::stop_source source;
  source.request_stop();
  const StopScope scope(source.get_token());
  EXPECT_THAT(CubeFaces(*surfaces, lamp, {}, 1000),
              StatusIs(absl::StatusCode::kCancelled, HasSubstr("lamp")));
}

// A light on a receiver, or on all of them, leaves numbers finite.
TEST(CubeFaces, AreFiniteForALampOnTheFloor) {
  const testing::PlaneReadback floor = testing::FloorReadback();
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  Eigen::Vector3d on_floor = Eigen::Vector3d::Zero();
  ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel& pixel) {
    if (pixel.x == 20 && pixel.y == 15) on_floor = pixel.points[0];
  });
  const auto plan = CubeFaces(*surfaces, Light::Point("lamp", on_floor), {}, 1000);
  ASSERT_THAT(plan, IsOk());
  for (const PlanMap& map : plan->maps) EXPECT_TRUE(map.map_from_world.allFinite());
}

}  // namespace
}  // namespace lightfit
