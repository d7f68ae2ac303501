#include "io/lights_file.h"

#include <gtest/gtest.h>

#include "tests/io/testing.h"
#include "wire/light_proto.h"
#include "wire/utf8.h"

namespace lightfit {
namespace {

using testing::HasAll;

TEST(ReadLightsFile, ReadsASceneFileAsItIs) {
  const auto lights = ReadLightsFile(testing::RepositoryFile("examples/yard_180/scene.json"));
  ASSERT_TRUE(lights.ok()) << lights.status();
  ASSERT_EQ(lights->size(), 3);
  const Light& sun = (*lights)[0];
  EXPECT_EQ(sun.name, "sun");
  EXPECT_EQ(sun.kind, Light::Kind::kDirectional);
  EXPECT_TRUE(sun.direction.isApprox(
      Eigen::Vector3d(-0.9335726499557495, -0.23732765018939972, -0.26854732632637024)));
  const Light& rim = (*lights)[2];
  EXPECT_EQ(rim.kind, Light::Kind::kPoint);
  EXPECT_EQ(rim.position,
            Eigen::Vector3d(-49.28960418701172, -34.21308135986328, 26.893470764160156));
  for (int i = 0; i < 3; ++i) EXPECT_EQ((*lights)[i].shadow_bit, i);
}

TEST(ReadLightsFile, NamesTheFileInErrors) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(ReadLightsFile(folder.File("none.json")).status().code(), absl::StatusCode::kNotFound);
  EXPECT_FALSE(ReadLightsFile(folder.File("")).ok());
  const std::string path = folder.Write("lights.json", "{\"lights\": [}");
  EXPECT_TRUE(HasAll(ReadLightsFile(path).status().message(), {path, "JSON"}));
}

TEST(ParseLightsJson, ErrorsNameLightFieldAndValue) {
  const struct {
    const char* json;
    std::vector<std::string> parts;
  } cases[] = {
      {R"({"lights":[{"name":"a","position":[1,2,3]},{"name":"b"}]})",
       {"lights[1]", "\"b\"", "neither position nor direction"}},
      {R"({"lights":[{"name":"a","position":[1,2]}]})", {"\"a\"", "position = [1, 2]", "want 3"}},
      {R"({"lights":[{"name":"a","direction":[1,2,3,4]}]})", {"\"a\"", "direction", "4 numbers"}},
      {R"({"lights":[{"name":"a","direction":[0,0,0]}]})", {"\"a\"", "direction", "(0, 0, 0)"}},
      {R"({"lights":[{"name":"a","position":["NaN",0,0]}]})", {"\"a\"", "position", "nan"}},
      {R"({"lights":[{"name":"a","direction":["Infinity",0,0]}]})", {"\"a\"", "direction", "inf"}},
      {R"({"lights":[{"name":"a","position":[1e999,0,0]}]})", {"JSON"}},
      {R"({"lights":[{"name":"a","position":["left",0,0]}]})",
       {"lights[0]", "position[0]", "left"}},
      {R"({"lights":[{"name":"","position":[1,2,3]}]})", {"lights[0]", "name is empty"}},
      {R"({"lights":[{"name":"a","position":[1,2,3]},{"name":"a","position":[1,2,3]}]})",
       {"\"a\"", "taken"}},
      {R"({"lights":[]})", {"lights: none"}},
      {R"({"lamps":[]})", {"lights: none"}},
      {R"([1,2])", {"JSON"}},
      {"", {""}},
      {"\xff\xfe{", {"JSON"}},
  };
  for (const auto& c : cases) {
    const auto lights = ParseLightsJson(c.json);
    ASSERT_EQ(lights.status().code(), absl::StatusCode::kInvalidArgument) << c.json;
    EXPECT_TRUE(HasAll(lights.status().message(), c.parts)) << c.json;
  }
}

// What an exporter writes of a scene, in the words of several programs.
TEST(ParseLightList, KindsAreUnderstoodInTheWordsOfAnyProgram) {
  const std::string both = R"("position":[1,2,3],"direction":[0,0,-1])";
  for (const char* type : {"SPOT",
                           "spot",
                           "SpotLight",
                           "spot_light",
                           "POINT",
                           "pointLight",
                           "omni",
                           "PxrSphereLight",
                           "light_spot"}) {
    const auto lights = ParseLightList("{\"lights\":[{\"name\":\"a\",\"type\":\"" +
                                       std::string(type) + "\"," + both + "}]}");
    ASSERT_TRUE(lights.ok() && (*lights)[0].status.ok()) << type << (*lights)[0].status;
    EXPECT_EQ((*lights)[0].light.kind, Light::Kind::kPoint) << type;
    EXPECT_EQ((*lights)[0].light.position, Eigen::Vector3d(1, 2, 3)) << type;
  }
  for (const char* type : {"SUN",
                           "directionalLight",
                           "distant_light",
                           "PxrDistantLight",
                           "directional",
                           "DistantLight"}) {
    const auto lights = ParseLightList("{\"lights\":[{\"name\":\"a\",\"kind\":\"" +
                                       std::string(type) + "\"," + both + "}]}");
    ASSERT_TRUE(lights.ok() && (*lights)[0].status.ok()) << type << (*lights)[0].status;
    EXPECT_EQ((*lights)[0].light.kind, Light::Kind::kDirectional) << type;
    EXPECT_EQ((*lights)[0].light.direction, Eigen::Vector3d(0, 0, -1)) << type;
  }
  for (const char* type : {"DOME",
                           "skydome_light",
                           "AREA",
                           "RectLight",
                           "quad",
                           "mesh",
                           "Pxr",
                           "light",
                           "PxrDomeLight",
                           "portal",
                           "environment"}) {
    const auto lights = ParseLightList("{\"lights\":[{\"name\":\"a\",\"type\":\"" +
                                       std::string(type) + "\"," + both + "}]}");
    ASSERT_TRUE(lights.ok());
    EXPECT_TRUE(HasAll((*lights)[0].status.message(), {"\"a\"", type, "want a point"})) << type;
  }
}

TEST(ParseLightList, WhatIsWrongWithOneLightIsItsOwn) {
  const auto lights = ParseLightList(R"({"lights":[
      {"name":"sun","direction":[0,0,-1]}, {"name":"spot","position":[1,2,3],"direction":[0,0,-1]},
      {"name":"env","type":"DOME"}, {"name":"sun","position":[1,2,3]}, 7, {"position":[1,2,3]},
      {"name":"bad","position":["left",0,0]}, {"name":"short","position":[1,2]},
      {"name":"no","type":"SUN","position":[1,2,3]}, {"name":"odd","type":3,"position":[1,2,3]},
      {"name":"last","position":[4,5,6],"type":null,"cone":{"angle":[40]}}]})");
  ASSERT_TRUE(lights.ok()) << lights.status();
  ASSERT_EQ(lights->size(), 11);
  const std::vector<std::string> expected[] = {{},
                                               {},
                                               {"\"env\"", "DOME"},
                                               {"\"sun\"", "taken"},
                                               {"lights[4]", "want {"},
                                               {"lights[5]", "name is empty"},
                                               {"\"left\""},
                                               {"\"short\"", "want 3"},
                                               {"\"no\"", "SUN", "no direction"},
                                               {"\"odd\"", "type is not a word"},
                                               {}};
  for (int i = 0; i < 11; ++i) {
    EXPECT_EQ((*lights)[i].status.ok(), expected[i].empty()) << i << (*lights)[i].status;
    EXPECT_TRUE(HasAll((*lights)[i].status.message(), expected[i])) << i;
    EXPECT_EQ((*lights)[i].light.shadow_bit, i);
  }
  EXPECT_EQ((*lights)[10].light.position, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ((*lights)[2].light.name, "env");
}

