#include "wire/result_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "optimizer/light_matrix.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

using testing::HasAll;

LightMatrix SomeMatrix() {
  LightMatrix matrix;
  matrix.light_name = "sun";
  matrix.map = {1024, 512};
  matrix.border = Border::kDark;
  matrix.facing = FacingSource::kGiven;
  matrix.map_from_world << 100.0, 1.0, 2.0, 3.0,  //
      4.0, 50.0, 6.0, 7.0,                        //
      0.01, 0.02, 0.03, 0.5,                      //
      0.001, 0.002, 0.003, 1.0;
  matrix.figures.energy = 12.5;
  matrix.search.energy_start = 25.0;
  matrix.figures.footprint = {0.1, 0.2, 0.3, 0.4};
  matrix.figures.samples = {1, 2, 3, 4, 5, 6, 7, 8};
  matrix.search.stop_reason = StopReason::kAxisAtLimit;
  matrix.search.evaluations = 99;
  matrix.search.trace = {{"start", 1, 25.0}, {"refine", 99, 12.5}};
  return matrix;
}

FitReport SomeReport() {
  FitReport report;
  report.source = "yard.exr";
  report.camera = testing::StandardCamera(180, 90);
  report.map = {1024, 512};
  report.clip = ClipConvention::OpenGl();
  LightFit sun;
  sun.light = Light::Directional("sun", Eigen::Vector3d(0.0, 0.0, -1.0));
  sun.matrix = SomeMatrix();
  sun.wrong_share = 0.25;
  sun.focused.emplace();
  sun.focused->energy = 50.0;
  sun.focused->wrong_share = 0.5;
  LightFit key;
  key.light = Light::Point("key", Eigen::Vector3d(1.0, 2.0, 3.0));
  key.matrix = absl::FailedPreconditionError("light \"key\": receivers surround it");
  report.lights = {sun, key};
  return report;
}

TEST(FitResult, HoldsEveryFigureOfAMatrix) {
  const v1::FitResult result = FitResultToProto(SomeReport());
  ASSERT_EQ(result.lights_size(), 2);
  const v1::LightResult& sun = result.lights(0);
  EXPECT_EQ(sun.name(), "sun");
  EXPECT_EQ(sun.status().code(), 0);
  EXPECT_EQ(sun.map().width(), 1024);
  EXPECT_EQ(sun.map().height(), 512);
  EXPECT_EQ(sun.border(), v1::BORDER_DARK);
  EXPECT_EQ(sun.facing(), v1::FACING_SOURCE_GIVEN);
  EXPECT_EQ(sun.map_from_world().m(1), 1.0);  // row-major
  EXPECT_EQ(sun.map_from_world().m(4), 4.0);
  EXPECT_EQ(sun.energies().final(), 12.5);
  EXPECT_EQ(sun.foretold_wrong().final(), 0.25);
  EXPECT_EQ(sun.foretold_wrong().focused(), 0.5);
  EXPECT_FALSE(sun.foretold_wrong().has_as_published());
  EXPECT_EQ(sun.energies().final_over_start(), 0.5);
  EXPECT_EQ(sun.energies().final_over_focused(), 0.25);
  EXPECT_FALSE(sun.energies().has_as_published());
  EXPECT_FALSE(sun.energies().has_final_over_as_published());
  EXPECT_EQ(sun.footprint().rms(), 0.1);
  EXPECT_EQ(sun.footprint().worst(), 0.4);
  EXPECT_EQ(sun.samples().receivers(), 1);
  EXPECT_EQ(sun.samples().used(), 8);
  EXPECT_EQ(sun.stop_reason(), v1::STOP_REASON_AXIS_AT_LIMIT);
  EXPECT_EQ(sun.evaluations(), 99);
  ASSERT_EQ(sun.trace_size(), 2);
  EXPECT_EQ(sun.trace(1).station(), "refine");
  EXPECT_FALSE(sun.has_time_ms());
  EXPECT_EQ(result.readback().source(), "yard.exr");
  EXPECT_EQ(result.readback().camera().width(), 180);
  EXPECT_EQ(result.readback().camera().depth_kind(), v1::DEPTH_KIND_CAMERA_Z);
  EXPECT_EQ(result.options().search(), v1::SEARCH_GLOBAL);
}

