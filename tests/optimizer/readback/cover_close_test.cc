// Lights so close to their receivers that tiles of pixels reach around them: the cover comes from
// pixels one by one, as it would from the rays of all of them at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cstdio>
#include <memory_resource>
#include <optional>
#include <vector>

#include "base/scratch.h"
#include "geometry/convex_hull.h"
#include "geometry/ray_cone.h"
#include "optimizer/readback/cover.h"
#include "optimizer/readback/covered_surfaces.h"
#include "tests/optimizer/tracking/hanging_lamp.h"
#include "tests/testing/matchers.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::HangingLamp;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::MatrixNear;
using testing::Random;
using testing::StatusIs;

constexpr auto kFailedPrecondition = absl::StatusCode::kFailedPrecondition;

// From the light to all pixels, or to those that are shadowed: world units.
std::vector<Eigen::Vector3d> RaysOf(const Surfaces& surfaces, const Light& light, Cover which) {
  const Readback& readback = surfaces.readback;
  const Matrix34d ray_from_screen = RayFromWorld(light) * surfaces.world_from_screen;
  std::vector<Eigen::Vector3d> rays;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t pixel = static_cast<size_t>(y) * readback.width() + x;
      const double depth = readback.depth[pixel];
      if (!surfaces.affine_depth.IsSurface(depth)) continue;
      const bool is_shadowed = ((readback.shadow_bits[pixel] >> light.shadow_bit) & 1u) != 0;
      if (which == Cover::kShadowed && !is_shadowed) continue;
      const double d = surfaces.affine_depth.At(x, y, depth);
      const Eigen::Vector4d screen(x + 0.5, y + 0.5, d, 1.0);
      rays.push_back(ray_from_screen * screen / surfaces.world_from_screen.row(3).dot(screen));
    }
  }
  return rays;
}

bool BoxesSurround(const Surfaces& surfaces, const DepthTiles& tiles, const Light& light) {
  const Matrix34d ray_from_screen = RayFromWorld(light) * surfaces.world_from_screen;
  std::vector<Eigen::Vector3d> corners;
  ForEachTile(tiles.grids[0], [&](const DepthTile& tile) {
    for (const Eigen::Vector4d& corner : Corners(tile)) corners.push_back(ray_from_screen * corner);
  });
  return !FeasibleAxis(corners).has_value();
}

// That all rays are in the cover, with room for nothing else.
void ExpectCoverOf(const RayCover& cover, Cover which, const std::vector<Eigen::Vector3d>& rays) {
  std::vector<Eigen::Vector2d> points;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double near = 1e300, far = -1e300;
  for (const Eigen::Vector3d& ray : rays) {
    const Eigen::Vector3d normalized = cover.normalized_from_ray * ray;
    ASSERT_GT(normalized.z(), 0.0);
    points.push_back(normalized.hnormalized());
    mean += ray.normalized();
    near = std::min(near, normalized.z());
    far = std::max(far, normalized.z());
  }
  const Polygon exact = ConvexHull(points);
  EXPECT_NEAR(Area(cover.hull), Area(exact), 1e-9);
  EXPECT_THAT(cover.mean_ray, MatrixNear(Eigen::Vector3d(mean.normalized()), 1e-12));
  EXPECT_NEAR(cover.depth.near, near, 1e-12 * far);
  EXPECT_GE(cover.depth.far, far * (1.0 - 1e-12));
  // Lit receivers may be further away.
  if (which == Cover::kReceivers) {
    EXPECT_NEAR(cover.depth.far, far, 1e-12 * far);
  }
}

