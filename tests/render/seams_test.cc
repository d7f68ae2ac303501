#include "render/seams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "geometry/affine_depth.h"
#include "geometry/homography.h"
#include "optimizer/readback/edge_normals.h"
#include "render/readback_image.h"
#include "tests/render/plan_stage.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::PlanStage;
using testing::Random;
using testing::RandomLightAbove;
using testing::RandomPlan;
using testing::StatusIs;
using testing::WarpedPlan;

std::vector<Seam> Found(const PlanStage& stage, const Plan& plan) {
  const auto seams = FindSeams(stage.image, stage.truth, stage.light, plan);
  EXPECT_THAT(seams, IsOk());
  return seams.ok() ? *seams : std::vector<Seam>();
}

constexpr std::array<std::array<int, 2>, 4> kSides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

// The pixel at a side of another; -1 where the image ends.
int PixelAt(const SurfaceImage& image, int pixel, const std::array<int, 2>& side) {
  const int x = pixel % image.camera.width + side[0], y = pixel / image.camera.width + side[1];
  if (x < 0 || x >= image.camera.width || y < 0 || y >= image.camera.height) return -1;
  return y * image.camera.width + x;
}

bool IsInside(const SurfaceImage& image, int pixel) {
  for (const auto& side : kSides) {
    if (PixelAt(image, pixel, side) < 0) return false;
  }
  return true;
}

// Whether the four neighbours lie in the pixel's plane, which therefore goes on to all sides.
bool IsFlatAround(const SurfaceImage& image, int pixel) {
  const SurfacePoint& own = image.pixels[pixel];
  for (const auto& side : kSides) {
    const int other = PixelAt(image, pixel, side);
    if (other < 0 || !image.pixels[other].is_surface()) return false;
    const SurfacePoint& point = image.pixels[other];
    if (std::abs(own.normal.dot(point.position - own.position)) > 1e-4) return false;
    if (own.normal.dot(point.normal) < 1.0 - 1e-9) return false;
  }
  return true;
}

double CosineToLight(const Light& light, const SurfacePoint& point) {
  const Eigen::Vector3d to_light = light.kind == Light::Kind::kPoint
                                       ? Eigen::Vector3d(light.position - point.position)
                                       : Eigen::Vector3d(-light.direction);
  return point.normal.dot(to_light.normalized());
}

// Where the map has the point of the pixel's plane that is seen `offset` pixels from its centre.
Eigen::Vector2d TexelSeenAt(const SurfaceImage& image,
                            const PlanMap& map,
                            int pixel,
                            const Eigen::Vector2d& offset) {
  const SurfacePoint& point = image.pixels[pixel];
  const Eigen::Matrix4d world_from_screen = image.camera.WorldFromScreen();
  const int column = pixel % image.camera.width, row = pixel / image.camera.width;
  const double x = column + 0.5 + offset.x(), y = row + 0.5 + offset.y();
  const auto at_depth = [&](double d) -> Eigen::Vector3d {
    return (world_from_screen * Eigen::Vector4d(x, y, d, 1.0)).hnormalized();
  };
  const double d = image.camera.orthographic ? point.camera_z : 1.0 / point.camera_z;
  const Eigen::Vector3d a = at_depth(0.9 * d), b = at_depth(1.1 * d);
  const double share = point.normal.dot(point.position - a) / point.normal.dot(b - a);
  const Eigen::Vector4d at = map.map_from_world * (a + share * (b - a)).homogeneous();
  return at.head<2>() / at.w();
}

// Pixels per texel on the pixel's plane, by central differences.
Eigen::Matrix2d FootprintByDifferences(const SurfaceImage& image, const PlanMap& map, int pixel) {
  constexpr double kStep = 1e-3;
  Eigen::Matrix2d J_map_screen;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
    J_map_screen.col(axis) =
        (TexelSeenAt(image, map, pixel, step) - TexelSeenAt(image, map, pixel, -step)) /
        (2.0 * kStep);
  }
  return J_map_screen.inverse();
}

