#include "partition/shipped/clipmap_pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>
#include <stop_token>
#include <tuple>

#include "base/stop.h"
#include "methods/view_body.h"
#include "partition/shipped/receiver_pixels.h"
#include "tests/testing/matchers.h"
#include "tests/testing/plane_readback.h"
#include "tests/testing/test_scene.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::MatrixNear;
using testing::Random;
using testing::StatusIs;
using testing::TestScene;

Light RandomSun(Random& random) {
  Eigen::Vector3d direction = random.UnitVector();
  direction.z() = -std::abs(direction.z()) - 0.2;
  return Light::Directional("sun", direction);
}

// Twin of the pages that are asked for, for a floor that fills the image: pixels are cast onto it,
// and page, level and window are told by comparisons instead of logarithms and rounding.
using PageKey = std::tuple<int, int64_t, int64_t>;
std::set<PageKey> PagesByCasting(const PagedMap& map, const Camera& camera, const Light& light) {
  const Eigen::Vector3d eye = EyePosition(camera);
  const Eigen::Matrix3d axes = FrameAlong(light.direction);
  std::set<PageKey> pages;
  const auto ray_through = [&camera](double x, double y) -> Eigen::Vector3d {
    return camera.camera_from_world.topLeftCorner<3, 3>().transpose() *
           camera.screen_from_camera.inverse() * Eigen::Vector3d(x, y, 1.0);
  };
  const auto depth_at = [&](double x, double y) { return -eye.z() / ray_through(x, y).z(); };
  const auto ask = [&](double x, double y, double z) {
    const Eigen::Vector3d ray = ray_through(x, y);
    const double pixel = z / camera.screen_from_camera(0, 0) * std::exp2(map.level_bias);
    int level = -60;
    while (std::exp2(level + 0.5) <= pixel && level < map.last_level) ++level;
    for (;; ++level) {
      const double side = map.page_side * std::exp2(level);
      const Eigen::Vector2d at = axes.topRows<2>() * (eye + z * ray) / side;
      const Eigen::Vector2d middle = axes.topRows<2>() * eye / side;
      const int64_t column = std::llround(std::floor(at.x()));
      const int64_t row = std::llround(std::floor(at.y()));
      const int64_t half = map.pages_per_side / 2;
      const int64_t from_u = std::llround(middle.x()) - half;
      const int64_t from_v = std::llround(middle.y()) - half;
      const bool is_inside = column >= from_u && column < from_u + 2 * half && row >= from_v &&
                             row < from_v + 2 * half;
      if (!is_inside && level < map.last_level) continue;
      pages.insert({level, column, row});
      return;
    }
  };
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      for (const double right : {0.0, 0.5, 1.0}) {
        for (const double down : {0.0, 0.5, 1.0}) {
          if ((right == 0.5) != (down == 0.5)) continue;
          // The outermost pixels have no plane in a read-back: they face the camera.
          const bool is_outermost =
              x == 0 || y == 0 || x + 1 == camera.width || y + 1 == camera.height;
          ask(x + right,
              y + down,
              is_outermost ? depth_at(x + 0.5, y + 0.5) : depth_at(x + right, y + down));
        }
      }
    }
  }
  return pages;
}

TEST(ClipmapPages, AreThoseThatThePixelsAskForByCasting) {
  int num_pages = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    const Light light = RandomSun(random);
    const testing::PlaneReadback floor = testing::FloorReadback();
    const auto surfaces = FindSurfaces(floor.View(), 1, {});
    ASSERT_THAT(surfaces, IsOk());
    ClipmapOptions options;
    options.page_side = seed % 3 == 0 ? 128 : 16;
    options.pages_per_side = seed % 2 == 0 ? 4 : 128;  // so that windows count
    const int pool = random.Int(4, 300);
    const auto map = ClipmapPages(
        *surfaces, light, int64_t{pool} * options.page_side * options.page_side, options);
    ASSERT_THAT(map, IsOk());
    std::set<PageKey> pages;
    for (const MapPage& page : map->pages) pages.insert({page.level, page.column, page.row});
    EXPECT_EQ(pages, PagesByCasting(*map, floor.camera, light)) << map->level_bias;
    num_pages += static_cast<int>(pages.size());
  }
  EXPECT_GT(num_pages, 500);
}

