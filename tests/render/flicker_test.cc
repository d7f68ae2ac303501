#include "render/flicker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/render/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::Random;
using testing::StatusIs;

// The sun straight above: what is over a point of the floor shadows it.
const Light kNoon = Light::Directional("noon", {0, 0, -1});

// A floor, and over it a square that hangs in the air.
constexpr double kLow = -1.3, kHigh = 1.7;
bool IsUnderSquare(const Eigen::Vector2d& floor) {
  return floor.minCoeff() > kLow && floor.maxCoeff() < kHigh;
}

Scene HangingSquare() {
  Scene scene;
  testing::AddFloor(6.0, &scene);
  testing::AddQuad({kLow, kLow, 9}, {kHigh, kLow, 9}, {kHigh, kHigh, 9}, {kLow, kHigh, 9}, &scene);
  return scene;
}

Camera Looking(const Eigen::Vector3d& eye, int width = 96, int height = 72) {
  return *LookAtCamera(eye, {0, 0, 0}, Eigen::Vector3d::UnitZ(), 0.7, width, height);
}

struct Stage {
  RayCaster caster = testing::Caster(HangingSquare());
  SurfaceImage image = *RenderSurfaces(caster, Looking({2, -9, 7}));
  std::vector<Lighting> truth = TrueLighting(caster, image, kNoon);
  std::vector<uint8_t> all = std::vector<uint8_t>(image.pixels.size(), 1);

  Flicker Measured(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) const {
    const absl::StatusOr<Flicker> flicker =
        MeasureFlicker(caster, image, all, truth, kNoon, {a, kSize}, {b, kSize});
    EXPECT_THAT(flicker, IsOk());
    return flicker.ok() ? *flicker : Flicker();
  }

  static constexpr MapSize kSize = {120, 120};
};

// Texels of a quarter unit around the origin, a little warped.
Eigen::Matrix4d FloorMap() {
  const Eigen::Matrix<double, 3, 4> ray_from_world = RayFromWorld(kNoon);
  Eigen::Matrix3d map_from_ray;
  map_from_ray << 4.0, 0.7, 60.0,  //
      -0.5, 4.2, 60.0,             //
      0.01, 0.02, 1.0;
  return MapFromWorld(map_from_ray, ray_from_world, kNoon, {1.0, 2.0}, 0.5);
}

Eigen::Matrix4d Shifted(Eigen::Matrix4d map_from_world, const Eigen::Vector2d& texels) {
  map_from_world.topRows<2>() += texels * map_from_world.row(3);
  return map_from_world;
}

TEST(MeasureFlicker, IsNothingForMovesByWholeTexels) {
  const Stage stage;
  for (const Eigen::Vector2d& whole :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(3, -7), Eigen::Vector2d(-11, 2)}) {
    const Flicker flicker = stage.Measured(FloorMap(), Shifted(FloorMap(), whole));
    EXPECT_GT(flicker.judged, 3000);
    EXPECT_EQ(flicker.flips_ideal, 0);
    EXPECT_EQ(flicker.flips_practical, 0);
  }
}

// On the floor a look-up returns whether the texel's centre is under the square.
TEST(MeasureFlicker, CountsLookUpsThatChangeOnAnAnalyticShadow) {
  const Stage stage;
  const auto looked_up = [](const Eigen::Matrix4d& map_from_world,
                            const Eigen::Vector3d& position) {
    Eigen::Matrix3d map_from_floor;  // of (x, y, 1)
    for (int row = 0; row < 3; ++row) {
      const int of = row < 2 ? row : 3;
      map_from_floor.row(row) << map_from_world(of, 0), map_from_world(of, 1),
          map_from_world(of, 3);
    }
    const Eigen::Vector2d texel =
        (map_from_floor * position.head<2>().homogeneous()).hnormalized().array().floor() + 0.5;
    return IsUnderSquare((map_from_floor.inverse() * texel.homogeneous()).hnormalized());
  };
  Random random(451);
  int64_t total = 0;
  for (int i = 0; i < 10; ++i) {
    const Eigen::Matrix4d a = FloorMap();
    const Eigen::Matrix4d b =
        Shifted(FloorMap(), {random.Uniform(-0.7, 0.7), random.Uniform(-0.7, 0.7)});
    int64_t flips = 0, judged = 0;
    for (size_t k = 0; k < stage.truth.size(); ++k) {
      const SurfacePoint& pixel = stage.image.pixels[k];
      if (stage.truth[k] != Lighting::kLit && stage.truth[k] != Lighting::kShadowed) continue;
      ++judged;
      if (pixel.position.z() > 1.0) continue;  // the square itself is lit
      if (looked_up(a, pixel.position) != looked_up(b, pixel.position)) ++flips;
    }
    const Flicker flicker = stage.Measured(a, b);
    EXPECT_EQ(flicker.judged, judged);
    // A texel's centre within rounding of the square's edge.
    EXPECT_NEAR(flicker.flips_ideal, flips, 3) << i;
    EXPECT_NEAR(flicker.flips_practical, flips, 3) << i;
    total += flips;
  }
  EXPECT_GT(total, 500);
}

