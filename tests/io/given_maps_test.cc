// Matrices and plans of others: every form that is read, and what is said of those that cannot be.

#include "io/given_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "geometry/clip.h"
#include "tests/io/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::MatrixNear;
using testing::StatusIs;

constexpr double kTolerance = 1e-12;  // products of a few roundings, entries up to 1000

Eigen::Matrix4d Some() {
  Eigen::Matrix4d matrix;
  matrix << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 13, 14, 15, 17;
  return matrix;
}

constexpr char kFlat[] = "[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 13, 14, 15, 17]";
constexpr char kRows[] = "[[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 13], [13, 14, 15, 17]]";

Eigen::Matrix4d Parsed(const std::string& json, MapSize map) {
  const absl::StatusOr<GivenSetUp> given = ParseGivenMaps("engine", json, map);
  EXPECT_THAT(given, IsOk());
  if (!given.ok()) return Eigen::Matrix4d::Zero();
  EXPECT_TRUE(given->by_light.empty());
  if (!given->for_every_light.has_value()) return Eigen::Matrix4d::Zero();
  const Plan& plan = given->for_every_light->plan;
  EXPECT_EQ(plan.maps.size(), 1u);
  EXPECT_EQ(plan.border, Border::kLit);
  EXPECT_EQ(plan.maps[0].size.width, map.width);
  EXPECT_EQ(plan.maps[0].size.height, map.height);
  EXPECT_EQ(given->for_every_light->guard_texels, 0.0);
  return plan.maps[0].map_from_world;
}

TEST(GivenMaps, ReadsEveryFormOfSixteenNumbers) {
  const std::string flat = kFlat, rows = kRows;
  for (const std::string& json : {"{\"map_from_world\": " + flat + "}",
                                  "{\"mapFromWorld\": " + flat + "}",
                                  "{\"map_from_world\": " + rows + "}",
                                  "{\"mapFromWorld\": {\"m\": " + flat + "}}"}) {
    SCOPED_TRACE(json);
    EXPECT_THAT(Parsed(json, {400, 300}), MatrixNear(Some(), kTolerance));
  }
}

TEST(GivenMaps, ScalesTexelsOfAnotherMap) {
  const Eigen::Matrix4d matrix =
      Parsed(std::string("{\"map\": {\"width\": 200, \"height\": 1200}, \"map_from_world\": ") +
                 kFlat + "}",
             {400, 300});
  Eigen::Matrix4d wanted = Some();
  wanted.row(0) *= 2;
  wanted.row(1) *= 0.25;
  EXPECT_THAT(matrix, MatrixNear(wanted, kTolerance));
}

TEST(GivenMaps, UndoesTheClipConvention) {
  const MapSize map = {400, 300};
  const std::pair<const char*, ClipConvention> conventions[] = {
      {"", ClipConvention::Vulkan()},
      {", \"clip\": \"vulkan\"", ClipConvention::Vulkan()},
      {", \"clip\": \"direct3d\"", ClipConvention::Direct3D()},
      {", \"clip\": \"opengl\"", ClipConvention::OpenGl()},
      {", \"clip\": \"Metal-reversed\"", ClipConvention::Direct3DReversed()},
      {", \"clip\": {\"yUp\": true}", ClipConvention::Direct3D()}};
  for (const auto& [words, convention] : conventions) {
    SCOPED_TRACE(words);
    const Eigen::Matrix4d map_from_world =
        Parsed(std::string("{\"clip_from_world\": ") + kFlat + words + "}", map);
    const Eigen::Matrix4d clip_from_world = ClipFromMap(map, convention) * map_from_world;
    EXPECT_THAT(clip_from_world, MatrixNear(Some(), kTolerance));
  }
}

// Of a light whose rays are those of the world's z axis: rows 1, 2 and 4 know nothing of z.
const Light kDown = Light::Directional("sun", {0, 0, -1});
constexpr char kOfDown[] = "[1, 2, 0, 4, 5, 6, 0, 8, 9, 10, 11, 13, 13, 14, 0, 17]";

