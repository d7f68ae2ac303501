// Every command that documents and --help show runs as it stands there, on read-backs that are
// shipped and scenes that are made here, and writes the files that it names.

#include "tests/cli/doc_commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "tests/cli/allocations.h"
#include "tests/cli/box_shot.h"
#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// What is not run here, and why.
struct NotRun {
  const char* words;
  const char* reason;
};
constexpr NotRun kNotRun[] = {
    {"serve", "runs until it is stopped: tests/server starts it with each of these options"},
};

// What would take minutes, or more memory than a test should: the same command with less to do.
constexpr std::pair<const char*, const char*> kSmaller[] = {
    {"compare generate ", "compare generate:triangles=3000,objects=12 "},
    {"render generate ", "render generate:triangles=3000,objects=12 "},
    {"generate:kind=room,seed=5 ", "generate:kind=room,seed=5,triangles=20000 "},
    {"--random-lights 500", "--random-lights 3"},
    {" --evaluations 2000", ""},  // tune has three
    {" --screen 1920x1080", ""},  // a screen has 96x72
    {"--picture-size 1280x720", "--picture-size 320x180"},
};

bool IsRun(const std::string& command) {
  return std::none_of(std::begin(kNotRun), std::end(kNotRun), [&](const NotRun& words) {
    return absl::StartsWith(command, words.words);
  });
}

std::string Smaller(std::string command) {
  for (const auto& [words, smaller] : kSmaller) {
    command = absl::StrReplaceAll(command, {{words, smaller}});
  }
  const bool is_tune = absl::StartsWith(command, "tune ");
  if (is_tune || absl::StartsWith(command, "compare ")) {
    command = absl::StrReplaceAll(
        command,
        {{"--map 2048x2048", "--map 128x128"}, {"--texels 1024x1024", "--texels 128x128"}});
    if (absl::StrContains(command, "--camera")) command += " --screen 96x72";
  }
  return is_tune ? command + " --evaluations 3" : command;
}

// The words after which a file or folder is written.
const std::set<std::string>& OutputFlags() {
  static const std::set<std::string> flags = {"--json",
                                              "--csv",
                                              "--picture",
                                              "--footprint",
                                              "--masks",
                                              "--lights-out",
                                              "--journal",
                                              "-o",
                                              "--output"};
  return flags;
}