double RootMeanSquare(const Eigen::Matrix2d& J_screen_map) {
  return std::sqrt(0.5 * (J_screen_map.col(0).squaredNorm() + J_screen_map.col(1).squaredNorm()));
}

// Whether one of the four neighbours is lit and the pixel dark, or the reverse.
bool IsBesideOther(const PlanStage& stage, int pixel) {
  const Lighting other =
      stage.truth[pixel] == Lighting::kLit ? Lighting::kShadowed : Lighting::kLit;
  for (const auto& side : kSides) {
    const int neighbour = PixelAt(stage.image, pixel, side);
    if (neighbour >= 0 && stage.truth[neighbour] == other) return true;
  }
  return false;
}

TEST(FindSeams, RatiosAreThoseOfDifferencesOnTheSurface) {
  // Depth in single precision.
  constexpr double kTolerance = 1e-3;
  int num_compared = 0, num_at_edges = 0;
  for (uint64_t seed = 901; seed < 921; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    const int num_maps = random.Int(2, 7);
    const Plan plan =
        seed % 2 == 0 ? RandomPlan(stage, random, num_maps) : WarpedPlan(stage, random, num_maps);
    ReadbackImage image = ReadbackOf(stage.image);
    AddShadow(stage.truth, stage.light.shadow_bit, &image);
    const Readback readback = image.View();
    const AffineDepth affine_depth(readback.camera, readback.depth_kind);
    const EdgeNormals normals(readback, affine_depth, stage.light.shadow_bit, /*window=*/2);
    for (const Seam& seam : Found(stage, plan)) {
      const auto normal = [&](int pixel) {
        return normals.At(pixel % readback.width(), pixel / readback.width());
      };
      // A lone dark pixel's edge has no direction.
      EXPECT_EQ(seam.is_at_edge,
                (IsBesideOther(stage, seam.pixel) || IsBesideOther(stage, seam.neighbour)) &&
                    !normal(seam.pixel).isZero() && !normal(seam.neighbour).isZero());
      double footprint = 1.0, area = 1.0, across = 1.0;
      bool is_flat = true;
      for (const int pixel : {seam.pixel, seam.neighbour}) {
        is_flat = is_flat && IsFlatAround(stage.image, pixel) &&
                  CosineToLight(stage.light, stage.image.pixels[pixel]) > 0.02;
        const Eigen::Matrix2d J = FootprintByDifferences(stage.image, plan.maps[seam.map], pixel);
        const Eigen::Matrix2d other_J =
            FootprintByDifferences(stage.image, plan.maps[seam.neighbour_map], pixel);
        footprint *= std::sqrt(RootMeanSquare(other_J) / RootMeanSquare(J));
        area *= std::sqrt(std::abs(other_J.determinant() / J.determinant()));
        const Eigen::RowVector2d n = normal(pixel).transpose();
        if (seam.is_at_edge) {
          across *= std::sqrt(std::hypot(n * other_J.col(0), n * other_J.col(1)) /
                              std::hypot(n * J.col(0), n * J.col(1)));
        }
      }
      if (!is_flat) continue;
      ++num_compared;
      num_at_edges += seam.is_at_edge;
      EXPECT_NEAR(seam.footprint / footprint, 1.0, kTolerance) << "pixel " << seam.pixel;
      EXPECT_NEAR(seam.area / area, 1.0, kTolerance) << "pixel " << seam.pixel;
      EXPECT_NEAR(seam.across / across, 1.0, kTolerance) << "pixel " << seam.pixel;
    }
  }
  EXPECT_GT(num_compared, 1000);
  EXPECT_GT(num_at_edges, 50);
}

