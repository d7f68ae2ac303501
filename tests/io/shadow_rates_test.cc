// How many read-backs with shadows the wrong way round, and with lights of another scene, are told
// of without a header, and that none that is right is.

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "optimizer/readback/shadow_check.h"
#include "tests/io/testing.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

struct Rate {
  int num_told = 0, num_cases = 0;

  void Count(const Readback& readback, const Light& light) {
    ++num_cases;
    if (VerdictOf(CheckShadows(readback, light)) != ShadowVerdict::kPlausible) ++num_told;
  }
  double share() const { return static_cast<double>(num_told) / num_cases; }
};

struct Rates {
  Rate right, inverted, of_another;

  // Each light as it is, its shadow the wrong way round, and every other light in its place.
  void Count(const Readback& readback, const std::vector<Light>& lights) {
    std::vector<uint32_t> turned;
    turned.reserve(readback.shadow_bits.size());
    for (const uint32_t word : readback.shadow_bits) turned.push_back(~word);
    for (const Light& light : lights) {
      right.Count(readback, light);
      Readback inverse = readback;
      inverse.shadow_bits = turned;
      inverted.Count(inverse, light);
      for (Light other : lights) {
        if (other.shadow_bit == light.shadow_bit) continue;
        other.shadow_bit = light.shadow_bit;
        of_another.Count(readback, other);
      }
    }
  }

  void Print(const char* of) const {
    std::printf(
        "%s: told of %d of %d inverted, of %d of %d with another light, of %d of %d right\n",
        of,
        inverted.num_told,
        inverted.num_cases,
        of_another.num_told,
        of_another.num_cases,
        right.num_told,
        right.num_cases);
  }
};

// Boxes in the open under suns and lamps; many throw no shadow that is in view with its caster.
TEST(ShadowRates, OfBoxes) {
  Rates rates;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const BoxScene scene = MakeBoxScene(seed);
    const std::vector<Light> lights = RandomLights(scene, seed, 3);
    rates.Count(Render(scene, RandomCamera(scene, seed, 120, 90), lights).View(), lights);
  }
  rates.Print("boxes");
  EXPECT_EQ(rates.right.num_told, 0);
  // Measured 0.7 and 0.3.
  EXPECT_GE(rates.inverted.share(), 0.6);
  EXPECT_GE(rates.of_another.share(), 0.2);
}

TEST(ShadowRates, OfTheExamples) {
  for (const std::string set : {"yard_180", "room_180"}) {
    const std::string folder = testing::RepositoryFile("examples/" + set);
    const auto lights = ReadLightsFile(folder + "/scene.json");
    ASSERT_THAT(lights, testing::IsOk());
    const auto file = ReadReadbackExr(folder + "/0001.exr", *lights);
    ASSERT_THAT(file, testing::IsOk());
    EXPECT_TRUE(file->warnings.empty()) << file->warnings.front().text;
    Rates rates;
    rates.Count(file->View(), *lights);
    rates.Print(set.c_str());
    EXPECT_EQ(rates.right.num_told, 0);
    EXPECT_EQ(rates.inverted.num_told, rates.inverted.num_cases);
  }
}

TEST(ShadowRates, OfAllReadbacks) {
  const std::string root = testing::RepositoryFile("../shared/readbacks");
  if (!std::filesystem::exists(root)) {
    GTEST_SKIP() << "no " << root << ": the larger read-backs are not on this machine";
  }
  Rates rates;
  for (const auto& set : std::filesystem::directory_iterator(root)) {
    // Large ones have a smaller brother, and take long to read.
    const std::string name = set.path().filename();
    if (!set.is_directory() || name.find("750") != name.npos || name.find("1080") != name.npos) {
      continue;
    }
    const auto lights = ReadLightsFile(set.path() / "scene.json");
    ASSERT_THAT(lights, testing::IsOk());
    for (const char* frame : {"0001.exr", "0012.exr"}) {
      if (!std::filesystem::exists(set.path() / frame)) continue;
      const auto file = ReadReadbackExr(set.path() / frame, *lights);
      ASSERT_THAT(file, testing::IsOk());
      EXPECT_TRUE(file->warnings.empty()) << set.path() << file->warnings.front().text;
      rates.Count(file->View(), *lights);
    }
  }
  rates.Print("read-backs");
  EXPECT_EQ(rates.right.num_told, 0);
  EXPECT_EQ(rates.inverted.num_told, rates.inverted.num_cases);
  // Measured 0.7.
  EXPECT_GE(rates.of_another.share(), 0.6);
}

}  // namespace
}  // namespace lightfit
