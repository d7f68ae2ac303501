#include "scenes/obj_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
constexpr char kTriangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(ParseObj, ReadsNumbersInEveryForm) {
  const auto scene = ParseObj(
      "v .5 -.25 +1\nv 1. 2.e1 -3.5E-1\tv\nv +.5e+1 1e-400 0 1.0\n"
      "v 7 8 9 0.1 0.2 0.3\nf 1 2 3 4");
  ASSERT_THAT(scene, IsOk());
  EXPECT_THAT(scene->vertices,
              ElementsAre(Eigen::Vector3f(0.5, -0.25, 1),
                          Eigen::Vector3f(1, 20, -0.35F),
                          Eigen::Vector3f(5, 0, 0),
                          Eigen::Vector3f(7, 8, 9)));
}

TEST(ParseObj, ReadsFacesInEveryForm) {
  for (const char* face : {"f 1 2 3",
                           "f 1/1 2/1 3/1",
                           "f 1//1 2//1 3//1",
                           "f 1/2/3 2/3/4 3/4/5",
                           "f -3 -2 -1",
                           "f -3//-1 2 -1/7",
                           "  f\t1  2\t3  ",
                           "f 1 2 3 # the only one",
                           "fo 1 2 3",
                           "f 1 \\\n 2 \\\r\n 3",
                           "\\\nf 1 2 3\\\n"}) {
    SCOPED_TRACE(face);
    for (const char* end : {"", "\n", "\r\n", "\nf 1 2\np 1\nl 1 2\nusemtl f\no f 1 2\n"}) {
      const auto scene = ParseObj(absl::StrCat("# ä\nmtllib a.mtl\n", kTriangle, face, end));
      ASSERT_THAT(scene, IsOk());
      EXPECT_THAT(scene->triangles, ElementsAre(Eigen::Vector3i(0, 1, 2)));
    }
  }
}

TEST(ParseObj, TakesNegativeIndicesFromWhereTheyStand) {
  const auto scene = ParseObj(absl::StrCat(kTriangle, "f -1 -2 -3\nv 5 5 5\nf -1 -2 -3\n"));
  ASSERT_THAT(scene, IsOk());
  EXPECT_THAT(scene->triangles, ElementsAre(Eigen::Vector3i(2, 1, 0), Eigen::Vector3i(3, 2, 1)));
}

TEST(ParseObj, TakesVerticesThatStandBehindTheirFace) {
  const auto scene = ParseObj(absl::StrCat("f 1 2 3\n", kTriangle));
  ASSERT_THAT(scene, IsOk());
  EXPECT_EQ(scene->triangles.size(), 1u);
}

TEST(ParseObj, NamesTheLineThatIsWrong) {
  const struct {
    const char* text;
    const char* words[2];
  } kCases[] = {
      {"v 0,5 1 2\n", {"line 1", "v X Y Z"}},
      {"v 1 2\n", {"line 1", "v X Y Z"}},
      {"\n\nv 1 2 3x\n", {"line 3", "3x"}},
      {"v 0 0 0\nf 1 \\\n2 x\n", {"line 3", "no face"}},
      {"v 0 0 0\nf 0 1 1\n", {"line 2", "counted from 1"}},
      {"v 0 0 0\nf 1.5 1 1\n", {"line 2", "no face"}},
      {"v 0 0 0\nf -2 1 1\n", {"line 2", "beyond the first"}},
      {"v 0 0 0\nf 1 1 1\nf 1 7 1\nf 2 1 1\n", {"line 3", "vertex 7, but the file has 1"}},
      {"v 0 0 0\nf 1 99999999999999999999 1\n", {"line 2", "no face"}},
      {"v 0 0 0\nf 1 9999999999 1\n", {"line 2", "beyond"}}};
  for (const auto& c : kCases) {
    EXPECT_THAT(ParseObj(c.text),
                StatusIs(kInvalid, AllOf(HasSubstr(c.words[0]), HasSubstr(c.words[1]))))
        << c.text;
  }
}

TEST(ParseObj, CutsConcaveFaces) {
  const auto scene = ParseObj("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 2 3 4 5 1\n");
  ASSERT_THAT(scene, IsOk());
  ASSERT_EQ(scene->triangles.size(), 3u);
  double area = 0.0;
  for (const Eigen::Vector3i& t : scene->triangles) {
    const Eigen::Vector3d a = scene->WorldOf(t[0]);
    const double part = 0.5 * (scene->WorldOf(t[1]) - a).cross(scene->WorldOf(t[2]) - a).z();
    EXPECT_GT(part, 0.0);
    area += part;
  }
  EXPECT_EQ(area, 10.0);
}

}  // namespace
}  // namespace lightfit
