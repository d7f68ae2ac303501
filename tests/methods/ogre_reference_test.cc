// The set-ups against the matrices that another engine computes for them: OGRE 1.12.10, in single
// precision, its OpenGL clip matrices as it prints them. Rows 1, 2 and 4 are compared, up to half a
// turn of the map and a common scale; the depth row is a free choice.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "geometry/clip.h"
#include "methods/focused.h"
#include "methods/lispsm.h"
#include "methods/plane_optimal.h"
#include "methods/view_body.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::IsOk;

// Rows 1, 2 and 4 of clip_from_world, row by row.
using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

struct ReferenceCase {
  std::string name;
  Eigen::Vector3d eye, direction;
  double fov_deg, aspect, near, far;
  Eigen::Vector3d light;
  Eigen::AlignedBox3d receivers;
  Rows focused, lispsm_full, lispsm_simple, plane_optimal;
};

Rows RowsOf(const std::vector<double>& values) { return Eigen::Map<const Rows>(values.data()); }

std::vector<ReferenceCase> ReferenceCases() {
  const Eigen::AlignedBox3d floor(Eigen::Vector3d(-20, -0.01, -20), Eigen::Vector3d(20, 0, 20));
  const Eigen::AlignedBox3d wide_floor(Eigen::Vector3d(-100, -0.01, -100),
                                       Eigen::Vector3d(100, 0, 100));
  // clang-format off
  return {
      {"SunFromTheSide", {0, 2, 15}, {0, -0.15, -1}, 60, 1.777778, 0.5, 60, {-0.6, -1, -0.2}, floor,
       RowsOf({-0.0482469127, 0.0298434533, -0.00447653793, -0.0544689745,
               -0.0087483786, -0.00583223533, 0.0554063655, 0.283095062,
               0, 0, 0, 1}),
       RowsOf({-1.08410811, 0.639853001, 0.0530593395, -2.86446285,
               -0.195789307, -0.130525827, 1.23999834, -11.3963308,
               0.155126423, 0.1034173, -0.982466638, 17.3602257}),
       RowsOf({-0.364568621, 0.236183688, -0.0872126296, 0.64643687,
               -0.160355508, -0.106903359, 1.01558435, -12.5429592,
               0.155126423, 0.1034173, -0.982466638, 13.3098946}),
       RowsOf({0.0643907264, -0.0386344381, 1.87428668e-08, -1.73225999e-07,
               -3.57977115e-09, 0.0033961744, -0.016980879, 0.0283014439,
               -1.3737008e-08, 0.0130718928, -0.0653594881, 1})},
      {"LowSunFromTheFront", {0, 2, 15}, {0, -0.15, -1}, 60, 1.777778, 0.5, 60, {0.1, -0.5, 1},
       floor,
       RowsOf({-0.0495521836, -0.00762341637, 0.00114350999, 0.0139139425,
               -0.0142262653, 0.100198999, 0.0515221208, 0.315969706,
               0, 0, 0, 1}),
       RowsOf({-0.541742384, 0.0951019078, 0.101725191, -2.05746722,
               -0.165299743, 1.16424561, 0.59865272, -5.13426018,
               0.125271067, -0.882314026, -0.453684092, 8.83702183}),
       RowsOf({-0.334713548, 0.198630959, 0.132786825, -2.01580644,
               -0.133774444, 0.94220531, 0.484480083, -5.83444548,
               0.125271067, -0.882314026, -0.453684092, 6.62103033}),
       RowsOf({0.0643907189, 0.0128780939, -2.52621248e-08, 2.96160579e-07,
               6.0244929e-09, -0.0339617468, -0.0169808734, 0.0283014197,
               2.3166649e-08, -0.130718932, -0.0653594658, 1})},
      {"SunAlmostAlongTheView", {0, 12, 15}, {0, -0.8, -1}, 45, 1, 1, 80, {0.02, -0.85, -1}, floor,
       RowsOf({-0.0693048313, -0.0277211312, 0.0221768692, 0.443309128,
               0.0357578211, -0.0528720729, 0.0456564277, 0.4289608,
               0, 0, 0, 1}),
       RowsOf({-2.93763518, -0.821891665, 0.639855325, 13.4183083,
               1.50780296, -2.22946072, 1.92519808, 5.3453784,
               -0.455649137, 0.673729956, -0.581783593, 36.7009773}),
       RowsOf({-2.31797385, -0.595394075, 0.459725589, 9.52989006,
               1.19840562, -1.77198136, 1.53015256, 1.63376546,
               -0.455649137, 0.673729956, -0.581783593, 28.0484085}),
       RowsOf({0.125678927, 0.00295715779, -5.47152013e-09, 7.82310963e-08,
               1.25728548e-08, 0.0923658609, -0.0785109997, 2.83122063e-07,
               1.25728548e-08, 0.0478239991, -0.0406504087, 1})},
      {"SunOverhead", {0, 2, 0}, {0, 0, -1}, 60, 1, 1, 100, {0, -1, 0}, wide_floor,
       RowsOf({-0.0173205063, 0, 0, 0,
               0, 2.46973975e-09, 0.0207176805, 1.07176816,
               0, 0, 0, 1}),
       RowsOf({-0.5, -3.44127642e-08, -0.288675219, -1.00000107,
               0, 1.21679022e-07, 1.02071774, 4.53587341,
               0, -1.1920929e-07, -1.00000012, -2.46410513}),
       RowsOf({-0.550000072, -3.44127571e-08, -0.288675159, -1.00000107,
               0, 1.21926007e-07, 1.0227896, 4.64305019,
               0, -1.1920929e-07, -1.00000012, -2.36410499}),
       RowsOf({6406441, -4.65661287e-10, 0.0048828125, -8.02800059e-07,
               1.86264515e-09, 1.05125103e-07, 0.881853104, -12812881,
               0.0029296875, -0.440926582, -3698760.75, 1})}};
  // clang-format on
}