TEST(ClipmapPages, KeepTheBudgetAndEveryReceiverThatAsksFindsItsPage) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TestScene scene(seed, 1);
    Random random(seed);
    const Light light = RandomSun(random);
    const auto surfaces = FindSurfaces(scene.View(), 1, {});
    ASSERT_THAT(surfaces, IsOk());
    const auto max_texels = static_cast<int64_t>(random.LogUniform(4.0 * 128 * 128, 2048.0 * 2048));
    const auto map = ClipmapPages(*surfaces, light, max_texels);
    ASSERT_THAT(map, IsOk());
    EXPECT_LE(NumTexels(*map), max_texels);
    EXPECT_TRUE(std::is_sorted(map->pages.begin(), map->pages.end()));
    ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel& pixel) {
      for (const Eigen::Vector3d& point : pixel.points) {
        const MapPage asked = map->AskedBy(point);
        const PagePlace place = map->At(point);
        ASSERT_GE(place.page, 0);
        EXPECT_EQ(map->pages[place.page], asked);
        EXPECT_GE(place.texel.minCoeff(), 0.0);
        EXPECT_LT(place.texel.maxCoeff(), 128.0);
        // The ray of the place goes through the receiver.
        const TexelRay ray = map->RayAt(place);
        EXPECT_NEAR(ray.direction.dot(light.direction.normalized()), 1.0, 1e-12);
        EXPECT_NEAR((point - ray.origin).cross(ray.direction).norm(), 0.0, 1e-9);
      }
    });
  }
}

TEST(ClipmapPages, HaveTexelsAboutAsLargeAsPixelsTimesTheBias) {
  int num_in_window = 0, num_beyond = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const TestScene scene(seed, 1);
    Random random(seed);
    const Light light = RandomSun(random);
    const auto surfaces = FindSurfaces(scene.View(), 1, {});
    ASSERT_THAT(surfaces, IsOk());
    const auto map = ClipmapPages(*surfaces, light, 1024 * 1024);
    ASSERT_THAT(map, IsOk());
    const Camera& camera = scene.readback.camera;
    const double focal = camera.screen_from_camera(0, 0);
    ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel& pixel) {
      const double size = CameraDepth(camera, pixel.points[0]) / focal;
      const double texel = std::exp2(map->AskedBy(pixel.points[0]).level);
      const double ratio = texel / (size * std::exp2(map->level_bias));
      // Half a level to each side; more where the window of the level ends.
      EXPECT_LE(ratio, std::sqrt(2.0) * 2.0);
      num_in_window += ratio <= std::sqrt(2.0) * (1.0 + 1e-9) ? 1 : 0;
      num_beyond += ratio > std::sqrt(2.0) * (1.0 + 1e-9) ? 1 : 0;
      if (map->AskedBy(pixel.points[0]).level < map->last_level) {
        EXPECT_GE(ratio, std::sqrt(0.5) * (1.0 - 1e-9));
      }
    });
  }
  EXPECT_GT(num_in_window, 10 * num_beyond);
}