TEST(CoverCloseBy, IsThatOfAllRaysTakenAtOnce) {
  Random random(91);
  int num_one_by_one = 0, num_surrounded = 0;
  for (int i = 0; i < 60; ++i) {
    HangingLamp lamp(random.Int(40, 150), random.Int(30, 90), random.Int(1, 6));
    // Somewhere between the highs and the lows, if not beyond them.
    lamp.light.position += 0.2 * random.InCube(1.0);
    const Cover which = i % 2 == 0 ? Cover::kShadowed : Cover::kReceivers;
    if (i % 4 == 1) lamp.RemoveLitFloor();  // else that is all around
    SCOPED_TRACE(i);
    const Surfaces surfaces = *FindSurfaces(lamp.readback.View(), ~0u, {});
    const absl::StatusOr<RayCover> cover = CoverReceivers(surfaces, lamp.light, which);
    const std::vector<Eigen::Vector3d> rays = RaysOf(surfaces, lamp.light, which);
    const std::optional<Eigen::Vector3d> axis = FeasibleAxis(rays);
    if (!axis.has_value()) {
      EXPECT_THAT(cover, StatusIs(kFailedPrecondition, HasSubstr("light \"lamp\"")));
      ++num_surrounded;
      continue;
    }
    ASSERT_THAT(cover, IsOk());
    const DepthTiles tiles =
        BuildDepthTiles(surfaces.readback,
                        surfaces.affine_depth,
                        {surfaces.readback.shadow_bits, uint32_t{1} << lamp.light.shadow_bit});
    if (!BoxesSurround(surfaces, tiles, lamp.light)) continue;  // cover_test.cc
    ++num_one_by_one;
    EXPECT_THAT(Eigen::Vector3d(cover->normalized_from_ray.row(2)), MatrixNear(*axis, 1e-9));
    ExpectCoverOf(*cover, which, rays);
  }
  std::printf("%d covers from pixels, %d lamps surrounded\n", num_one_by_one, num_surrounded);
  EXPECT_GE(num_one_by_one, 10);
  EXPECT_GE(num_surrounded, 5);
}

TEST(CoverCloseBy, LowestRayIsThatOfAllPixels) {
  Random random(92);
  for (int i = 0; i < 20; ++i) {
    HangingLamp lamp(random.Int(40, 150), random.Int(30, 90));
    lamp.light.position += random.LogUniform(1e-3, 10.0) * random.InCube(1.0);
    const Surfaces surfaces = *FindSurfaces(lamp.readback.View(), ~0u, {});
    const Matrix34d ray_from_screen = RayFromWorld(lamp.light) * surfaces.world_from_screen;
    const CoveredSurfaces covered = {surfaces, surfaces.tiles};
    const std::vector<Eigen::Vector3d> rays = RaysOf(surfaces, lamp.light, Cover::kReceivers);
    const UnitRaySum sum = SumOfUnitRays(covered, ray_from_screen);
    EXPECT_EQ(sum.count, static_cast<int64_t>(rays.size()));
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d axis = random.UnitVector();
      double lowest = 1e300, total = 0.0;
      for (const Eigen::Vector3d& ray : rays) {
        lowest = std::min(lowest, axis.dot(ray.normalized()));
        total += axis.dot(ray.normalized());
      }
      EXPECT_NEAR(axis.dot(LowestOfUnitRays(covered, ray_from_screen, axis)), lowest, 1e-14);
      EXPECT_NEAR(axis.dot(sum.sum), total, 1e-14 * static_cast<double>(rays.size()));
    }
  }
}

// Hands on to the heap and keeps count.
class PeakCounter final : public std::pmr::memory_resource {
 public:
  size_t peak_bytes() const { return peak_bytes_; }

 private:
  void* do_allocate(size_t bytes, size_t alignment) override {
    bytes_ += bytes;
    peak_bytes_ = std::max(peak_bytes_, bytes_);
    return std::pmr::new_delete_resource()->allocate(bytes, alignment);
  }
  void do_deallocate(void* memory, size_t bytes, size_t alignment) override {
    bytes_ -= bytes;
    std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  size_t bytes_ = 0, peak_bytes_ = 0;
};

// A few bytes for each pixel are those of tiles and their corners.
TEST(CoverCloseBy, TakesLittleMemory) {
  constexpr double kMostBytesPerPixel = 4.0;
  HangingLamp lamp(1280, 720);
  lamp.RemoveLitFloor();
  const Surfaces surfaces = *FindSurfaces(lamp.readback.View(), ~0u, {});
  ASSERT_TRUE(BoxesSurround(surfaces, surfaces.tiles, lamp.light));
  PeakCounter counter;
  const ScratchScope scope(&counter);
  for (const Cover which : {Cover::kShadowed, Cover::kReceivers}) {
    ASSERT_THAT(CoverReceivers(surfaces, lamp.light, which), IsOk());
    const double bytes_per_pixel =
        static_cast<double>(counter.peak_bytes()) / lamp.readback.depth.size();
    std::printf("%.2f bytes per pixel\n", bytes_per_pixel);
    EXPECT_GT(bytes_per_pixel, 0.1);
    EXPECT_LT(bytes_per_pixel, kMostBytesPerPixel);
  }
}

}  // namespace
}  // namespace lightfit
