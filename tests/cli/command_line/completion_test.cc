// Completion and the manual: what shells and man make of what the program prints.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/command_line/command_line.h"
#include "cli/command_line/declared.h"
#include "cli/command_line/file_kinds.h"
#include "cli/flags/choices.h"
#include "tests/cli/command_line/shell.h"

namespace lightfit {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::UnorderedElementsAre;
using ::testing::UnorderedElementsAreArray;

bool HasProgram(const char* name) {
  return RunInstalled("sh", {"-c", std::string("command -v ") + name}).exit_code == 0;
}

// What bash completes the last of the words to, in this folder.
std::vector<std::string> Completed(const std::string& folder,
                                   const std::vector<std::string>& words) {
  std::vector<std::string> quoted;
  for (const std::string& word : words) quoted.push_back("'" + word + "'");
  const ProcessResult result =
      RunShell(absl::StrCat("cd '",
                            folder,
                            "'\nsource <(\"$lightfit\" completion bash)\n",
                            "COMP_WORDS=(lightfit ",
                            absl::StrJoin(quoted, " "),
                            ")\nCOMP_CWORD=",
                            words.size(),
                            "\n_lightfit\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n",
                            // Registered for the program's name.
                            "complete -p lightfit > /dev/null || echo none\n"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  return absl::StrSplit(result.out, '\n', absl::SkipEmpty());
}

class Bash : public ::testing::Test {
 protected:
  Bash() {
    std::filesystem::create_directory(folder_.Path("walk"));
    for (const char* name : {"a.exr",
                             "B.EXR",
                             "lights.json",
                             "all.summary",
                             "room.glb",
                             "two words.json",
                             "list.txt"}) {
      WriteFile(folder_.Path(name), "");
    }
  }
  std::vector<std::string> After(const std::vector<std::string>& words) const {
    return Completed(folder_.Path(""), words);
  }
  TemporaryFolder folder_;
};

TEST_F(Bash, CompletesVerbs) {
  EXPECT_THAT(After({"fi"}), ElementsAre("fit"));
  EXPECT_THAT(After({"s"}), ElementsAre("serve", "shot", "summarize"));
  EXPECT_THAT(After({"help", "ren"}), ElementsAre("render"));
  EXPECT_THAT(After({""}), IsSupersetOf({"fit", "shot", "compare", "help"}));
  EXPECT_THAT(After({""}), Not(Contains("completion")));
}

// Each option of each verb, all of them and no other.
TEST_F(Bash, CompletesEveryOption) {
  const cli::CommandLine line = cli::MakeCommandLine();
  int num_options = 0;
  for (const CLI::App* verb : cli::DeclaredVerbs(*line.app)) {
    std::set<std::string> wanted;
    for (const CLI::Option* option : cli::DeclaredOptions(*verb)) {
      for (const std::string& name : cli::NamesOf(*option)) wanted.insert(name);
    }
    num_options += static_cast<int>(wanted.size());
    EXPECT_THAT(After({verb->get_name(), "-"}), UnorderedElementsAreArray(wanted))
        << verb->get_name();
  }
  EXPECT_GE(num_options, 200);
  EXPECT_THAT(After({"fit", "a.exr", "--depth-c"}), ElementsAre("--depth-channel"));
}

TEST_F(Bash, CompletesChoices) {
  const std::vector<std::string> clips = cli::WordsOnly(cli::ClipWords());
  EXPECT_THAT(After({"fit", "--clip", ""}), UnorderedElementsAreArray(clips));
  EXPECT_THAT(After({"fit", "a.exr", "--clip", "op"}), ElementsAre("opengl"));
  // bash makes three words of --clip=op.
  EXPECT_THAT(After({"fit", "--clip", "=", "op"}), ElementsAre("opengl"));
  EXPECT_THAT(After({"fit", "--clip", "="}), UnorderedElementsAreArray(clips));
  EXPECT_THAT(After({"tune", "--bias", "p"}), ElementsAre("practical"));
  EXPECT_THAT(After({"serve", "--log-level", "w"}), ElementsAre("warning"));
  EXPECT_THAT(After({"fit", "--margin-percent", ""}), IsEmpty());
}

TEST_F(Bash, CompletesFilesOfTheKindThatIsWanted) {
  EXPECT_THAT(After({"fit", ""}), UnorderedElementsAre("walk", "a.exr", "B.EXR"));
  EXPECT_THAT(After({"fit", "--json", "two"}), ElementsAre("two words.json"));
  EXPECT_THAT(After({"fit", "--json", ""}),
              UnorderedElementsAre("walk", "lights.json", "two words.json"));
  EXPECT_THAT(After({"compare", "--matrix", "mine", "=", "l"}), ElementsAre("lights.json"));
  EXPECT_THAT(After({"render", ""}), UnorderedElementsAre("walk", "room.glb"));
  EXPECT_THAT(After({"shot", "li"}), UnorderedElementsAre("list.txt", "lights.json"));
  EXPECT_THAT(After({"shot", "-o", ""}), ElementsAre("walk"));
  EXPECT_THAT(After({"summarize", "-o", "a"}), ElementsAre("all.summary"));
}

TEST(Completion, IsWhatShellsCanRead) {
  EXPECT_EQ(RunShell("bash -n <(\"$lightfit\" completion bash)").exit_code, 0);
  for (const char* shell : {"zsh", "fish"}) {
    const ProcessResult script = RunLightfit({"completion", shell});
    EXPECT_EQ(script.exit_code, 0);
    for (const char* word : {"summarize", "depth-channel", "direct3d"}) {
      EXPECT_THAT(script.out, HasSubstr(word));
    }
    if (!HasProgram(shell)) continue;
    const ProcessResult read =
        RunShell(absl::StrCat(shell, " -n <(\"$lightfit\" completion ", shell, ")"));
    EXPECT_EQ(read.exit_code, 0) << read.err;
    EXPECT_THAT(read.err, IsEmpty());
  }
  const ProcessResult wrong = RunLightfit({"completion", "zhs"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean \"zsh\"?"));
}

TEST(Manual, HasAPageForEachVerbWithAllItsOptions) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunLightfit({"man", "--folder", folder.Path("")}).exit_code, 0);
  const cli::CommandLine line = cli::MakeCommandLine();
  std::vector<std::string> files = {"lightfit.1"};
  for (const CLI::App* verb : cli::DeclaredVerbs(*line.app)) {
    files.push_back("lightfit-" + verb->get_name() + ".1");
    const std::string page = ReadFile(folder.Path(files.back()));
    EXPECT_EQ(RunLightfit({"man", verb->get_name()}).out, page);
    for (const CLI::Option* option : cli::DeclaredOptions(*verb)) {
      std::string name = cli::NamesOf(*option).back();
      for (size_t at = 0; (at = name.find('-', at)) != std::string::npos; at += 2) {
        name.insert(at, "\\");
      }
      EXPECT_THAT(page, HasSubstr("\\fB" + name + "\\fR")) << verb->get_name();
    }
  }
  EXPECT_THAT(folder.Files(), UnorderedElementsAreArray(files));
  EXPECT_EQ(RunLightfit({"man"}).out, ReadFile(folder.Path("lightfit.1")));
  EXPECT_THAT(RunLightfit({"man", "fti"}).err, HasSubstr("did you mean \"fit\"?"));
}

TEST(Manual, HasNoFaultThatGroffFinds) {
  if (!HasProgram("groff")) GTEST_SKIP() << "groff is not installed";
  for (const char* verb :
       {"", "fit", "shot", "compare", "render", "summarize", "allocate", "tune", "serve"}) {
    const ProcessResult result =
        RunShell(absl::StrCat("\"$lightfit\" man ", verb, " | groff -man -Tutf8 -ww -b -z"));
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.err, IsEmpty()) << verb;
    if (!HasProgram("mandoc")) continue;
    const ProcessResult lint =
        RunShell(absl::StrCat("\"$lightfit\" man ", verb, " | mandoc -Tlint -Wwarning"));
    EXPECT_THAT(lint.out, IsEmpty()) << verb;
  }
}

}  // namespace
}  // namespace lightfit