// Cut within a character, a name is still UTF-8 in the message.
TEST(ParseLightList, LongNamesAreCutBetweenCharacters) {
  std::string name = "x";
  for (int i = 0; i < 200; ++i) name += "\xE2\x82\xAC";
  const auto lights =
      ParseLightList("{\"lights\":[{\"name\":\"" + name + "\",\"position\":[1,2,3]}]}");
  ASSERT_TRUE(lights.ok());
  const std::string message((*lights)[0].status.message());
  EXPECT_TRUE(HasAll(message, {"has 601 bytes"}));
  EXPECT_EQ(Utf8Text(message), message);
}

TEST(ParseLightList, NumbersComeThroughToTheLastBit) {
  const auto lights = ParseLightList(
      R"({"lights":[{"name":"a","position":[0.1,-49.28960418701172,1.7976931348623157e308]}]})");
  ASSERT_TRUE(lights.ok());
  // Beyond what may be summed, but read as it is.
  EXPECT_TRUE(HasAll((*lights)[0].status.message(), {"1.79769e+308"}));
  const auto fine =
      ParseLightList(R"({"lights":[{"name":"a","position":[0.1,-49.28960418701172,1e-320]}]})");
  EXPECT_EQ((*fine)[0].light.position, Eigen::Vector3d(0.1, -49.28960418701172, 1e-320));
}