std::string JsonMap(int index, const std::string& numbers) {
  return absl::StrCat("{\"index\": ",
                      index,
                      ", \"map\": {\"width\": 200, \"height\": 300}, \"mapFromWorld\": {\"m\": ",
                      numbers,
                      "}}");
}

std::string ResultWithPlan(const std::string& maps, const std::string& more) {
  return absl::StrCat(
      "{\"lights\": [{\"name\": \"sun\", \"plan\": {\"maps\": [", maps, "]", more, "}}]}");
}

TEST(GivenMaps, AResultHasOneForEachLight) {
  const std::string json =
      std::string(
          "{\"lights\": [{\"name\": \"sun\", \"map\": {\"width\": 200, \"height\": 300}, "
          "\"mapFromWorld\": {\"m\": ") +
      kOfDown + "}}, {\"name\": \"noon\", \"status\": {\"code\": 9, \"message\": \"none\"}}]}";
  const absl::StatusOr<GivenSetUp> given = ParseGivenMaps("engine", json, {400, 300});
  ASSERT_THAT(given, IsOk());
  EXPECT_EQ(given->by_light.size(), 1u);
  const absl::StatusOr<GivenMaps> sun = given->Of(kDown);
  ASSERT_THAT(sun, IsOk());
  EXPECT_EQ(sun->plan.light_name, "sun");
  ASSERT_EQ(sun->plan.maps.size(), 1u);
  EXPECT_EQ(sun->plan.maps[0].map_from_world(0, 3), 8);
  EXPECT_EQ(sun->plan.maps[0].size.width, 400);
  Light noon = kDown;
  noon.name = "noon";
  EXPECT_THAT(given->Of(noon), StatusIs(absl::StatusCode::kNotFound, HasSubstr("has \"sun\"")));
}

TEST(GivenMaps, APlanKeepsItsSizesBorderAndGuard) {
  const std::string other = "[1, 2, 0, 4, 5, 7, 0, 8, 0, 0, 0, 0, 0, 0, 0, 1]";
  const absl::StatusOr<GivenSetUp> given =
      ParseGivenMaps("engine",
                     ResultWithPlan(JsonMap(0, kOfDown) + ", " + JsonMap(1, other),
                                    ", \"border\": \"BORDER_DARK\", \"guardTexels\": 1.5"),
                     {400, 300});
  ASSERT_THAT(given, IsOk());
  const absl::StatusOr<GivenMaps> sun = given->Of(kDown);
  ASSERT_THAT(sun, IsOk());
  EXPECT_EQ(sun->plan.light_name, "sun");
  EXPECT_EQ(sun->plan.border, Border::kDark);
  EXPECT_EQ(sun->guard_texels, 1.5);
  ASSERT_EQ(sun->plan.maps.size(), 2u);
  EXPECT_EQ(sun->plan.maps[0].map_from_world(0, 3), 4);
  EXPECT_EQ(sun->plan.maps[1].map_from_world(1, 1), 7);
  for (const PlanMap& map : sun->plan.maps) {
    EXPECT_EQ(map.size.width, 200);
    EXPECT_EQ(map.size.height, 300);
    EXPECT_TRUE(map.half_spaces.empty());
  }
}

// Its matrix is the light's as well, and the plan is what was fitted.
TEST(GivenMaps, APlanOfOneMapKeepsItsSizeToo) {
  const std::string map = JsonMap(0, kOfDown);
  const std::string json = absl::StrCat("{\"lights\": [{\"name\": \"sun\", \"plan\": {\"maps\": [",
                                        map,
                                        "]}, \"map\": {\"width\": 200, \"height\": 300}, ",
                                        "\"mapFromWorld\": {\"m\": ",
                                        kOfDown,
                                        "}}]}");
  const absl::StatusOr<GivenSetUp> given = ParseGivenMaps("engine", json, {400, 300});
  ASSERT_THAT(given, IsOk());
  const absl::StatusOr<GivenMaps> sun = given->Of(kDown);
  ASSERT_THAT(sun, IsOk());
  ASSERT_EQ(sun->plan.maps.size(), 1u);
  EXPECT_EQ(sun->plan.maps[0].size.width, 200);
  EXPECT_EQ(sun->plan.maps[0].map_from_world(0, 3), 4);
}