// All pairs of neighbours, by the look-up alone.
TEST(FindSeams, EveryBorderOnAFlatSurfaceIsFoundOnce) {
  int num_sure = 0, num_found = 0, num_unsure = 0, num_by_density = 0;
  for (uint64_t seed = 911; seed < 919; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random));
    const int num_maps = random.Int(2, 7);
    const Plan plan =
        seed % 2 == 0 ? RandomPlan(stage, random, num_maps) : WarpedPlan(stage, random, num_maps);
    const PlanLookUp look_up = *PlanLookUp::Create(plan, stage.light);
    std::map<std::pair<int, int>, Seam> found;
    for (const Seam& seam : Found(stage, plan)) {
      EXPECT_TRUE(found.insert({{seam.pixel, seam.neighbour}, seam}).second);
    }
    const SurfaceImage& image = stage.image;
    for (int pixel = 0; pixel < static_cast<int>(image.pixels.size()); ++pixel) {
      for (const int side : {0, 2}) {
        const int neighbour = PixelAt(image, pixel, kSides[side]);
        const auto seam = found.find({pixel, neighbour});
        const bool is_found = seam != found.end();
        num_found += is_found;
        if (neighbour < 0 || !IsJudged(stage.truth[pixel]) || !IsJudged(stage.truth[neighbour])) {
          EXPECT_FALSE(is_found);
          continue;
        }
        const Eigen::Vector3d &world = image.pixels[pixel].position,
                              &other_world = image.pixels[neighbour].position;
        const int map = look_up.At(world).map, other_map = look_up.At(other_world).map;
        if (map < 0 || other_map < 0 || map == other_map || !IsInside(image, pixel) ||
            !IsInside(image, neighbour)) {
          EXPECT_FALSE(is_found);
          continue;
        }
        const bool is_sure = IsFlatAround(image, pixel) && IsFlatAround(image, neighbour) &&
                             CosineToLight(stage.light, image.pixels[pixel]) > 0.01;
        num_sure += is_sure;
        num_unsure += !is_sure;
        if (is_sure) {
          EXPECT_TRUE(is_found) << "pixels " << pixel << ", " << neighbour;
        }
        if (!is_found) continue;
        EXPECT_EQ(seam->second.map, map);
        EXPECT_EQ(seam->second.neighbour_map, other_map);
        Eigen::Vector2d texel;
        const bool hold_both = look_up.IsAskable(map, other_world, &texel) &&
                               look_up.IsAskable(other_map, world, &texel);
        EXPECT_EQ(seam->second.is_by_density, hold_both);
        num_by_density += hold_both;
      }
    }
  }
  std::printf("%d found, %d of them by density; %d must be, %d may be\n",
              num_found,
              num_by_density,
              num_sure,
              num_unsure);
  EXPECT_GT(num_sure, 500);
  EXPECT_GT(num_by_density, 100);
}

// math.md (19): the area of a texel on the screen is q^3 / |V|, so that the denser of two maps
// changes where they are the same.
TEST(FindSeams, AreaIsContinuousWhereTheDenserMapIsAsked) {
  // V belongs to the pixel, whatever single precision makes of its depth: ratios are free of it.
  constexpr double kRounding = 1e-6;
  std::vector<Seam> all;
  for (uint64_t seed = 921; seed < 933; ++seed) {
    Random random(seed);
    const PlanStage stage(seed, RandomLightAbove(random), 192, 144);
    const int num_maps = random.Int(2, 7);
    const Plan plan =
        seed % 2 == 0 ? RandomPlan(stage, random, num_maps) : WarpedPlan(stage, random, num_maps);
    const PlanLookUp look_up = *PlanLookUp::Create(plan, stage.light);
    for (const Seam& seam : Found(stage, plan)) {
      all.push_back(seam);
      const auto ratio = [&](int pixel) {
        const Eigen::Vector3d& world = stage.image.pixels[pixel].position;
        return std::pow(
            look_up.CoarsenessOf(seam.neighbour_map, world) / look_up.CoarsenessOf(seam.map, world),
            3.0);
      };
      const double here = ratio(seam.pixel), there = ratio(seam.neighbour);
      EXPECT_NEAR(seam.area / std::sqrt(here * there), 1.0, kRounding);
      if (!seam.is_by_density) continue;
      // Each asks the one that is denser there, and the border runs between them.
      EXPECT_GE(here, 1.0);
      EXPECT_LE(there, 1.0);
    }
  }
  const SeamStatistics statistics = StatisticsOf(all);
  for (const SeamJumps& jumps : {statistics.all, statistics.by_density}) {
    std::printf(
        "%lld seams, %lld at edges; area %.4f, %.4f; footprint %.3f, %.3f; "
        "across %.3f, %.3f\n",
        static_cast<long long>(jumps.seams),
        static_cast<long long>(jumps.at_edges),
        jumps.area.mean,
        jumps.area.p99,
        jumps.footprint.mean,
        jumps.footprint.p99,
        jumps.across.mean,
        jumps.across.p99);
  }
  EXPECT_GT(statistics.by_density.seams, 1000);
  EXPECT_GT(statistics.by_density.at_edges, 30);
  EXPECT_LT(statistics.by_density.area.mean, 1.01);
  EXPECT_LT(statistics.by_density.area.p99, 1.1);
  // Shape and direction jump all the same; and rectangles end anywhere.
  EXPECT_GT(statistics.by_density.footprint.mean, 1.02);
  EXPECT_GT(statistics.all.area.mean, 1.2);
}

