#include "partition/served_rays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "optimizer/energy/footprint.h"
#include "optimizer/readback/needed_surfaces.h"
#include "tests/partition/plan_case.h"

namespace lightfit {
namespace {

using testing::HasShadows;
using testing::PlanCase;

// Whether the cone of a bin's hull holds a ray: on the inner side of all its edges. Of fewer than
// three rays, where pixels have no plane, whether it lies between them.
bool ConeHolds(const RayBin& bin, const Eigen::Vector3d& ray) {
  constexpr double kRounding = 1e-9;
  const size_t n = bin.hull.size();
  if (n == 0) return false;
  if (n < 3) {
    const Eigen::Vector3d a = bin.hull[0].normalized(), b = bin.hull[n - 1].normalized();
    const Eigen::Vector3d c = ray.normalized();
    return (a - c).norm() + (c - b).norm() <= (a - b).norm() + kRounding;
  }
  for (size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d a = bin.hull[i].normalized(), b = bin.hull[(i + 1) % n].normalized();
    if (a.cross(b).dot(ray.normalized()) < -kRounding) return false;
  }
  return true;
}

TEST(ServedRays, CoverEveryPixelThatTheBorderWouldAnswerWrongly) {
  int num_pixels = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    for (int index = 0; index < 3; ++index) {
      for (const Border border : {Border::kLit, Border::kDark}) {
        const PlanCase at(seed, index, border);
        if (!HasShadows(at)) continue;
        const NeededSurfaces needed(at.surfaces, at.light, border);
        const uint32_t bit = uint32_t{1} << at.light.shadow_bit;
        const Eigen::Matrix<double, 3, 4> ray_from_screen =
            at.view.normalized_from_ray() * RayFromWorld(at.light) * at.surfaces.world_from_screen;
        int64_t count = 0;
        for (int y = 0; y < at.readback.height(); ++y) {
          for (int x = 0; x < at.readback.width(); ++x) {
            const size_t pixel = at.readback.Index(x, y);
            if ((needed.words()[pixel] & bit) == 0) continue;
            if (!at.surfaces.affine_depth.IsSurface(at.readback.depth[pixel])) continue;
            ++count;
            constexpr int kLookedAt = 5;  // every so many of them
            if (count % kLookedAt != 0) continue;
            const double d = at.surfaces.affine_depth.At(x, y, at.readback.depth[pixel]);
            const Eigen::Vector3d ray = ray_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, d, 1.0);
            EXPECT_TRUE(std::any_of(at.rays.bins.begin(),
                                    at.rays.bins.end(),
                                    [&](const RayBin& bin) { return ConeHolds(bin, ray); }))
                << at.light.name << " seed " << seed << " pixel " << x << " " << y;
          }
        }
        EXPECT_EQ(at.rays.num_covered, count);
        num_pixels += static_cast<int>(count);
      }
    }
  }
  EXPECT_GT(num_pixels, 5000);
}

TEST(ServedRays, BoundarySamplesAreThoseOfTheViewAndTheFloorWeighsATenthOfThem) {
  constexpr double kFloorShare = 0.1;  // ServedRaysOptions::floor_share
  constexpr double kRounding = 1e-12;
  int num_cases = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    for (int index = 0; index < 3; ++index) {
      const PlanCase at(seed, index);
      if (!HasShadows(at)) continue;
      ++num_cases;
      ASSERT_EQ(at.rays.num_boundary, static_cast<int>(at.view.samples.size()));
      const MetricWeights metric = WeightsOf(at.fit.metric, at.fit.along_edge_share);
      double floor = 0.0, boundary = 0.0;
      int num_floor = 0;
      for (const RaySample& sample : at.rays.samples) {
        // Boundary samples have a weight of their own, of 1.
        if (sample.weight != 1.0) {
          floor += sample.weight;
          ++num_floor;
        } else {
          boundary += sample.weight;
        }
      }
      EXPECT_EQ(num_floor + at.rays.num_boundary, static_cast<int>(at.rays.samples.size()));
      EXPECT_NEAR(floor / boundary, kFloorShare, kRounding);
      for (size_t i = 0; i < at.view.samples.size(); ++i) {
        const Sample sample = at.view.samples.At(i);
        const SymmetricVector tensor = ToSymmetricVector(MetricTensor(sample, metric));
        EXPECT_TRUE(std::any_of(
            at.rays.samples.begin(), at.rays.samples.end(), [&](const RaySample& other) {
              return other.X == sample.X && other.G == tensor;
            }));
      }
    }
  }
  EXPECT_GE(num_cases, 6);
}

// The corners of neighbouring pixels of one plane meet: on a floor that is dark all over, bins'
// cones leave no gap between pixels' centres.
TEST(ServedRays, CornersOfAPlaneTileTheScreen) {
  int num_places = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const PlanCase at(seed, 0);
    const uint32_t bit = 1;
    const Eigen::Matrix<double, 3, 4> ray_from_screen =
        at.view.normalized_from_ray() * RayFromWorld(at.light) * at.surfaces.world_from_screen;
    for (int y = 1; y + 2 < at.readback.height(); ++y) {
      for (int x = 1; x + 2 < at.readback.width(); ++x) {
        // Both of a pair are dark and on one plane: the place half way between them.
        DepthGradient here, there;
        const bool are_dark = (at.readback.shadow_bits[at.readback.Index(x, y)] & bit) != 0 &&
                              (at.readback.shadow_bits[at.readback.Index(x + 1, y)] & bit) != 0 &&
                              (at.readback.facing_bits[at.readback.Index(x, y)] & bit) != 0 &&
                              (at.readback.facing_bits[at.readback.Index(x + 1, y)] & bit) != 0;
        if (!are_dark ||
            !DepthGradientAt(at.readback, at.surfaces.affine_depth, at.fit.samples, x, y, &here) ||
            !DepthGradientAt(
                at.readback, at.surfaces.affine_depth, at.fit.samples, x + 1, y, &there) ||
            here.is_one_sided || there.is_one_sided ||
            std::abs(here.d + here.d_x - there.d) > 1e-6 * std::abs(here.d)) {
          continue;
        }
        const Eigen::Vector4d place(x + 1.0, y + 0.5, here.d + 0.5 * here.d_x, 1.0);
        const Eigen::Vector3d ray = ray_from_screen * place;
        constexpr double kFloat = 1e-4;  // depths are single precision
        EXPECT_TRUE(std::any_of(at.rays.bins.begin(),
                                at.rays.bins.end(),
                                [&](const RayBin& bin) {
                                  const size_t n = bin.hull.size();
                                  for (size_t i = 0; i < n; ++i) {
                                    const Eigen::Vector3d a = bin.hull[i].normalized();
                                    const Eigen::Vector3d b = bin.hull[(i + 1) % n].normalized();
                                    if (a.cross(b).normalized().dot(ray.normalized()) < -kFloat)
                                      return false;
                                  }
                                  return n >= 3;
                                }))
            << x << " " << y;
        ++num_places;
      }
    }
  }
  EXPECT_GT(num_places, 500);
}

TEST(ServedRays, AreTheSameWhateverCameBefore) {
  const PlanCase one(2, 0), other(2, 0);
  ASSERT_EQ(one.rays.bins.size(), other.rays.bins.size());
  for (size_t i = 0; i < one.rays.bins.size(); ++i) {
    EXPECT_EQ(one.rays.bins[i].hull, other.rays.bins[i].hull);
    EXPECT_EQ(one.rays.bins[i].middle, other.rays.bins[i].middle);
  }
}

}  // namespace
}  // namespace lightfit