TEST(ClipmapPages, HaveTheLeastBiasAtWhichTheyFit) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const TestScene scene(seed, 1);
    Random random(seed);
    const Light light = RandomSun(random);
    const auto surfaces = FindSurfaces(scene.View(), 1, {});
    ASSERT_THAT(surfaces, IsOk());
    const int pool = random.Int(4, 200);
    const auto map = ClipmapPages(*surfaces, light, pool * 128 * 128);
    ASSERT_THAT(map, IsOk());
    EXPECT_EQ(map->level_bias * 8.0, std::round(map->level_bias * 8.0));
    const auto num_asked = [&](double bias) {
      PagedMap other = *map;
      other.level_bias = bias;
      std::set<PageKey> pages;
      ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel& pixel) {
        for (const Eigen::Vector3d& point : pixel.points) {
          const MapPage page = other.AskedBy(point);
          pages.insert({page.level, page.column, page.row});
        }
      });
      return static_cast<int>(pages.size());
    };
    EXPECT_EQ(num_asked(map->level_bias), static_cast<int>(map->pages.size()));
    if (map->level_bias > -4.0) {
      EXPECT_GT(num_asked(map->level_bias - 0.125), pool);
    }
    // Memory without end: texels down to a sixteenth of a pixel.
    const auto all = ClipmapPages(*surfaces, light, int64_t{1} << 40);
    ASSERT_THAT(all, IsOk());
    EXPECT_EQ(all->level_bias, -4.0);
  }
}

TEST(ClipmapPages, StayWhereTheyAreInTheWorldWhenTheCameraMoves) {
  Random random(1);
  const Light light = RandomSun(random);
  Camera camera = testing::FloorCamera();
  const auto map_of = [&light](const Camera& view) {
    const testing::PlaneReadback floor = testing::FloorReadback(view);
    const auto surfaces = FindSurfaces(floor.View(), 1, {});
    ClipmapOptions options;
    options.page_side = 16;
    return *ClipmapPages(*surfaces, light, 100 * 16 * 16, options);
  };
  const PagedMap before = map_of(camera);
  camera.camera_from_world(0, 3) += 0.123;  // to the left
  const PagedMap after = map_of(camera);
  int num_shared = 0;
  for (const MapPage& page : before.pages) {
    const auto same = std::find(after.pages.begin(), after.pages.end(), page);
    if (same == after.pages.end()) continue;
    ++num_shared;
    const PagePlace place = {static_cast<int>(&page - before.pages.data()), {3.5, 7.5}};
    const PagePlace again = {static_cast<int>(same - after.pages.begin()), {3.5, 7.5}};
    EXPECT_EQ(before.RayAt(place).origin, after.RayAt(again).origin);
  }
  EXPECT_GT(num_shared, static_cast<int>(before.pages.size()) / 2);
}

TEST(PagedMap, FindsTheNextCoarserPageWhereItsOwnIsNotThere) {
  int num_asked = 0, num_coarser = 0, num_none = 0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const TestScene scene(seed, 1);
    Random random(seed);
    const Light light = RandomSun(random);
    const auto surfaces = FindSurfaces(scene.View(), 1, {});
    ASSERT_THAT(surfaces, IsOk());
    ClipmapOptions options;
    options.page_side = 16;
    auto map = ClipmapPages(*surfaces, light, 200 * 16 * 16, options);
    ASSERT_THAT(map, IsOk());
    // Take half of the pages away, and add some that hold much.
    std::erase_if(map->pages, [&random](const MapPage&) { return random.Coin(); });
    for (const int level : {map->last_level, map->last_level - 2}) {
      for (const int64_t row : {-1, 0}) map->pages.push_back({level, 0, row});
    }
    std::sort(map->pages.begin(), map->pages.end());
    map->pages.erase(std::unique(map->pages.begin(), map->pages.end()), map->pages.end());
    ForEachReceiverPixel(*surfaces, [&](const ReceiverPixel& pixel) {
      const Eigen::Vector3d& world = pixel.points[0];
      // Twin: of all pages that hold the receiver's ray the finest that is not too fine.
      const MapPage asked = map->AskedBy(world);
      const Eigen::Vector2d at = FrameAlong(light.direction).topRows<2>() * world;
      int expected = -1;
      for (int i = 0; i < static_cast<int>(map->pages.size()) && expected < 0; ++i) {
        const MapPage& page = map->pages[i];
        const double side = 16.0 * std::exp2(page.level);
        const Eigen::Array2d begin =
            side * Eigen::Array2d(static_cast<double>(page.column), static_cast<double>(page.row));
        const bool is_inside = (at.array() >= begin).all() && (at.array() < begin + side).all();
        if (is_inside && page.level >= asked.level) expected = i;
      }
      const PagePlace place = map->At(world);
      ASSERT_EQ(place.page, expected);
      if (place.page < 0) {
        ++num_none;
        return;
      }
      ++(map->pages[place.page] == asked ? num_asked : num_coarser);
      const TexelRay ray = map->RayAt(place);
      EXPECT_NEAR((world - ray.origin).cross(ray.direction).norm(), 0.0, 1e-9);
    });
  }
  EXPECT_GT(num_asked, 100);
  EXPECT_GT(num_coarser, 100);
  EXPECT_GT(num_none, 100);
}