// The world from above, 8 pixels to a unit, 96 x 80 pixels around the origin.
Camera FromAbove() {
  Camera camera;
  camera.width = 96;
  camera.height = 80;
  camera.orthographic = true;
  camera.camera_from_world << 1, 0, 0, 0,  //
      0, -1, 0, 0,                         //
      0, 0, -1, 50,                        //
      0, 0, 0, 1;
  camera.screen_from_camera << 8, 0, 48,  //
      0, 8, 40,                           //
      0, 0, 1;
  return camera;
}

// Texels of 1/columns by 1/rows units around the origin of the floor, seen by a light from above.
PlanMap NoonMap(const Light& noon, double columns, double rows) {
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(noon);
  Eigen::Matrix3d world_from_ray = Eigen::Matrix3d::Identity();
  world_from_ray.topLeftCorner<2, 2>() = ray_from_world.topLeftCorner<2, 2>().inverse();
  Eigen::Matrix3d map_from_world;
  map_from_world << columns, 0, 100, 0, rows, 100, 0, 0, 1;
  return testing::PlanMapOf(
      MapFromWorld(map_from_world * world_from_ray, ray_from_world, noon, {1.0, 2.0}, 1.0),
      {200, 200});
}

TEST(FindSeams, OfAFloorSplitByAHalfSpaceByHand) {
  const Light noon = Light::Directional("noon", {0.0, 0.0, -1.0}, /*shadow_bit=*/3);
  // A bar along x, which hangs over the camera.
  Scene scene;
  testing::AddFloor(20.0, &scene);
  testing::AddQuad({-30, 0.03, 60}, {30, 0.03, 60}, {30, 3, 60}, {-30, 3, 60}, &scene);
  const RayCaster caster = testing::Caster(scene);
  const SurfaceImage image = *RenderSurfaces(caster, FromAbove());
  const std::vector<Lighting> truth = TrueLighting(caster, image, noon);
  Plan plan;
  plan.maps = {NoonMap(noon, 2.0, 3.0), NoonMap(noon, 1.0, 1.0)};
  plan.maps[0].half_spaces.push_back({-1.0, 0.0, 0.0, 0.01});  // left of x = 0.01
  plan.maps[1].half_spaces.push_back({1.0, 0.0, 0.0, -0.01});
  const auto seams = FindSeams(image, truth, noon, plan);
  ASSERT_THAT(seams, IsOk());
  // One to each row but the outermost two, whose pixels have neighbours on three sides only.
  ASSERT_EQ(seams->size(), 78u);
  // Texels of 4 x 8/3 pixels, and of 8 x 8.
  const double footprint = 8.0 / std::sqrt(0.5 * (16.0 + 64.0 / 9.0));
  int at_edges = 0;
  for (size_t i = 0; i < seams->size(); ++i) {
    const Seam& seam = (*seams)[i];
    EXPECT_EQ(seam.pixel, static_cast<int>(i + 1) * 96 + 47);
    EXPECT_EQ(seam.neighbour, seam.pixel + 1);
    EXPECT_EQ(seam.map, 0);
    EXPECT_EQ(seam.neighbour_map, 1);
    EXPECT_FALSE(seam.is_by_density);
    EXPECT_NEAR(seam.footprint, footprint, 1e-6);
    EXPECT_NEAR(seam.area, 6.0, 1e-6);
    at_edges += seam.is_at_edge;
    // The edges run along x: across them texels are 8/3 and 8 pixels.
    EXPECT_NEAR(seam.across, seam.is_at_edge ? 3.0 : 1.0, 1e-6);
  }
  EXPECT_EQ(at_edges, 4);  // a row on either side of each of two edges
  const SeamJumps jumps = StatisticsOf(*seams).all;
  EXPECT_EQ(jumps.seams, 78);
  EXPECT_EQ(jumps.at_edges, 4);
  EXPECT_NEAR(jumps.area.mean, 6.0, 1e-6);
  EXPECT_NEAR(jumps.across.p99, 3.0, 1e-6);
  EXPECT_EQ(StatisticsOf(*seams).by_density.seams, 0);
}

