// FitOptions::AsPublished() against Chong & Gortler's Algorithm 1, written down here a second time
// from the paper, step by step: footprints (6), gradient by differences, rotations, rectangles.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/convex_hull.h"
#include "optimizer/figures/footprint_image.h"
#include "optimizer/fit.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/samples.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/gradient_check.h"
#include "tests/testing/matchers.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using testing::IsOk;
using testing::RelativeError;
using testing::TestScene;

constexpr MapSize kMap = {512, 256};

class Algorithm1 {
 public:
  Algorithm1(const Readback& readback, const Light& light) {
    const Surfaces surfaces =
        *FindSurfaces(readback, 1u << light.shadow_bit, FitOptions::AsPublished().samples);
    samples_ = SelectSamples(surfaces, light, surfaces.options, Eigen::Matrix3d::Identity(), false);
    const std::vector<Eigen::Vector3d> positions = *ReceiverPositions(readback);
    for (const Eigen::Vector3d& position : positions) {
      rays_.push_back(RayFromWorld(light) * position.homogeneous());
    }
    const RayCover cover = *CoverReceivers(surfaces, light, Cover::kReceivers);
    mean_ray_ = cover.mean_ray;
    // The limit of the warp: w of a ray against w in the middle of the rays, both at depth 1.
    middle_ = cover.normalized_from_ray.inverse().col(2);
    depth_row_ = cover.normalized_from_ray.row(2);
  }

  // Steps 1 to 4: start at the receivers' mean, or in the middle of their cone where some of them
  // are behind the mean; three rounds of rotations, the best is kept.
  Eigen::Matrix3d Run() {
    Eigen::Matrix3d best = FitRectangle(Usable(mean_ray_) ? mean_ray_ : depth_row_.normalized());
    energy_start = energy = Energy(best);
    for (int round = 0; round < 3; ++round) {
      const Eigen::Vector3d axis = best.row(2).transpose().normalized();
      const Eigen::Vector3d rotation_axis = axis.cross(-Gradient(best)).normalized();
      for (const double degrees : {-10.0, 3.0, 5.0, 9.0, 16.0, 23.0, 30.0, 40.0, 50.0}) {
        const Eigen::Vector3d candidate =
            Eigen::AngleAxisd(degrees * M_PI / 180.0, rotation_axis) * axis;
        if (!Usable(candidate)) continue;
        const Eigen::Matrix3d map_from_ray = FitRectangle(candidate);
        if (!(Energy(map_from_ray) < energy)) continue;
        energy = Energy(map_from_ray);
        best = map_from_ray;
      }
    }
    return best;
  }

  double energy = 0.0, energy_start = 0.0;

 private:
  // (6): the sum of squared entries of the inverse of the Jacobian of the projection.
  double Energy(const Eigen::Matrix3d& map_from_ray) const {
    double sum = 0.0;
    for (size_t i = 0; i < samples_.size(); ++i) {
      const Eigen::Matrix<double, 3, 4>& m = samples_.ray_from_screen;
      const Eigen::Vector3d map =
          map_from_ray * m * Eigen::Vector4d(samples_.x[i], samples_.y[i], samples_.d[i], 1.0);
      Eigen::Matrix<double, 3, 2> derivatives;
      derivatives << map_from_ray * (m.col(0) + samples_.d_x[i] * m.col(2)),
          map_from_ray * (m.col(1) + samples_.d_y[i] * m.col(2));
      const Eigen::Matrix2d J_map_screen =
          (derivatives.topRows<2>() - map.hnormalized() * derivatives.row(2)) / map.z();
      sum += J_map_screen.inverse().squaredNorm();
    }
    return sum;
  }

  Eigen::Vector3d Gradient(const Eigen::Matrix3d& map_from_ray) const {
    const auto energy_at = [&](const Eigen::Vector3d& axis) {
      Eigen::Matrix3d moved = map_from_ray;
      moved.row(2) = axis;
      return Energy(moved);
    };
    const Eigen::Vector3d axis = map_from_ray.row(2);
    return testing::CentralDifferences<3>(energy_at, axis, 3e-5 * axis.norm());
  }

  bool Usable(const Eigen::Vector3d& axis) const {
    for (const Eigen::Vector3d& ray : rays_) {
      if (!(axis.dot(ray) >= 1e-3 * axis.dot(middle_) * depth_row_.dot(ray))) return false;
    }
    return axis.dot(middle_) > 0.0;
  }

