#include "io/header_lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/readback_exr_write.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::ExrPart;
using testing::TemporaryFolder;

ExrPart PartWithDepth(const std::string& name) {
  ExrPart part;
  part.name = name;
  part.channels = {{"Z", Imf::FLOAT, [](int, int) { return 5.0; }}};
  return part;
}

TEST(HeaderLights, AreThoseThatTheReadBackWasWrittenWith) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.exr");
  const std::vector<Light> lights = {Light::Directional("sun", {0.1, 2.0 / 3.0, -3e-7}, 4),
                                     Light::Point("kéy.left", {1e6, -0.1, 1.0 / 3.0}, 9)};
  const std::vector<float> depth(48, 5.0F);
  const std::vector<uint32_t> bits(48, 0);
  Readback readback;
  readback.camera = testing::StandardCamera(8, 6);
  readback.depth = depth;
  readback.shadow_bits = bits;
  ASSERT_THAT(WriteReadbackExr(path, readback, lights), testing::IsOk());
  const auto read = LightsFromHeader(path);
  ASSERT_THAT(read, testing::IsOk());
  ASSERT_TRUE(read->has_value());
  ASSERT_EQ((*read)->size(), 2U);
  const Light &sun = (**read)[0], &key = (**read)[1];
  EXPECT_EQ(sun.name, "sun");
  EXPECT_EQ(sun.kind, Light::Kind::kDirectional);
  EXPECT_EQ(sun.direction, lights[0].direction);  // every digit
  EXPECT_EQ(key.name, "kéy.left");
  EXPECT_EQ(key.kind, Light::Kind::kPoint);
  EXPECT_EQ(key.position, lights[1].position);
  EXPECT_EQ(key.shadow_bit, 1);  // in order, as in a lights file
}

TEST(HeaderLights, MayStandInAnyPart) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.exr");
  std::vector<ExrPart> parts = {PartWithDepth("rgba"), PartWithDepth("depth")};
  testing::WriteExr(path, parts);
  auto read = LightsFromHeader(path);
  ASSERT_THAT(read, testing::IsOk());
  EXPECT_FALSE(read->has_value());

  parts[1].strings = {
      {"lightfit.lights", R"({"lights": [{"name": "a", "direction": [0, 0, -1]}]})"}};
  testing::WriteExr(path, parts);
  read = LightsFromHeader(path);
  ASSERT_THAT(read, testing::IsOk());
  ASSERT_TRUE(read->has_value());
  EXPECT_EQ((*read)->front().name, "a");
}

TEST(HeaderLights, ThatAreNoLightsAreAnErrorThatNamesTheAttribute) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.exr");
  for (const char* value : {"", "sun", "{\"lights\": []}", "{\"lights\": [{\"name\": \"a\"}]}"}) {
    ExrPart part = PartWithDepth("rgba");
    part.strings = {{"lightfit.lights", value}};
    testing::WriteExr(path, {part});
    const absl::Status status = LightsFromHeader(path).status();
    EXPECT_FALSE(status.ok()) << value;
    EXPECT_TRUE(testing::HasAll(status.message(), {path, "attribute \"lightfit.lights\""}));
  }
}

TEST(HeaderLights, CannotHaveNamesThatAreNotUtf8) {
  EXPECT_FALSE(LightsForHeader({Light::Directional("s\xFFn", {0, 0, -1})}).ok());
}

}  // namespace
}  // namespace lightfit