TEST(PagedMap, AnswersEverywhere) {
  EXPECT_EQ(PagedMap().At({0.0, 0.0, 0.0}).page, -1);
  const testing::PlaneReadback floor = testing::FloorReadback();
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  Random random(2);
  const auto map = ClipmapPages(*surfaces, RandomSun(random), 200 * 128 * 128);
  ASSERT_THAT(map, IsOk());
  for (int i = 0; i < 2000; ++i) {
    // Behind the camera, beyond the last level, anywhere.
    const PagePlace place = map->At(random.LogUniform(1e-6, 1e15) * random.UnitVector());
    EXPECT_LT(place.page, static_cast<int>(map->pages.size()));
    EXPECT_TRUE(place.texel.allFinite());
  }
}

TEST(ClipmapPages, OfAnOrthographicViewHaveOneLevel) {
  Camera camera = testing::FloorCamera(20, 16);
  camera.orthographic = true;
  camera.screen_from_camera(0, 0) = camera.screen_from_camera(1, 1) = 4.0;
  const testing::PlaneReadback floor = testing::FloorReadback(camera);
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  Random random(3);
  ClipmapOptions options;
  options.page_side = 8;
  const auto map = ClipmapPages(*surfaces, RandomSun(random), 40 * 8 * 8, options);
  ASSERT_THAT(map, IsOk());
  for (const MapPage& page : map->pages) EXPECT_EQ(page.level, map->pages.front().level);
  EXPECT_GT(map->pages.size(), 10u);
}

TEST(ClipmapPages, SayWhatIsWrong) {
  const testing::PlaneReadback floor = testing::FloorReadback();
  const auto surfaces = FindSurfaces(floor.View(), 1, {});
  ASSERT_THAT(surfaces, IsOk());
  const Light sun = Light::Directional("sun", {0.3, 0.2, -1.0});
  EXPECT_THAT(ClipmapPages(*surfaces, Light::Point("lamp", {0.0, 0.0, 3.0}), 1 << 20),
              StatusIs(absl::StatusCode::kFailedPrecondition,
                       ::testing::AllOf(HasSubstr("lamp"), HasSubstr("MakeParaboloidPair"))));
  EXPECT_THAT(ClipmapPages(*surfaces, sun, 4 * 128 * 128 - 1),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("want at least 65536")));
  EXPECT_THAT(ClipmapPages(*surfaces, sun, 4 * 128 * 128), IsOk());
  EXPECT_THAT(ClipmapPages(*surfaces, sun, 1 << 20, {.page_side = 7}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("page_side = 7")));
  EXPECT_THAT(ClipmapPages(*surfaces, sun, 1 << 20, {.pages_per_side = 5}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("pages_per_side = 5")));
  EXPECT_THAT(ClipmapPages(*surfaces, sun, 1 << 20, {.least_bias = 1}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("least_bias = 1")));
  std::stop_source source;
  source.request_stop();
  const StopScope scope(source.get_token());
  EXPECT_THAT(ClipmapPages(*surfaces, sun, 1 << 20),
              StatusIs(absl::StatusCode::kCancelled, HasSubstr("sun")));
}

}  // namespace
}  // namespace lightfit