  // The least rectangle over the edges of the hull of all receivers, in the plane normal to the
  // axis, long side to long side, grown by 1 % on every side. The gradient holds h1 and h2 fixed,
  // so it depends on which corner is texel (0, 0), a choice that the paper leaves open: here the
  // start of the touched edge, and after a turn to the map's long side the corner that this brings
  // there.
  Eigen::Matrix3d FitRectangle(const Eigen::Vector3d& axis) const {
    const Eigen::Vector3d s = axis.unitOrthogonal();
    Eigen::Matrix3d plane_from_ray;
    plane_from_ray << s.transpose(), axis.cross(s).transpose(), axis.transpose();
    std::vector<Eigen::Vector2d> points;
    for (const Eigen::Vector3d& ray : rays_) points.push_back((plane_from_ray * ray).hnormalized());
    const Polygon hull = ConvexHull(points);
    double least_area = std::numeric_limits<double>::infinity();
    Eigen::Matrix3d map_from_plane;
    for (size_t i = 0; i < hull.size(); ++i) {
      const Eigen::Vector2d along = (hull[(i + 1) % hull.size()] - hull[i]).normalized();
      Eigen::Matrix2d turn;
      turn << along.transpose(), Perpendicular(along).transpose();
      Eigen::Vector2d low = turn * hull[0], high = low;
      for (const Eigen::Vector2d& vertex : hull) {
        low = low.cwiseMin(turn * vertex);
        high = high.cwiseMax(turn * vertex);
      }
      Eigen::Vector2d extent = high - low;
      if (!(extent.prod() < least_area)) continue;
      least_area = extent.prod();
      low -= 0.01 * extent;
      extent *= 1.02;
      if (extent.x() < extent.y()) {  // the map is wider than high
        turn.row(0).swap(turn.row(1));
        turn.row(1) *= -1.0;
        low = Eigen::Vector2d(low.y(), -low.x() - extent.x());
        extent = Eigen::Vector2d(extent.y(), extent.x());
      }
      const Eigen::Vector2d scale = Eigen::Vector2d(kMap.width, kMap.height).cwiseQuotient(extent);
      map_from_plane << scale.asDiagonal() * turn, -scale.cwiseProduct(low),
          Eigen::RowVector3d::UnitZ();
    }
    return map_from_plane * plane_from_ray;
  }

  Samples samples_;
  std::vector<Eigen::Vector3d> rays_;
  Eigen::Vector3d mean_ray_, middle_, depth_row_;
};

// Rectangles have no first corner: u may run either way, and v.
double RowDifference(const Eigen::RowVector4d& actual,
                     const Eigen::RowVector4d& expected,
                     const Eigen::RowVector4d& w_row,
                     double size) {
  const double same = (actual - expected).norm();
  const double flipped = (actual - (size * w_row - expected)).norm();
  return std::min(same, flipped) / expected.norm();
}

TEST(AsPublished, FollowsAlgorithm1StepByStep) {
  int num_compared = 0, num_improved = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const TestScene scene(seed, 3, 64, 40);
    for (const Light& light : scene.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      const auto matrix = FitLight(scene.View(), light, kMap, FitOptions::AsPublished());
      if (!matrix.ok() || matrix->search.stop_reason == StopReason::kTooFewSamples) continue;
      Algorithm1 by_hand(scene.View(), light);
      const Eigen::Matrix<double, 3, 4> expected = by_hand.Run() * RayFromWorld(light);
      EXPECT_LE(RelativeError(matrix->search.energy_start, by_hand.energy_start), 1e-9);
      EXPECT_LE(RelativeError(matrix->figures.energy, by_hand.energy), 1e-9);
      // The matrix is free up to a factor.
      const Eigen::RowVector4d w_row = matrix->map_from_world.row(3);
      const double scale = w_row.norm() / expected.row(2).norm();
      EXPECT_LE((w_row - scale * expected.row(2)).norm(), 1e-7 * w_row.norm());
      EXPECT_LE(RowDifference(matrix->map_from_world.row(0), scale * expected.row(0), w_row, 512),
                1e-6);
      EXPECT_LE(RowDifference(matrix->map_from_world.row(1), scale * expected.row(1), w_row, 256),
                1e-6);
      ++num_compared;
      num_improved +=
          static_cast<int>(matrix->figures.energy < 0.999 * matrix->search.energy_start);
    }
  }
  EXPECT_GE(num_compared, 15);
  EXPECT_GE(num_improved, 5);
}

// Evaluated from the summary the published search takes the same steps.
TEST(AsPublished, SampleBySampleEqualsFromTheSummary) {
  int num_compared = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const TestScene scene(seed, 6);
    for (const Light& light : scene.lights) {
      SCOPED_TRACE(light.name + ", seed " + std::to_string(seed));
      FitOptions options = FitOptions::AsPublished();
      const auto by_sample = FitLight(scene.View(), light, kMap, options);
      options.sample_by_sample = false;
      const auto by_summary = FitLight(scene.View(), light, kMap, options);
      ASSERT_EQ(by_sample.ok(), by_summary.ok());
      if (!by_sample.ok()) continue;
      EXPECT_LE(RelativeError(by_sample->search.energy_start, by_summary->search.energy_start),
                1e-9);
      EXPECT_LE(RelativeError(by_sample->figures.energy, by_summary->figures.energy), 1e-9);
      EXPECT_EQ(by_sample->search.evaluations, by_summary->search.evaluations);
      ++num_compared;
    }
  }
  EXPECT_GE(num_compared, 50);
}

TEST(AsPublished, IsThePapersChoices) {
  const FitOptions options = FitOptions::AsPublished();
  EXPECT_EQ(options.metric, Metric::kL2);
  EXPECT_EQ(options.cover, Cover::kReceivers);
  EXPECT_FALSE(options.samples.use_outlines);
  EXPECT_EQ(options.search, Search::kRotationLineSearch);
  EXPECT_EQ(options.affine, Affine::kMinAreaRectangle);
  EXPECT_EQ(options.ray_space, RaySpace::kLightSpace);
  EXPECT_EQ(options.line_search_rounds, 3);
  EXPECT_TRUE(options.sample_by_sample);
}

}  // namespace
}  // namespace lightfit