// A floor with rows of columns on it, y up, as GLB.
std::string ColumnsGlb() {
  std::vector<float> positions;
  std::vector<uint32_t> indices;
  const auto add_box = [&](float x, float y, float z, float half, float height) {
    const auto first = static_cast<uint32_t>(positions.size() / 3);
    for (int corner = 0; corner < 8; ++corner) {
      positions.push_back(x + (corner & 1 ? half : -half));
      positions.push_back(y + (corner & 2 ? height : 0.0F));
      positions.push_back(z + (corner & 4 ? half : -half));
    }
    constexpr int kFaces[6][4] = {
        {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    for (const int* face : kFaces) {
      for (const int corner : {0, 1, 2, 0, 2, 3}) {
        indices.push_back(first + static_cast<uint32_t>(face[corner]));
      }
    }
  };
  add_box(0.0F, -0.2F, 0.0F, 20.0F, 0.2F);
  for (int column = 0; column < 5; ++column) {
    for (int row = 0; row < 5; ++row) {
      add_box(-1.0F - 3.0F * static_cast<float>(column),
              0.0F,
              -6.0F + 3.0F * static_cast<float>(row),
              0.25F,
              1.5F);
    }
  }
  const size_t position_bytes = positions.size() * sizeof(float);
  const size_t index_bytes = indices.size() * sizeof(uint32_t);
  std::string json = absl::StrFormat(
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      R"("buffers":[{"byteLength":%d}],)"
      R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":%d},)"
      R"({"buffer":0,"byteOffset":%d,"byteLength":%d}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":%d,"type":"VEC3",)"
      R"("min":[-20,-0.2,-20],"max":[20,1.5,20]},)"
      R"({"bufferView":1,"componentType":5125,"count":%d,"type":"SCALAR"}]})",
      position_bytes + index_bytes,
      position_bytes,
      position_bytes,
      index_bytes,
      positions.size() / 3,
      indices.size());
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF";
  const auto put = [&glb](size_t value) {
    const auto word = static_cast<uint32_t>(value);
    glb.append(reinterpret_cast<const char*>(&word), sizeof(word));
  };
  put(2);
  put(12 + 8 + json.size() + 8 + position_bytes + index_bytes);
  put(json.size());
  glb += "JSON" + json;
  put(position_bytes + index_bytes);
  glb += std::string("BIN\0", 4);
  glb.append(reinterpret_cast<const char*>(positions.data()), position_bytes);
  glb.append(reinterpret_cast<const char*>(indices.data()), index_bytes);
  return glb;
}

// The folder that commands run in, with what they name and nobody has made yet.
class Desk {
 public:
  explicit Desk(const CommandBlock& block)
      : before_(std::filesystem::current_path()),
        has_walk_(absl::StrContains(absl::StrJoin(block.commands, "\n"), "readbacks/walk")),
        shot_(2) {
    std::filesystem::current_path(folder_.Path(""));
    std::filesystem::create_directory_symlink(RepositoryPath("examples"), "examples");
  }
  ~Desk() { std::filesystem::current_path(before_); }
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;

  // Makes the input unless it is there. Whoever writes a new name into a document adds it here.
  void Provide(const std::string& name) {
    if (std::filesystem::exists(name)) return;
    const std::set<std::string> yard = {"frame.exr", "0001.exr", "0007.exr"};
    const std::set<std::string> summaries = {"part1.summary", "part2.summary", "shot.summary"};
    if (yard.count(name) > 0) {
      std::filesystem::copy_file(kYard, name);
    } else if (name == "scene.json") {
      std::filesystem::copy_file(has_walk_ ? shot_.LightsPath() : kYardLights, name);
    } else if (absl::EndsWith(name, ".glb")) {
      WriteFile(name, ColumnsGlb());
    } else if (name == "readbacks/walk") {
      std::filesystem::create_directory("readbacks");
      std::filesystem::copy(shot_.Path("walk"), name);
    } else if (name == "frames.txt") {
      WriteFile(name, absl::StrCat(shot_.FramePath(0), "\n", shot_.FramePath(1), "\n"));
    } else if (summaries.count(name) > 0) {
      Run({"summarize",
           shot_.FramePath(name == "part2.summary" ? 1 : 0),
           "--lights",
           shot_.LightsPath(),
           "-o",
           name});
    } else if (name == "engine.json") {
      Run({"fit", kYard, "--lights", kYardLights, "--map", "400x400", "--json", name});
    } else if (name == "plan.json") {
      Provide("sponza.glb");
      const std::string sun = "sun=sun:1,-3,0.5";
      Run({"render",
           "sponza.glb",
           "--camera",
           "3.5,1.7,-4.2:-9,2.2,-4.4:55",
           "--light",
           sun,
           "-o",
           "plan.exr"});
      Run({"fit",
           "plan.exr",
           "--light",
           sun,
           "--maps",
           "4",
           "--texels",
           "128x128",
           "--json",
           name});
    } else {
      ADD_FAILURE() << "no stand-in for the input " << name << ": add one to Desk::Provide()";
    }
  }

 private:
  static void Run(const std::vector<std::string>& arguments) {
    const ProcessResult result = RunLightfit(arguments);
    EXPECT_EQ(result.exit_code, 0) << absl::StrJoin(arguments, " ") << "\n" << result.err;
  }

  const std::filesystem::path before_;
  const bool has_walk_;
  const TemporaryFolder folder_;
  const BoxShot shot_;
};

bool IsFileName(const std::string& word) {
  for (const char* end : {".exr", ".json", ".glb", ".obj", ".ply", ".txt", ".summary"}) {
    if (absl::EndsWith(word, end)) return true;
  }
  return absl::StartsWith(word, "readbacks/");
}

// "*.summary", as a shell does.
std::vector<std::string> Matching(const std::string& pattern) {
  const std::string end = pattern.substr(1);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(".")) {
    if (absl::EndsWith(entry.path().filename().string(), end)) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  EXPECT_THAT(names, Not(IsEmpty())) << pattern;
  return names;
}

void RunAndCheck(const std::string& shown, Desk* desk) {
  const std::string command = Smaller(shown);
  SCOPED_TRACE("lightfit " + shown);
  std::vector<std::string> arguments, outputs;
  for (const std::string& word :
       std::vector<std::string>(absl::StrSplit(command, ' ', absl::SkipEmpty()))) {
    const bool is_output = !arguments.empty() && OutputFlags().count(arguments.back()) > 0;
    if (is_output) {
      outputs.push_back(word);
    } else if (absl::StartsWith(word, "*")) {
      for (const std::string& name : Matching(word)) arguments.push_back(name);
      continue;
    } else if (IsFileName(word)) {
      desk->Provide(word.substr(word.find('=') + 1));
    }
    arguments.push_back(word);
  }
  const ProcessResult result = RunLightfit(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const absl::string_view line : absl::StrSplit(result.err, '\n', absl::SkipEmpty())) {
    EXPECT_TRUE(absl::StartsWith(line, "progress: ")) << line;  // of a machine that is busy
  }
  EXPECT_THAT(result.out, Not(HasSubstr("no matrix")));
  for (const std::string& output : outputs) {
    ASSERT_TRUE(std::filesystem::exists(output)) << output;
    EXPECT_FALSE(std::filesystem::is_empty(output)) << output;
  }
}

class DocCommands : public ::testing::TestWithParam<CommandBlock> {};

TEST_P(DocCommands, RunAndWriteWhatTheyName) {
  Desk desk(GetParam());
  for (const std::string& command : GetParam().commands) {
    if (IsRun(command)) RunAndCheck(command, &desk);
  }
}

std::string NameOf(const ::testing::TestParamInfo<CommandBlock>& info) {
  std::string name = absl::StrCat(info.param.source, "_", info.param.line);
  for (char& letter : name) {
    if (!absl::ascii_isalnum(static_cast<unsigned char>(letter))) letter = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Shown, DocCommands, ::testing::ValuesIn(AllBlocks()), NameOf);

// That the extraction sees what it should: sources, verbs, commands over several lines.
TEST(DocBlocks, AreFoundInEverySource) {
  std::set<std::string> sources, verbs;
  int num_commands = 0;
  for (const CommandBlock& block : AllBlocks()) {
    sources.insert(block.source);
    for (const std::string& command : block.commands) {
      verbs.insert(command.substr(0, command.find(' ')));
      ++num_commands;
      EXPECT_THAT(command, Not(HasSubstr("\\")));
    }
  }
  for (const char* source : {"README.md", "docs/how-to.md", "docs/plans.md", "docs/service.md"}) {
    EXPECT_THAT(sources, Contains(source));
  }
  for (const char* verb :
       {"allocate", "compare", "fit", "render", "serve", "shot", "summarize", "tune"}) {
    EXPECT_THAT(sources, Contains(absl::StrCat("lightfit ", verb, " --help")));
    EXPECT_THAT(verbs, Contains(verb));
  }
  std::printf("%d commands in %zu sources\n", num_commands, sources.size());
  EXPECT_GE(num_commands, 45);
}

// Those of allocate keep their tolerance on every light of both read-backs that are shipped.
TEST(DocTolerances, AreKeptOnTheShippedReadbacks) {
  int num_kept = 0;
  for (const CommandBlock& block : AllBlocks()) {
    for (const std::string& command : block.commands) {
      if (!absl::StartsWith(command, "allocate ") || !absl::StrContains(command, "--tolerance") ||
          absl::StrContains(command, "--summary")) {
        continue;
      }
      for (const auto& [readback, lights] :
           {std::pair(kYard, kYardLights), std::pair(kRoom, kRoomLights)}) {
        SCOPED_TRACE(absl::StrCat("lightfit ", command, " of ", readback));
        const TemporaryFolder folder;
        std::vector<std::string> arguments;
        for (const absl::string_view word : absl::StrSplit(command, ' ', absl::SkipEmpty())) {
          arguments.push_back(absl::EndsWith(word, ".exr") ? readback
                              : word == "scene.json"       ? lights
                                                           : std::string(word));
        }
        if (std::find(arguments.begin(), arguments.end(), "--json") == arguments.end()) {
          arguments.insert(arguments.end(), {"--json", folder.Path("maps.json")});
        }
        const ProcessResult result = RunLightfit(arguments);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        const v1::Allocation allocation = ReadAllocation(folder.Path("maps.json"));
        EXPECT_GT(allocation.maps_size(), 0);
        for (const v1::AllocatedMap& map : allocation.maps()) {
          EXPECT_TRUE(map.reached().is_met()) << map.name();
          EXPECT_LE(map.reached().reached_px(), allocation.tolerance().limit_px()) << map.name();
          ++num_kept;
        }
      }
    }
  }
  EXPECT_GE(num_kept, 8);
}

}  // namespace
}  // namespace lightfit
