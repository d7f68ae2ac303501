#include "wire/proto_json.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lightfit/v1/result.pb.h"
#include "tests/io/testing.h"

namespace lightfit {
namespace {

TEST(ProtoJson, NamesAreCamelCaseAndZerosAreWritten) {
  v1::LightResult result;
  result.set_name("sun");
  result.mutable_map_from_world()->add_m(0.1);
  const auto json = ProtoToJson(result);
  ASSERT_TRUE(json.ok()) << json.status();
  EXPECT_TRUE(testing::HasAll(*json, {"\"mapFromWorld\"", "0.1\n", "\"evaluations\": 0"}));
  EXPECT_EQ(json->find("timeMs"), std::string::npos);
  EXPECT_EQ(json->back(), '\n');
}

TEST(ProtoJson, DoublesReadBackExactly) {
  std::mt19937_64 random(testing::kSeed);
  v1::Matrix4x4 matrix;
  for (int i = 0; i < 2000; ++i) {
    double value;
    const uint64_t bits = random();
    std::memcpy(&value, &bits, sizeof(value));
    if (std::isfinite(value)) matrix.add_m(value);
  }
  const auto json = ProtoToJson(matrix);
  ASSERT_TRUE(json.ok()) << json.status();
  v1::Matrix4x4 copy;
  ASSERT_TRUE(JsonToProto(*json, copy).ok());
  ASSERT_EQ(copy.m_size(), matrix.m_size());
  for (int i = 0; i < matrix.m_size(); ++i) EXPECT_EQ(copy.m(i), matrix.m(i)) << i;
}

TEST(ProtoJson, UnknownFieldsAreIgnoredAndErrorsNameTheMessage) {
  v1::Light light;
  EXPECT_TRUE(JsonToProto(R"({"name":"a","color":{"r":[[1,2],[3]]}})", light).ok());
  EXPECT_EQ(light.name(), "a");
  const absl::Status status = JsonToProto(R"({"name":)", light);
  EXPECT_TRUE(testing::HasAll(status.message(), {"lightfit.v1.Light"}));
}

}  // namespace
}  // namespace lightfit
