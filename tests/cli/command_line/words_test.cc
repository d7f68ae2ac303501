// The words of the command line: choices by their usual names, sizes, distances, and messages that
// name options and no field of the library.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <regex>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "cli/command_line/command_line.h"
#include "cli/command_line/declared.h"
#include "cli/command_line/option_words.h"
#include "io/readback_exr_write.h"
#include "tests/cli/box_shot.h"
#include "tests/cli/command_line/shell.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string FitJson(const std::vector<std::string>& more) {
  std::vector<std::string> words = {"fit",
                                    kYard,
                                    "--lights",
                                    kYardLights,
                                    "--only",
                                    "sun",
                                    "--search",
                                    "focused",
                                    "-q",
                                    "--json",
                                    "-"};
  words.insert(words.end(), more.begin(), more.end());
  const ProcessResult result = RunLightfit(words);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.out;
}

TEST(Choices, GoByTheirUsualNamesInAnyCase) {
  for (const std::vector<std::string>& same : std::vector<std::vector<std::string>>{
           {"vulkan", "Vulkan", "VK"},
           {"direct3d", "d3d", "D3D12", "dx12", "DirectX", "metal", "WebGPU"},
           {"opengl", "OpenGL", "gl", "WebGL"},
           {"reversed-z", "Reversed_Z", "reverse-z"}}) {
    const std::string wanted = FitJson({"--clip", same[0]});
    for (const std::string& other : same) EXPECT_EQ(FitJson({"--clip", other}), wanted) << other;
  }
  EXPECT_EQ(FitJson({"--metric", "L2_Edge", "--cover", "all", "--border", "Black"}),
            FitJson({"--metric", "l2-edge", "--cover", "receivers", "--border", "dark"}));
  const ProcessResult wrong =
      RunLightfit({"fit", kYard, "--lights", kYardLights, "--clip", "vulcan"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err,
              AllOf(HasSubstr("--clip: there is no \"vulcan\", want vulkan, "),
                    HasSubstr("did you mean \"vulkan\"?")));
}

TEST(Sizes, MayBeWrittenAsPeopleDo) {
  const std::string wanted = FitJson({"--map", "2048x2048"});
  for (const char* same : {"2048X2048", "2048", "2k", "2K", "2kx2k", "2048\u00d72048"}) {
    EXPECT_EQ(FitJson({"--map", same}), wanted) << same;
  }
  // A number of texels is one; of a picture a single number might as well be its width.
  EXPECT_EQ(RunLightfit({"render", "generate", "--size", "640"}).exit_code, 1);
  const ProcessResult image = RunLightfit({"allocate", kYard, "--image", "1920"});
  EXPECT_EQ(image.exit_code, 1);
  EXPECT_THAT(image.err, HasSubstr("--image: \"1920\" is no size, want WIDTHxHEIGHT"));
}

TEST(Sizes, AllVerbsHaveOneDefault) {
  for (const std::string verb : {"fit", "shot", "compare", "tune"}) {
    EXPECT_THAT(RunLightfit({verb, "--help"}).out, HasSubstr("texels [1024x1024]")) << verb;
  }
}

// The wrong inputs that the library answers, in all verbs: no message has a field of its own, such
// as options.margin_percent, nor an enumerator. Fields of the files that people write are theirs.
TEST(Messages, NameOptionsAndNoFieldsOfTheLibrary) {
  const BoxShot shot(2);
  const std::vector<std::string> fit = {"fit", kYard, "--lights", kYardLights};
  const std::vector<std::string> allocate = {"allocate", kYard, "--lights", kYardLights};
  const std::vector<std::string> scene = {
      "generate:triangles=3000,objects=9", "--camera", "0,1,9:0,0,0", "--light", "a=sun:0,-1,0.1"};
  const auto joined = [](std::vector<std::string> a, const std::vector<std::string>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  std::vector<std::vector<std::string>> wrong;
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--margin-percent", "nan"},
           {"--margin-percent", "101"},
           {"--min-samples", "0"},
           {"--depth-kind", "ndc-0-1"},
           {"--depth-kind", "ndc-minus-1-1", "--near", "3", "--far", "2"},
           {"--depth-kind", "ndc-reversed", "--near", "0.1"},
           {"--depth-channel", "depht"},
           {"--shadow-channel", "shadow"},
           {"--shadow-channel", "{light}{light}"},
           {"--facing-channel", "facing"},
           {"--mapped-channel", "mapped"},
           {"--shadow-bits-channel", "bits"},
           {"--pixel-aspect", "nan"},
           {"--pixel-aspect", "3"},
           {"--cover-readback", kRoom},
           {"--cover-readback", kYardLights},
           {"--camera", kYardLights},
           {"--maps", "33"},
           {"--maps", "2", "--guard", "nan"},
           {"--maps", "2", "--guard", "600"},
           {"--maps", "4", "--texels", "3"},
           {"--maps", "4", "--map", "64", "--guard", "31"},
           {"--maps", "4", "--map", "8", "--guard", "4"},
           {"--maps", "4", "--multiple", "0"},
           {"--maps", "4", "--min-side", "0"},
           {"--maps", "4", "--min-side", "512", "--max-side", "256"},
           {"--maps", "4", "--min-side", "70", "--max-side", "100"},
           {"--maps", "4", "--texels", "64x64", "--min-side", "64"},
           {"--maps", "4", "--min-side", "64", "--guard", "40"},
           {"--map", "0x3"},
           {"--map", "70000"}}) {
    wrong.push_back(joined(fit, more));
  }
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--budget", "100x100"},
           {"--budget", "1024x1024", "--min-side", "70", "--max-side", "100"},
           {"--budget", "1024x1024", "--multiple", "-3"},
           {"--budget", "1024x1024", "--min-side", "5", "--max-side", "4"},
           {"--budget", "1024x1024", "--margin-percent", "nan"},
           {"--budget", "128x128", "--maps", "4"},
           {"--budget", "1024x1024", "--maps", "2", "--guard", "9999"},
           {"--tolerance", "rms:1e-9"},
           {"--tolerance", "rms:1", "--image", "999999x1"}}) {
    wrong.push_back(joined(allocate, more));
  }
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--stability", "nan"},
                                             {"--stability", "2"},
                                             {"--replace-below", "nan"},
                                             {"--replace-below", "-1"},
                                             {"--update-every", "0"},
                                             {"--cover-margin-percent", "nan"},
                                             {"--cover-margin-percent", "-1"},
                                             {"--margin-percent", "nan"},
                                             {"--as-published"},
                                             {"--as-published", "--per-shot"},
                                             {"--maps", "2", "--cover-margin-percent", "nan"},
                                             {"--rounds", "-1"}}) {
    wrong.push_back(joined({"shot", kYard, "--lights", kYardLights, "-o", shot.Output()}, more));
  }
  for (const std::string verb : {"compare", "tune", "render"}) {
    for (const std::vector<std::string>& more :
         std::vector<std::vector<std::string>>{{"--bias-share", "nan"},
                                               {"--phases", "3"},
                                               {"--margin-percent", "nan"},
                                               {"--evaluations", "0"},
                                               {"--up", "0,0,0"},
                                               {"--camera-step", "nan,0,0"},
                                               {"--readback", "0x0"}}) {
      wrong.push_back(joined(joined({verb}, scene), more));
    }
    for (const char* generate : {"generate:objects=-1",
                                 "generate:triangles=1",
                                 "generate:floor=0",
                                 "generate:kind=room,triangles=1",
                                 "generate:seed=x"}) {
      wrong.push_back(
          joined({verb, generate},
                 {"--camera", "0,1,9:0,0,0", "--light", "a=sun:0,-1,0.1", "-o", "x.exr"}));
      if (verb != "render") wrong.back().resize(wrong.back().size() - 2);
    }
  }
  // An underscore between letters, a dotted field, an enumerator; outside of quotes and paths.
  const std::regex quoted("\"[^\"]*\"|[^ ]*/[^ ]*");
  const std::regex field(
      "\\b[a-z]+_[a-z_]+\\b|\\b(METRIC|COVER|BORDER|KIND|DEPTH)_[A-Z]|\\b(options|rules|fit|"
      "readback|judge)\\.[a-z]|\\bk[A-Z]");
  int num_messages = 0;
  for (const std::vector<std::string>& words : wrong) {
    const ProcessResult result = RunLightfit(words);
    EXPECT_LE(result.exit_code, 3) << ::testing::PrintToString(words) << result.err;
    num_messages += result.err.empty() ? 0 : 1;
    const std::string message = std::regex_replace(result.err, quoted, "");
    EXPECT_FALSE(std::regex_search(message, field)) << ::testing::PrintToString(words) << "\n"
                                                    << result.err;
  }
  EXPECT_GE(num_messages, 80);
}

