// Every command that documents and --help show runs as it stands there, on read-backs that are
// shipped and scenes that are made here (doc_desk.h), and writes the files that it names.

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
#include "tests/cli/command_line/shell.h"
#include "tests/cli/doc_desk.h"
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

// "render ... -o - | lightfit fit - ... | jq ...", but for the programs of others at its end.
ProcessResult RunPipeline(const std::string& command, Desk* desk) {
  std::vector<std::string> stages;
  for (const std::string& stage :
       std::vector<std::string>(absl::StrSplit("lightfit " + command, " | "))) {
    if (!absl::StartsWith(stage, "lightfit ")) break;
    stages.push_back("$" + stage);
    for (const std::string& word : std::vector<std::string>(absl::StrSplit(stage, ' '))) {
      if (IsFileName(word)) desk->Provide(word.substr(word.find('=') + 1));
    }
  }
  EXPECT_GT(stages.size(), 1);
  return RunShell("set -o pipefail\n" + absl::StrJoin(stages, " | "));
}

void RunAndCheck(const std::string& shown, Desk* desk) {
  if (absl::StrContains(shown, " | ")) {
    const ProcessResult result = RunPipeline(Smaller(shown), desk);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(absl::StartsWith(result.out, "{")) << result.out;
    return;
  }
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