// Plans of a light without an answer are not looked at.
TEST(GivenMaps, AFailedLightHasNoMaps) {
  const std::string json =
      absl::StrCat("{\"lights\": [{\"name\": \"noon\", \"status\": {\"code\": 9}, \"plan\": {}}, ",
                   "{\"name\": \"sun\", \"plan\": {\"maps\": [",
                   JsonMap(0, kOfDown),
                   "]}}]}");
  const absl::StatusOr<GivenSetUp> given = ParseGivenMaps("engine", json, {400, 300});
  ASSERT_THAT(given, IsOk());
  EXPECT_EQ(given->by_light.size(), 1u);
}

TEST(GivenMaps, SaysWhatIsWrongWithAPlan) {
  const std::string map = JsonMap(0, kOfDown);
  std::string too_many = map;
  for (int k = 1; k <= kMaxPlanMaps; ++k) absl::StrAppend(&too_many, ", ", JsonMap(k, kOfDown));
  const std::pair<std::string, const char*> files[] = {
      {ResultWithPlan("", ""), "light \"sun\": plan.maps: 0 of them, want 1 ... 32"},
      {ResultWithPlan(too_many, ""), "light \"sun\": plan.maps: 33 of them, want 1 ... 32"},
      {ResultWithPlan(map + ", " + map, ""), "light \"sun\": plan.maps[1].index = 0, want 1"},
      {ResultWithPlan(JsonMap(0, "[1, 2]"), ""),
       "light \"sun\": plan.maps[0].map_from_world: m has 2 numbers, want 16"},
      {ResultWithPlan(map, ", \"border\": 7"), "light \"sun\": plan.border = 7"},
      {ResultWithPlan(map, ", \"guardTexels\": -1"),
       "light \"sun\": plan.guard_texels = -1, want 0 or more"},
      {ResultWithPlan(map, ", \"guardTexels\": \"NaN\""), "plan.guard_texels = nan"},
      {ResultWithPlan(map, ", \"guardTexels\": 100"),
       "light \"sun\": plan.guard_texels = 100 leaves nothing of maps[0] of 200x300 texels, want "
       "less than 100"}};
  for (const auto& [json, words] : files) {
    SCOPED_TRACE(json);
    EXPECT_THAT(ParseGivenMaps("engine", json, {400, 300}),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  }
}

// What only the light that it is used for tells.
TEST(GivenMaps, SaysWhichMapIsNotOneOfTheLight) {
  const std::string singular = "[1, 2, 0, 4, 2, 4, 0, 8, 0, 0, 0, 0, 0, 0, 0, 1]";
  const testing::TemporaryFolder folder;
  const std::string path = folder.Write(
      "plan.json", ResultWithPlan(JsonMap(0, kOfDown) + ", " + JsonMap(1, singular), ""));
  const absl::StatusOr<GivenSetUp> given = ReadGivenMaps("engine", path, {400, 300});
  ASSERT_THAT(given, IsOk());
  EXPECT_THAT(given->Of(kDown),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       AllOf(HasSubstr("plan.json: plan.maps[1]: light \"sun\": map_from_world is "
                                       "singular"),
                             HasSubstr("want the plan as it was fitted"))));
  EXPECT_THAT(
      given->Of(Light::Directional("sun", {1, 0, -1})),
      StatusIs(absl::StatusCode::kInvalidArgument,
               HasSubstr("plan.maps[0]: light \"sun\": the rays of map_from_world do not")));
}