MethodInput InputOf(const ReferenceCase& reference) {
  MethodInput input;
  input.light = Light::Directional("sun", reference.light);
  const int height = 720, width = static_cast<int>(std::lround(height * reference.aspect));
  input.camera = *LookAtCamera(reference.eye,
                               reference.eye + reference.direction,
                               Eigen::Vector3d::UnitY(),
                               reference.fov_deg * M_PI / 180.0,
                               width,
                               height);
  input.camera.near = reference.near;
  input.camera.far = reference.far;
  input.receivers = reference.receivers;
  input.map = {512, 512};
  return input;
}

// Relative difference of the rows, with the better half turn and the best scale.
double RowsMiss(const MethodInput& input, const Eigen::Matrix4d& map_from_world, const Rows& rows) {
  ClipConvention clip = ClipConvention::OpenGl();
  clip.y_up = true;  // the engine's clip space has y up
  const Eigen::Matrix4d clip_from_world = ClipFromMap(input.map, clip) * map_from_world;
  double least = std::numeric_limits<double>::infinity();
  for (const double turn : {1.0, -1.0}) {
    Rows ours;
    ours << turn * clip_from_world.topRows<2>(), clip_from_world.row(3);
    least = std::min(least, testing::HomogeneousError(ours, rows));
  }
  return least;
}

// Largest difference of a receiver's place in the map, in halves of the map.
double PlaceMiss(const MethodInput& input,
                 const Eigen::Matrix4d& map_from_world,
                 const Rows& rows) {
  const Eigen::Matrix4d clip_from_map = ClipFromMap(input.map, {.y_up = true});
  double least = std::numeric_limits<double>::infinity();
  for (const double turn : {1.0, -1.0}) {
    double largest = 0.0;
    for (const Eigen::Vector3d& point : ViewBody(input.camera, input.receivers)) {
      const Eigen::Vector4d ours = clip_from_map * map_from_world * point.homogeneous();
      const Eigen::Vector3d expected = rows * point.homogeneous();
      largest = std::max(
          largest, (turn * ours.head<2>() / ours.w() - expected.head<2>() / expected.z()).norm());
    }
    least = std::min(least, largest);
  }
  return least;
}

