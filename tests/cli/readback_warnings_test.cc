// Read-backs that are wrong but plausible, and skies at a finite depth: what each verb says.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <filesystem>
#include <string>
#include <vector>

#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "io/readback_exr_write.h"
#include "tests/cli/examples.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Arguments = std::vector<std::string>;

Arguments Joined(Arguments first, const Arguments& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

// The yard with its lights in the header, its sky at a depth of one's choice.
class Yard : public ::testing::Test {
 protected:
  void SetUp() override {
    auto lights = ReadLightsFile(kYardLights);
    ASSERT_THAT(lights, testing::IsOk());
    lights_ = *std::move(lights);
    auto yard = ReadReadbackExr(kYard, lights_);
    ASSERT_THAT(yard, testing::IsOk());
    yard_ = *std::move(yard);
  }

  std::string Write(const std::string& name, float sky, bool inverts = false) {
    ReadbackFile file = yard_;
    for (size_t i = 0; i < file.depth.size(); ++i) {
      if (file.depth[i] >= 1e9F) file.depth[i] = sky;
      if (inverts) file.shadow_bits[i] = ~file.shadow_bits[i];
    }
    EXPECT_THAT(WriteReadbackExr(folder_.Path(name), file.View(), lights_), testing::IsOk());
    return folder_.Path(name);
  }

  ProcessResult Run(const Arguments& arguments, const std::string& lights = kYardLights) const {
    return RunLightfit(Joined(arguments, {"--lights", lights}));
  }

  TemporaryFolder folder_;
  std::vector<Light> lights_;
  ReadbackFile yard_;
};

TEST_F(Yard, SaysNothingOfAReadBackThatIsRight) {
  const ProcessResult result = Run({"fit", Write("a.exr", 1e10F), "--quiet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(Yard, EveryVerbNamesTheSkyAndTheOption) {
  const std::string frame = Write("0001.exr", 65504), second = Write("0002.exr", 65504);
  const std::string says = "have one depth, 65504";
  for (const Arguments& verb : {Arguments{"fit", frame, "--only", "sun"},
                                {"compare", frame, "--map", "256x256"},
                                {"summarize", frame, second, "-o", folder_.Path("a.summary")},
                                {"allocate", frame, "--budget", "1M"},
                                {"shot", frame, second, "-o", folder_.Path("shot")}}) {
    const ProcessResult result = Run(verb);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err,
                AllOf(HasSubstr(says),
                      HasSubstr("taken for background"),
                      HasSubstr("--background 65504"),
                      HasSubstr("--background inf")))
        << verb[0];
    // Once for both files.
    EXPECT_EQ(result.err.find(says), result.err.rfind(says)) << verb[0];
    if (verb[0] == "shot") continue;
    EXPECT_THAT(result.out, HasSubstr("depth \"Z\"")) << verb[0];
    EXPECT_THAT(Run(Joined(verb, {"--background", "65504"})).err, Not(HasSubstr(says))) << verb[0];
  }
}

TEST_F(Yard, WithASkyTheMatricesAreThoseWithout) {
  const auto json = [&](const std::string& name, const std::string& frame, const Arguments& more) {
    const std::string path = folder_.Path(name);
    EXPECT_EQ(Run(Joined({"fit", frame, "--json", path, "--cover", "receivers"}, more)).exit_code,
              0);
    return ReadResult(path);
  };
  const v1::FitResult clean = json("clean.json", Write("clean.exr", 1e10F), {});
  const std::string sky = Write("sky.exr", 1e5F);
  const v1::FitResult found = json("found.json", sky, {});
  const v1::FitResult stated = json("stated.json", sky, {"--background", "90000"});
  ASSERT_GT(clean.lights_size(), 1);
  for (int l = 0; l < clean.lights_size(); ++l) {
    const std::string want = clean.lights(l).map_from_world().SerializeAsString();
    EXPECT_EQ(found.lights(l).map_from_world().SerializeAsString(), want);
    EXPECT_EQ(stated.lights(l).map_from_world().SerializeAsString(), want);
    EXPECT_EQ(found.lights(l).energies().SerializeAsString(),
              clean.lights(l).energies().SerializeAsString());
  }
  EXPECT_EQ(found.readback().background(), 1e5);
  EXPECT_EQ(found.readback().warnings_size(), 1);
  EXPECT_FALSE(clean.readback().has_background());
  EXPECT_EQ(clean.readback().warnings_size(), 0);
}

TEST_F(Yard, BackgroundIsForDistances) {
  const ProcessResult result = Run({"fit", kYard, "--background", "1", "--depth-kind", "ndc-0-1"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--background"));
}

TEST_F(Yard, AnInvertedPassIsToldOf) {
  const ProcessResult result = Run({"fit", Write("a.exr", 1e10F, true), "--quiet"});
  for (const Light& light : lights_) {
    EXPECT_THAT(result.err, HasSubstr("light \"" + light.name + "\": of "));
  }
  EXPECT_THAT(result.err, HasSubstr("the wrong way round"));
}

TEST_F(Yard, LightsOfAnotherSceneAreToldByTheHeader) {
  const std::string moved = folder_.Path("moved.json");
  WriteFile(moved, R"({"lights": [{"name": "sun", "direction": [0.1, 0.9, -0.7]}]})");
  const ProcessResult result = Run({"fit", Write("a.exr", 1e10F), "--quiet"}, moved);
  EXPECT_THAT(result.err,
              HasSubstr("light \"sun\": its direction (0.1, 0.9, -0.7) is not that of"));
}

TEST_F(Yard, ACameraThatIsNotTheFilesOwnIsToldOf) {
  const Arguments fit = {"fit", Write("a.exr", 1e10F), "--quiet", "--camera"};
  EXPECT_THAT(Run(Joined(fit, {kYardLights})).err, IsEmpty());
  EXPECT_THAT(Run(Joined(fit, {kRoomLights})).err, HasSubstr("the camera of --camera is not that"));
}

// The same frame with its sky at 1e10.
TEST(SharedCases, SkyAtTheLargestHalf) {
  const std::string folder = RepositoryPath("../shared/cases/exr_sky_at_65504");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no case at " << folder;
  const TemporaryFolder output;
  const auto fit = [&](const std::string& name, const Arguments& more) {
    const std::string path = output.Path(name + ".json");
    const ProcessResult result = RunLightfit(Joined({"fit",
                                                     folder + "/" + name + ".exr",
                                                     "--lights",
                                                     folder + "/lights.json",
                                                     "--cover",
                                                     "receivers",
                                                     "--json",
                                                     path},
                                                    more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return std::pair(ReadResult(path), result.err);
  };
  const auto [plain, silent] = fit("plain", {});
  EXPECT_THAT(silent, IsEmpty());
  const auto [found, says] = fit("frame", {});
  EXPECT_THAT(says, AllOf(HasSubstr("65504"), HasSubstr("--background 65504")));
  const auto [stated, nothing] = fit("frame", {"--background", "60000"});
  EXPECT_THAT(nothing, IsEmpty());
  // Half floats have 11 bits: depths, and with them figures, move by some thousandths.
  constexpr double kHalf = 0.02;
  for (int l = 0; l < plain.lights_size(); ++l) {
    EXPECT_EQ(found.lights(l).SerializeAsString(), stated.lights(l).SerializeAsString());
    for (const v1::FitResult* other : {&found}) {
      EXPECT_NEAR(
          other->lights(l).energies().final() / plain.lights(l).energies().final(), 1.0, kHalf);
      EXPECT_NEAR(
          other->lights(l).energies().focused() / plain.lights(l).energies().focused(), 1.0, kHalf);
    }
  }
}

// The camera's axis meets the frame at (0.95, 0.2).
TEST(SharedCases, ShiftedLens) {
  const std::string folder = RepositoryPath("../shared/cases/exr_lens_shift");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no case at " << folder;
  const TemporaryFolder output;
  const Arguments fit = {"fit",
                         folder + "/frame.exr",
                         "--lights",
                         folder + "/lights.json",
                         "--json",
                         output.Path("out.json")};
  const ProcessResult result = RunLightfit(fit);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("(0.95, 0.2)"), HasSubstr("--camera-convention shifted")));
  const v1::FitResult found = ReadResult(output.Path("out.json"));
  const ProcessResult stated = RunLightfit(Joined(fit, {"--camera-convention", "shifted"}));
  EXPECT_THAT(stated.err, IsEmpty());
  const v1::FitResult same = ReadResult(output.Path("out.json"));
  ASSERT_GT(found.lights_size(), 0);
  EXPECT_EQ(found.lights(0).SerializeAsString(), same.lights(0).SerializeAsString());
}

}  // namespace
}  // namespace lightfit