TEST(CountFlips, LeavesOutWhatIsNotJudgedOrNotSeenTwice) {
  ShadowImage a, b;
  a.ideal = {Lighting::kLit,
             Lighting::kLit,
             Lighting::kBackground,
             Lighting::kFacingAway,
             Lighting::kShadowed};
  b.ideal = {Lighting::kShadowed,
             Lighting::kShadowed,
             Lighting::kBackground,
             Lighting::kFacingAway,
             Lighting::kShadowed};
  a.practical = a.ideal;
  b.practical = b.ideal;
  b.practical[4] = Lighting::kLit;
  const Flicker flicker = CountFlips(a, b, {1, 0, 1, 1, 1});
  EXPECT_EQ(flicker.judged, 2);
  EXPECT_EQ(flicker.flips_ideal, 1);
  EXPECT_EQ(flicker.flips_practical, 2);
}

TEST(MeasureFlicker, NamesWhatCannotBeUsed) {
  const Stage stage;
  const std::vector<uint8_t> few(5, 1);
  const JudgedMap map = {FloorMap(), Stage::kSize};
  EXPECT_THAT(MeasureFlicker(stage.caster, stage.image, few, stage.truth, kNoon, map, map),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("seen_in_both has 5 pixels")));
  Eigen::Matrix4d other = FloorMap();
  other(0, 2) += 1.0;  // its rays are slanted, the light's are not
  EXPECT_THAT(
      MeasureFlicker(
          stage.caster, stage.image, stage.all, stage.truth, kNoon, map, {other, Stage::kSize}),
      StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("light \"noon\"")));
}

// Against every triangle in double precision.
TEST(SeenFrom, IsWhatNoTriangleHides) {
  int num_compared = 0;
  for (uint64_t seed = 461; seed < 465; ++seed) {
    std::printf("seed %d\n", static_cast<int>(seed));
    const BoxScene boxes = MakeBoxScene(seed);
    const RayCaster caster = testing::Caster(testing::SceneOf(boxes));
    const Camera first = RandomCamera(boxes, seed, 60, 40);
    const SurfaceImage image = *RenderSurfaces(caster, first);
    for (const bool orthographic : {false, true}) {
      Camera other = first;
      other.camera_from_world.topRightCorner<3, 1>() -= Eigen::Vector3d(1.5, 0.3, 0.5);
      other.orthographic = orthographic;
      if (orthographic) other.screen_from_camera.diagonal().head<2>().setConstant(6.0);
      const absl::StatusOr<std::vector<uint8_t>> seen = SeenFrom(other, caster, image);
      ASSERT_THAT(seen, IsOk());
      const Eigen::Matrix4d world_from_camera = other.camera_from_world.inverse();
      int64_t num_seen = 0;
      for (size_t i = 0; i < seen->size(); i += 7) {
        const SurfacePoint& pixel = image.pixels[i];
        if (!pixel.is_surface()) {
          EXPECT_EQ((*seen)[i], 0);
          continue;
        }
        const Eigen::Vector3d in_camera =
            (other.camera_from_world * pixel.position.homogeneous()).head<3>();
        const Eigen::Vector3d eye =
            (world_from_camera * (orthographic
                                      ? Eigen::Vector4d(in_camera.x(), in_camera.y(), 0.0, 1.0)
                                      : Eigen::Vector4d::UnitW()))
                .head<3>();
        const Eigen::Vector3d sight = pixel.position - eye;
        const Eigen::Vector3d screen =
            other.screen_from_camera *
            Eigen::Vector3d(in_camera.x(), in_camera.y(), orthographic ? 1.0 : in_camera.z());
        const Eigen::Vector2d at = screen.hnormalized();
        const bool inside = in_camera.z() > 0.0 && at.minCoeff() >= 0.0 && at.x() < other.width &&
                            at.y() < other.height;
        const testing::BruteHits hits = testing::AllHits(caster.scene(), {eye, sight.normalized()});
        // Rounding decides near edges, and on surfaces that the other camera sees edge-on.
        if (hits.near_an_edge || std::abs(pixel.normal.dot(sight.normalized())) < 0.01) continue;
        bool hidden = pixel.normal.dot(sight) > 0.0;
        for (const double distance : hits.distances) {
          hidden = hidden || distance < sight.norm() - 1e-3;
        }
        // An orthographic camera is taken to stand far behind its plane.
        if (orthographic && !hidden && (*seen)[i] == 0) continue;
        EXPECT_EQ((*seen)[i], inside && !hidden ? 1 : 0) << "pixel " << i;
        num_seen += (*seen)[i];
        ++num_compared;
      }
      EXPECT_GT(num_seen, 10) << orthographic;
    }
  }
  EXPECT_GT(num_compared, 1000);
}

TEST(SeenFrom, RefusesACameraThatCannotBeUsed) {
  const Stage stage;
  EXPECT_THAT(SeenFrom(Camera(), stage.caster, stage.image).status(),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("camera: size")));
}

}  // namespace
}  // namespace lightfit