// The engine computes in single precision, and its receivers' coordinates of 20 and 100 cancel.
constexpr double kSinglePrecision = 5e-5;

void ExpectSame(const MethodInput& input,
                const absl::StatusOr<MethodMap>& map,
                const Rows& rows,
                const std::string& name) {
  ASSERT_THAT(map, IsOk());
  EXPECT_EQ(map->note, "") << name;
  EXPECT_LE(RowsMiss(input, map->map_from_world, rows), kSinglePrecision) << name;
  EXPECT_LE(PlaceMiss(input, map->map_from_world, rows), kSinglePrecision) << name;
}

// The engine's factor on n: it grows from 1 to 21 as the light comes within acos(0.9) of the view.
double AlignmentFactor(const ReferenceCase& reference) {
  const double cosine =
      std::abs(reference.direction.normalized().dot(reference.light.normalized()));
  return cosine < 0.9 ? 1.0 : 1.0 + 20.0 * (cosine - 0.9) / 0.1;
}

void ExpectSameLispsm(const ReferenceCase& reference, double n, const Rows& rows) {
  const MethodInput input = InputOf(reference);
  LispsmOptions options;
  options.n = n;
  // All four corners of the near plane are equally near; the engine takes the lower left one.
  options.centre = FrustumCorners(input.camera)[3];
  ExpectSame(input, LispsmMap(input, options), rows, reference.name);
}

TEST(OgreReference, FocusedWithSidesAlongTheView) {
  for (const ReferenceCase& reference : ReferenceCases()) {
    const MethodInput input = InputOf(reference);
    ExpectSame(
        input, FocusedMap(input, {.min_area_rotation = false}), reference.focused, reference.name);
  }
}

// A tenth of near + sqrt(near far), without the sine of the angle between light and view.
TEST(OgreReference, LispsmSimple) {
  for (const ReferenceCase& reference : ReferenceCases()) {
    const double n = 0.1 * AlignmentFactor(reference) *
                     (reference.near + std::sqrt(reference.near * reference.far));
    ExpectSameLispsm(reference, n, reference.lispsm_simple);
  }
}

// near + sqrt(z0 z1), with z0 at the near plane and z1 the body's length further along the light's
// image plane, without the sine.
TEST(OgreReference, LispsmFull) {
  for (const ReferenceCase& reference : ReferenceCases()) {
    const MethodInput input = InputOf(reference);
    const Eigen::Vector3d light = reference.light.normalized();
    const Eigen::Vector3d view = reference.direction.normalized();
    const Eigen::Vector3d across_light = view - view.dot(light) * light;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Eigen::Vector3d& point : ViewBody(input.camera, input.receivers)) {
      low = std::min(low, across_light.normalized().dot(point));
      high = std::max(high, across_light.normalized().dot(point));
    }
    double z0 = reference.near;
    // Straight overhead no ray of light meets the near plane; the engine then takes z0 = 0.
    if (across_light.norm() == 1.0) z0 = 0.0;
    const double z1 = z0 + across_light.norm() * (high - low);
    const double n = reference.near + std::sqrt(z0 * z1) * AlignmentFactor(reference);
    ExpectSameLispsm(reference, n, reference.lispsm_full);
  }
}

// The level camera sees the horizon, where the engine's four points on the plane lie at infinity:
// it sets an entry to 1 that is 0, and its matrix is the right one times a very large number.
TEST(OgreReference, PlaneOptimalOnTheFloor) {
  for (const ReferenceCase& reference : ReferenceCases()) {
    MethodInput input = InputOf(reference);
    input.plane = Eigen::Hyperplane<double, 3>(Eigen::Vector3d::UnitY(), 0.0);
    PlaneOptimalOptions options;
    options.cover = PlaneOptimalOptions::Cover::kScreen;
    absl::StatusOr<MethodMap> map = PlaneOptimalMap(input, options);
    ASSERT_THAT(map, IsOk());
    map->note.clear();  // the floor's lower side, 0.01 deep, may reach out
    ExpectSame(input, map, reference.plane_optimal, reference.name);
  }
}

}  // namespace
}  // namespace lightfit