std::string ManyLights(int count) {
  std::string json = R"({"lights":[)";
  for (int i = 0; i < count; ++i) {
    json += std::string(i == 0 ? "" : ",") + R"({"name":"l)" + std::to_string(i) +
            R"(","position":[1,2,3]})";
  }
  return json + "]}";
}

TEST(ParseLightsJson, TakesUpTo32Lights) {
  const auto lights = ParseLightsJson(ManyLights(32));
  ASSERT_TRUE(lights.ok()) << lights.status();
  EXPECT_EQ(lights->back().shadow_bit, 31);
  EXPECT_TRUE(HasAll(ParseLightsJson(ManyLights(33)).status().message(), {"33", "at most 32"}));
  EXPECT_EQ(ParseLightList(ManyLights(500))->size(), 500);
}

TEST(ParseLightsJson, SurvivesDeepNestingAndCutFiles) {
  EXPECT_FALSE(ParseLightsJson(std::string(1 << 20, '[')).ok());
  EXPECT_FALSE(ParseLightsJson("{\"lights\":" + std::string(100000, '[')).ok());
  std::string nested = "{\"lights\":[{\"name\":\"a\",\"position\":[1,2,3]}],\"unknown\":";
  EXPECT_FALSE(ParseLightsJson(nested + std::string(1 << 20, '{')).ok());
  const std::string whole = testing::Bytes(testing::RepositoryFile("examples/yard_180/scene.json"));
  ASSERT_GT(whole.size(), 1000);
  for (size_t length = 0; length + 1 < whole.size(); ++length) {
    EXPECT_FALSE(ParseLightsJson(absl::string_view(whole).substr(0, length)).ok()) << length;
  }
}

TEST(ParseLight, ReadsPointsAndSuns) {
  const auto key = ParseLight("key=point:1,-2.5,3e2");
  ASSERT_TRUE(key.ok()) << key.status();
  EXPECT_EQ(key->name, "key");
  EXPECT_EQ(key->kind, Light::Kind::kPoint);
  EXPECT_EQ(key->position, Eigen::Vector3d(1.0, -2.5, 300.0));
  const auto sun = ParseLight("my=sun=sun:0,0,-1");
  ASSERT_TRUE(sun.ok()) << sun.status();
  EXPECT_EQ(sun->name, "my=sun");
  EXPECT_EQ(sun->kind, Light::Kind::kDirectional);
  EXPECT_EQ(sun->direction, Eigen::Vector3d(0.0, 0.0, -1.0));
}

TEST(ParseLight, ErrorsQuoteTheTextAndShowTheForm) {
  const struct {
    const char* text;
    const char* part;
  } cases[] = {{"key", "no '='"},
               {"key=", "kind = \"\""},
               {"key=spot:1,2,3", "kind = \"spot\""},
               {"key=point:1,2", "2 numbers"},
               {"key=point:1,2,3,4", "4 numbers"},
               {"key=point:1,two,3", "\"two\""},
               {"key=point:1,,3", "\"\" is not a number"},
               {"key=point", "0 numbers"}};
  for (const auto& c : cases) {
    const auto light = ParseLight(c.text);
    ASSERT_EQ(light.status().code(), absl::StatusCode::kInvalidArgument) << c.text;
    EXPECT_TRUE(HasAll(light.status().message(), {c.text, c.part, "NAME=point:x,y,z"}));
  }
  EXPECT_TRUE(HasAll(ParseLight("=sun:0,0,1").status().message(), {"name is empty"}));
  EXPECT_TRUE(HasAll(ParseLight("a=sun:0,0,0").status().message(), {"\"a\"", "direction"}));
  EXPECT_TRUE(HasAll(ParseLight("a=sun:nan,0,0").status().message(), {"\"a\"", "direction"}));
  EXPECT_TRUE(HasAll(ParseLight("a=point:inf,0,0").status().message(), {"\"a\"", "position"}));
}

TEST(LightProto, ReadsBackWhatItWrote) {
  for (const char* text : {"key=point:0.1,-2.5,1e-300", "sun=sun:0.3,0.7,-1"}) {
    const auto light = ParseLight(text);
    ASSERT_TRUE(light.ok()) << light.status();
    const auto copy = LightFromProto(LightToProto(*light));
    ASSERT_TRUE(copy.ok()) << copy.status();
    EXPECT_EQ(copy->name, light->name);
    EXPECT_EQ(copy->kind, light->kind);
    EXPECT_EQ(copy->position, light->position);
    EXPECT_EQ(copy->direction, light->direction);
  }
}

}  // namespace
}  // namespace lightfit