// Of all verbs, whatever takes no name: found by what the help calls their values.
TEST(Numbers, NaNIsRefusedByEveryOptionBeforeAnyWork) {
  const auto is_name = [](const std::string& value) {
    for (const char* word :
         {"FILE", ".json", "FOLDER", "LIGHT", "CHANNEL", "FORMAT", "VIEW", "HOST:PORT", "NAME"}) {
      if (absl::StrContains(value, word)) return true;
    }
    return false;
  };
  const cli::CommandLine line = cli::MakeCommandLine();
  int num_options = 0;
  for (const CLI::App* verb : cli::DeclaredVerbs(*line.app)) {
    for (const CLI::Option* option : cli::DeclaredOptions(*verb)) {
      const std::string value = cli::ValueWord(*option);
      if (option->get_items_expected_max() == 0 || is_name(value)) continue;
      const std::string name = cli::NamesOf(*option).back();
      std::string answer;
      try {
        line.app->parse(std::vector<std::string>{"nan", name, verb->get_name()});  // from its end
      } catch (const CLI::ParseError& error) {
        answer = error.what();
      }
      EXPECT_THAT(answer, AllOf(HasSubstr(name), HasSubstr("nan")))
          << verb->get_name() << " " << value;
      ++num_options;
    }
  }
  EXPECT_GE(num_options, 100);
  const ProcessResult result =
      RunLightfit({"compare", kYard, "--lights", kYardLights, "--bias-share", "nan"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("--bias-share: \"nan\", want a number from 0 to 1"));
  EXPECT_THAT(result.out, IsEmpty());
}

TEST(Numbers, ABackgroundMayBeInfinite) {
  const ProcessResult result =
      RunLightfit({"fit", kYard, "--lights", kYardLights, "--only", "sun", "--background", "inf"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const ProcessResult refused =
      RunLightfit({"fit", kYard, "--lights", kYardLights, "--background", "0"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("--background: \"0\", want a number above 0, or inf"));
}

// Messages that are hard to provoke, as the library has them.
TEST(Messages, AreTranslatedByTheVerbsOwnOptions) {
  const cli::CommandLine line = cli::MakeCommandLine();
  const auto said = [&line](const char* verb, const char* message) {
    cli::NameOptionsOf(*line.app->get_subcommand(verb));
    return cli::InOptionWords(message);
  };
  EXPECT_EQ(said("fit", "options.margin_percent = 200, want 0 ... 100"),
            "--margin-percent 200, want 0 ... 100");
  EXPECT_EQ(said("fit", "options.max_maps = 40, want 1 ... 32"), "--maps 40, want 1 ... 32");
  EXPECT_EQ(said("allocate", "budget_texels = 3, want at least 1 texel"),
            "--budget 3, want at least 1 texel");
  EXPECT_EQ(said("fit", "options.texels = 3, want 4"), "--texels 3, want 4");
  EXPECT_EQ(said("allocate", "options.texels = 3, want 4"), "--budget 3, want 4");
  EXPECT_EQ(said("fit", "or cover all receivers (options.cover = kReceivers)"),
            "or cover all receivers (--cover receivers)");
  EXPECT_EQ(said("shot", "options.update_every_frames = 0, want at least 1"),
            "--update-every 0, want at least 1");
  EXPECT_EQ(said("fit", "a.exr: depth_channel \"my_z\" is not there; channels: key_left.Z"),
            "a.exr: --depth-channel \"my_z\" is not there; channels: key_left.Z");
  EXPECT_EQ(said("fit", "readback.fine_cover: 0 x 0 cells"), "--cover-readback: 0 x 0 cells");
  EXPECT_EQ(said("fit", "within max_frame_shift = 0.2"), "within max frame shift = 0.2");
  EXPECT_EQ(said("fit", "options.metric is METRIC_L1_ACROSS_EDGE here and METRIC_L2 there"),
            "--metric is l1-edge here and l2 there");
  EXPECT_EQ(said("fit", "a.exr: near_1 kept_2"), "a.exr: near_1 kept_2");
  EXPECT_EQ(said("compare", "--phases: judge.phases = 3, want 4"), "--phases 3, want 4");
  for (const std::string file : {"fit.exr",
                                 "plan.csv",
                                 "readback.json",
                                 "options.png",
                                 "samples.z",
                                 "judge.summary",
                                 "fit_1.exr",
                                 "margin.percent"}) {
    EXPECT_EQ(said("fit", (file + ": no such file").c_str()), file + ": no such file");
  }
  // Files keep their names and fields.
  EXPECT_EQ(said("fit", "plan.json: light \"lamp\": plan.maps: 0 of them"),
            "plan.json: light \"lamp\": plan.maps: 0 of them");
  const std::string file = "/a/options.max_maps/lights_1.json: shadow_bit = 40, want 0 ... 31";
  EXPECT_EQ(said("fit", file.c_str()), file);
}

// Depth as renderers with an infinite far plane write it, near / z in one form or another: the same
// matrices as by camera z.
TEST(Distances, AFarPlaneMayBeInfinite) {
  // Rounding to floats puts one sample of some 300 to the other side of a threshold; any other
  // meaning of the numbers gives other surfaces.
  constexpr double kTolerance = 5e-3;
  testing::BoxWalk walk(7, 1, 1, 72, 48);
  SyntheticReadback& view = walk.views[0];
  const std::vector<float> camera_z = view.depth;
  const double near = 0.5 * *std::min_element(camera_z.begin(), camera_z.end());
  const TemporaryFolder folder;
  const std::string exr = folder.Path("a.exr"), json = folder.Path("a.json");
  v1::LightList list;
  *list.add_lights() = LightToProto(walk.lights[0]);
  WriteFile(folder.Path("lights.json"), ProtoToJson(list).value());
  const auto fit = [&](const std::vector<std::string>& more) {
    ASSERT_THAT(WriteReadbackExr(exr, view.View(), walk.lights), testing::IsOk());
    std::vector<std::string> words = {"fit",
                                      exr,
                                      "--lights",
                                      folder.Path("lights.json"),
                                      "--search",
                                      "line",
                                      "-q",
                                      "--json",
                                      json};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult result = RunLightfit(words);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  };
  fit({});
  const Eigen::Matrix4d wanted = MatrixOf(ReadResult(json).lights(0).map_from_world());
  struct Kind {
    const char* word;
    double at_far, per_near_over_z;
  };
  for (const Kind& kind :
       {Kind{"ndc-reversed", 0.0, 1.0}, {"ndc-0-1", 1.0, -1.0}, {"ndc-minus-1-1", 1.0, -2.0}}) {
    for (size_t i = 0; i < camera_z.size(); ++i) {
      const bool is_background = camera_z[i] == kSyntheticBackground;
      view.depth[i] = static_cast<float>(
          kind.at_far + (is_background ? 0.0 : kind.per_near_over_z * near / camera_z[i]));
    }
    for (const char* far : {"inf", "Infinity"}) {
      fit({"--depth-kind", kind.word, "--near", absl::StrCat(near), "--far", far});
      const Eigen::Matrix4d found = MatrixOf(ReadResult(json).lights(0).map_from_world());
      EXPECT_LT((found - wanted).norm(), kTolerance * wanted.norm()) << kind.word;
    }
  }
  for (const char* bad : {"-inf", "nan", "0", "-1", "far"}) {
    const ProcessResult refused =
        RunLightfit({"fit", kYard, "--lights", kYardLights, "--near", "0.1", "--far", bad});
    EXPECT_EQ(refused.exit_code, 1) << bad;
    EXPECT_THAT(refused.err, HasSubstr("want a distance above 0, or inf"));
  }
}

}  // namespace
}  // namespace lightfit