TEST(StatisticsOf, TurnsRatiosToBeOneOrMore) {
  std::vector<Seam> seams(200);
  for (size_t i = 0; i < seams.size(); ++i) {
    seams[i].footprint = i % 2 == 0 ? 2.0 : 0.5;
    seams[i].area = i < 198 ? 1.0 : 0.25;
    seams[i].is_by_density = i == 0;
    seams[i].is_at_edge = i < 2;
    seams[i].across = i == 0 ? 8.0 : 0.5;
  }
  const SeamStatistics statistics = StatisticsOf(seams);
  EXPECT_EQ(statistics.all.seams, 200);
  EXPECT_EQ(statistics.all.at_edges, 2);
  constexpr double kRounding = 1e-12;  // of 200 logarithms
  EXPECT_NEAR(statistics.all.footprint.mean, 2.0, kRounding);
  EXPECT_DOUBLE_EQ(statistics.all.footprint.p99, 2.0);
  EXPECT_NEAR(statistics.all.area.mean, std::pow(4.0, 0.01), kRounding);
  EXPECT_DOUBLE_EQ(statistics.all.area.p99, 1.0);  // two of 200 are larger
  EXPECT_NEAR(statistics.all.across.mean, 4.0, kRounding);
  EXPECT_DOUBLE_EQ(statistics.all.across.p99, 8.0);
  EXPECT_EQ(statistics.by_density.seams, 1);
  EXPECT_DOUBLE_EQ(statistics.by_density.across.mean, 8.0);

  const SeamStatistics of_none = StatisticsOf({});
  EXPECT_EQ(of_none.all.seams, 0);
  EXPECT_EQ(of_none.all.footprint.mean, 1.0);
  EXPECT_EQ(of_none.all.footprint.p99, 1.0);
}

TEST(FindSeams, OneMapHasNone) {
  Random random(951);
  const PlanStage stage(951, RandomLightAbove(random));
  EXPECT_TRUE(Found(stage, RandomPlan(stage, random, 1)).empty());
}

TEST(FindSeams, RefusesWhatItCannotMeasure) {
  Random random(961);
  const PlanStage stage(961, Light::Directional("sun", {1.0, 0.7, -0.8}));
  const Plan plan = RandomPlan(stage, random, 2);
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(FindSeams(stage.image, {}, stage.light, plan),
              StatusIs(kInvalid, HasSubstr("truth has 0 pixels")));
  EXPECT_THAT(FindSeams(stage.image, stage.truth, stage.light, {}),
              StatusIs(kInvalid, HasSubstr("plan of 0 maps")));
  EXPECT_THAT(FindSeams(stage.image, stage.truth, Light::Point("lamp", {1, 2, 9}), plan),
              StatusIs(kInvalid, HasSubstr("do not leave the light")));
}

}  // namespace
}  // namespace lightfit