TEST(GivenMaps, ABorderIsLitUnlessTheFileSaysDark) {
  const MapSize map = {400, 300};
  const auto border_of = [&map](const std::string& json) {
    SCOPED_TRACE(json);
    const absl::StatusOr<GivenSetUp> given = ParseGivenMaps("engine", json, map);
    EXPECT_THAT(given, IsOk());
    if (!given.ok()) return Border::kLit;
    return given->for_every_light.has_value() ? given->for_every_light->plan.border
                                              : given->by_light.at("sun").plan.border;
  };
  const std::string one = std::string("{\"clip_from_world\": ") + kFlat;
  EXPECT_EQ(border_of(one + ", \"border\": \"dark\"}"), Border::kDark);
  EXPECT_EQ(border_of(one + ", \"border\": \"BORDER_DARK\"}"), Border::kDark);
  EXPECT_EQ(border_of(one + ", \"border\": \"lit\"}"), Border::kLit);

  // Of a result, each light has its own.
  const std::string result =
      std::string(
          "{\"lights\": [{\"name\": \"sun\", \"map\": {\"width\": 9, \"height\": 9}, "
          "\"mapFromWorld\": {\"m\": ") +
      kFlat + "}";
  EXPECT_EQ(border_of(result + "}]}"), Border::kLit);
  EXPECT_EQ(border_of(result + ", \"border\": \"BORDER_LIT\"}]}"), Border::kLit);
  EXPECT_EQ(border_of(result + ", \"border\": \"BORDER_DARK\"}]}"), Border::kDark);
  EXPECT_THAT(ParseGivenMaps("engine", result + ", \"border\": 7}]}", map),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("\"sun\": border = 7")));
}

TEST(GivenMaps, SaysWhatIsWrong) {
  const std::pair<std::string, const char*> files[] = {
      {"", "JSON"},
      {"[1, 2]", "JSON"},
      {"{}", "holds no matrix"},
      {"{\"map_from_world\": [1, 2, 3]}", "has 3 numbers, want 16"},
      {"{\"map_from_world\": \"identity\"}", "want 16 numbers"},
      {"{\"map_from_world\": {\"n\": []}}", "want 16 numbers"},
      {std::string("{\"map_from_world\": ") + kFlat + ", \"map\": {\"width\": 0}}", "map = 0x0"},
      {std::string("{\"map_from_world\": ") + kFlat + ", \"map\": 3}", "map = 0x0"},
      {std::string("{\"clip_from_world\": ") + kFlat + ", \"clip\": \"glide\"}", "\"glide\""},
      {std::string("{\"clip_from_world\": ") + kFlat + ", \"clip\": 7}", "clip: want"},
      {std::string("{\"map_from_world\": ") + kFlat + ", \"border\": \"grey\"}",
       "border = \"grey\", want \"lit\" or \"dark\""},
      {std::string("{\"map_from_world\": ") + kFlat + ", \"border\": 2}", "border = "},
      {"{\"lights\": [{\"name\": \"sun\", \"direction\": [0, 0, -1]}]}", "none of them"},
      {"{\"clip_from_world\": [1e308, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}",
       "too large for a double once it is in texels of a map of 400x300"},
      {"{\"lights\": [{\"name\": \"sun\", \"map\": {\"width\": 1, \"height\": 1}, "
       "\"mapFromWorld\": "
       "{\"m\": [1e308, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}}]}",
       "light \"sun\": the matrix has numbers that are too large"},
      {"{\"lights\": 3}", "JSON"}};
  for (const auto& [json, words] : files) {
    SCOPED_TRACE(json);
    EXPECT_THAT(ParseGivenMaps("engine", json, {400, 300}),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  }
  EXPECT_THAT(ReadGivenMaps("engine", "/no/file.json", {400, 300}).status().ToString(),
              HasSubstr("/no/file.json"));
}

}  // namespace
}  // namespace lightfit