// The matrices must say the same: texel (u, v) of the map is where clip space puts the point.
TEST(FitResult, ClipFromWorldAgreesWithMapFromWorld) {
  const v1::LightResult sun = FitResultToProto(SomeReport()).lights(0);
  const auto map_from_world = MatrixFromProto(sun.map_from_world(), "map_from_world");
  const auto clip_from_world = MatrixFromProto(sun.clip_from_world(), "clip_from_world");
  ASSERT_TRUE(map_from_world.ok() && clip_from_world.ok());
  EXPECT_EQ(sun.clip().name(), "opengl");
  std::mt19937 random(testing::kSeed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector4d world(unit(random), unit(random), unit(random), 1.0);
    const Eigen::Vector4d map = *map_from_world * world;
    const Eigen::Vector4d clip = *clip_from_world * world;
    EXPECT_NEAR(map.x() / map.w(), (clip.x() / clip.w() + 1.0) * 0.5 * 1024, 1e-9);
    EXPECT_NEAR(map.y() / map.w(), (clip.y() / clip.w() + 1.0) * 0.5 * 512, 1e-9);
    EXPECT_NEAR(map.z() / map.w(), (clip.z() / clip.w() + 1.0) * 0.5, 1e-12);
  }
}

TEST(FitResult, AFailedLightKeepsItsStatusAndHasNoMatrix) {
  const v1::LightResult key = FitResultToProto(SomeReport()).lights(1);
  EXPECT_EQ(key.status().code(), static_cast<int>(absl::StatusCode::kFailedPrecondition));
  EXPECT_TRUE(HasAll(key.status().message(), {"receivers surround"}));
  EXPECT_FALSE(key.has_map_from_world());
  EXPECT_FALSE(key.has_energies());
  EXPECT_EQ(key.map().width(), 1024);
}

TEST(FitResult, RatiosToZeroAreLeftOut) {
  FitReport report = SomeReport();
  report.lights[0].matrix->search.energy_start = 0.0;
  report.lights[0].as_published.emplace();
  const v1::Energies energies = FitResultToProto(report).lights(0).energies();
  EXPECT_FALSE(energies.has_final_over_start());
  EXPECT_TRUE(energies.has_as_published());
  EXPECT_FALSE(energies.has_final_over_as_published());
}

TEST(FitResultJson, SameResultSameBytesAndReadsBack) {
  const testing::TemporaryFolder folder;
  const v1::FitResult result = FitResultToProto(SomeReport());
  ASSERT_TRUE(WriteFitResultJson(folder.File("a.json"), result).ok());
  ASSERT_TRUE(WriteFitResultJson(folder.File("b.json"), FitResultToProto(SomeReport())).ok());
  const std::string bytes = testing::Bytes(folder.File("a.json"));
  EXPECT_GT(bytes.size(), 500);
  EXPECT_EQ(bytes, testing::Bytes(folder.File("b.json")));
  const auto copy = ReadFitResultJson(folder.File("a.json"));
  ASSERT_TRUE(copy.ok()) << copy.status();
  EXPECT_EQ(copy->SerializeAsString(), result.SerializeAsString());
}

TEST(FitResultJson, TimesAreWrittenOnlyWhenThere) {
  FitReport report = SomeReport();
  const auto without = FitResultToJson(FitResultToProto(report));
  ASSERT_TRUE(without.ok()) << without.status();
  EXPECT_EQ(without->find("timeMs"), std::string::npos);
  report.lights[0].time_ms = 1.25;
  const auto with = FitResultToJson(FitResultToProto(report));
  ASSERT_TRUE(with.ok()) << with.status();
  EXPECT_TRUE(HasAll(*with, {"\"timeMs\": 1.25"}));
}

TEST(FitResultJson, RefusesNumbersThatAreNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    FitReport report = SomeReport();
    report.lights[0].matrix->map_from_world(1, 2) = bad;
    const auto json = FitResultToJson(FitResultToProto(report));
    EXPECT_TRUE(HasAll(json.status().message(), {"result.lights[0].map_from_world.m[6]"}));
    report = SomeReport();
    report.lights[0].matrix->search.trace[1].energy = bad;
    EXPECT_FALSE(FitResultToJson(FitResultToProto(report)).ok());
  }
}

TEST(FitResultJson, BrokenFilesAreErrors) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(ReadFitResultJson(folder.File("none")).status().code(), absl::StatusCode::kNotFound);
  const std::string path = folder.Write("bad.json", R"({"lights":[{"map":{"width":"wide"}}]})");
  EXPECT_TRUE(HasAll(ReadFitResultJson(path).status().message(), {path, "width", "wide"}));
}

}  // namespace
}  // namespace lightfit
