// Matrices of others: every form that is read, and what is said of those that cannot be.

#include "io/given_matrices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "geometry/clip.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

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
  const absl::StatusOr<GivenMatrices> given = ParseGivenMatrices("engine", json, map);
  EXPECT_THAT(given, IsOk());
  if (!given.ok()) return Eigen::Matrix4d::Zero();
  const absl::StatusOr<GivenMatrix> matrix = given->Of("any light");
  EXPECT_THAT(matrix, IsOk());
  EXPECT_EQ(matrix->border, Border::kLit);
  return matrix->map_from_world;
}

TEST(GivenMatrices, ReadsEveryFormOfSixteenNumbers) {
  const std::string flat = kFlat, rows = kRows;
  for (const std::string& json : {"{\"map_from_world\": " + flat + "}",
                                  "{\"mapFromWorld\": " + flat + "}",
                                  "{\"map_from_world\": " + rows + "}",
                                  "{\"mapFromWorld\": {\"m\": " + flat + "}}"}) {
    SCOPED_TRACE(json);
    EXPECT_THAT(Parsed(json, {400, 300}), MatrixNear(Some(), kTolerance));
  }
}

TEST(GivenMatrices, ScalesTexelsOfAnotherMap) {
  const Eigen::Matrix4d matrix =
      Parsed(std::string("{\"map\": {\"width\": 200, \"height\": 1200}, \"map_from_world\": ") +
                 kFlat + "}",
             {400, 300});
  Eigen::Matrix4d wanted = Some();
  wanted.row(0) *= 2;
  wanted.row(1) *= 0.25;
  EXPECT_THAT(matrix, MatrixNear(wanted, kTolerance));
}

TEST(GivenMatrices, UndoesTheClipConvention) {
  const MapSize map = {400, 300};
  const std::pair<const char*, ClipConvention> conventions[] = {
      {"", ClipConvention::Vulkan()},
      {", \"clip\": \"vulkan\"", ClipConvention::Vulkan()},
      {", \"clip\": \"direct3d\"", ClipConvention::Direct3D()},
      {", \"clip\": \"opengl\"", ClipConvention::OpenGl()},
      {", \"clip\": {\"yUp\": true}", ClipConvention::Direct3D()}};
  for (const auto& [words, convention] : conventions) {
    SCOPED_TRACE(words);
    const Eigen::Matrix4d map_from_world =
        Parsed(std::string("{\"clip_from_world\": ") + kFlat + words + "}", map);
    const Eigen::Matrix4d clip_from_world = ClipFromMap(map, convention) * map_from_world;
    EXPECT_THAT(clip_from_world, MatrixNear(Some(), kTolerance));
  }
}

TEST(GivenMatrices, AResultHasOneForEachLight) {
  const std::string json =
      std::string(
          "{\"lights\": [{\"name\": \"sun\", \"map\": {\"width\": 200, \"height\": 300}, "
          "\"mapFromWorld\": {\"m\": ") +
      kFlat + "}}, {\"name\": \"noon\", \"status\": {\"code\": 9, \"message\": \"none\"}}]}";
  const absl::StatusOr<GivenMatrices> given = ParseGivenMatrices("engine", json, {400, 300});
  ASSERT_THAT(given, IsOk());
  EXPECT_EQ(given->by_light.size(), 1u);
  const absl::StatusOr<GivenMatrix> sun = given->Of("sun");
  ASSERT_THAT(sun, IsOk());
  EXPECT_EQ(sun->map_from_world(0, 3), 8);
  EXPECT_THAT(given->Of("noon"), StatusIs(absl::StatusCode::kNotFound, HasSubstr("has \"sun\"")));
}

// One of several maps must not pass for the light's matrix.
TEST(GivenMatrices, APlanOfSeveralMapsIsRefused) {
  const std::string map =
      std::string("{\"map\": {\"width\": 200, \"height\": 300}, \"mapFromWorld\": {\"m\": ") +
      kFlat + "}}";
  const auto result = [&](const std::string& maps, const std::string& more) {
    return "{\"lights\": [{\"name\": \"sun\", \"plan\": {\"maps\": [" + maps + "]}" + more + "}]}";
  };
  EXPECT_THAT(
      ParseGivenMatrices("engine", result(map + ", " + map, ""), {400, 300}),
      StatusIs(absl::StatusCode::kInvalidArgument,
               HasSubstr("light \"sun\": has a plan of 2 maps, and plans cannot be given")));
  // A plan of one map is that matrix.
  const absl::StatusOr<GivenMatrices> given =
      ParseGivenMatrices("engine", result(map, ", " + map.substr(1, map.size() - 2)), {400, 300});
  ASSERT_THAT(given, IsOk());
  EXPECT_EQ(given->Of("sun")->map_from_world(0, 3), 8);
}

TEST(GivenMatrices, ABorderIsLitUnlessTheFileSaysDark) {
  const MapSize map = {400, 300};
  const auto border_of = [&map](const std::string& json) {
    SCOPED_TRACE(json);
    const absl::StatusOr<GivenMatrices> given = ParseGivenMatrices("engine", json, map);
    EXPECT_THAT(given, IsOk());
    return given.ok() ? given->Of("sun")->border : Border::kLit;
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
  EXPECT_THAT(ParseGivenMatrices("engine", result + ", \"border\": 7}]}", map),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("\"sun\": border = 7")));
}

TEST(GivenMatrices, SaysWhatIsWrong) {
  const std::pair<std::string, const char*> files[] = {
      {"", "JSON"},
      {"[1, 2]", "JSON"},
      {"{}", "holds no matrix"},
      {"{\"map_from_world\": [1, 2, 3]}", "has 3 numbers, want 16"},
      {"{\"map_from_world\": \"identity\"}", "want 16 numbers"},
      {"{\"map_from_world\": {\"n\": []}}", "want 16 numbers"},
      {std::string("{\"map_from_world\": ") + kFlat + ", \"map\": {\"width\": 0}}", "map = 0x0"},
      {std::string("{\"map_from_world\": ") + kFlat + ", \"map\": 3}", "map = 0x0"},
      {std::string("{\"clip_from_world\": ") + kFlat + ", \"clip\": \"metal\"}", "\"metal\""},
      {std::string("{\"clip_from_world\": ") + kFlat + ", \"clip\": 7}", "clip: want"},
      {std::string("{\"map_from_world\": ") + kFlat + ", \"border\": \"grey\"}",
       "border = \"grey\", want \"lit\" or \"dark\""},
      {std::string("{\"map_from_world\": ") + kFlat + ", \"border\": 2}", "border = "},
      {"{\"lights\": [{\"name\": \"sun\", \"direction\": [0, 0, -1]}]}", "none of them"},
      {"{\"lights\": 3}", "JSON"}};
  for (const auto& [json, words] : files) {
    SCOPED_TRACE(json);
    EXPECT_THAT(ParseGivenMatrices("engine", json, {400, 300}),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
  }
  EXPECT_THAT(ReadGivenMatrices("engine", "/no/file.json", {400, 300}).status().ToString(),
              HasSubstr("/no/file.json"));
}

}  // namespace
}  // namespace lightfit
