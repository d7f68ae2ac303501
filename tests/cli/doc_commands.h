// tests/cli/doc_commands.h
//
// The commands of this program that documents and --help show, as they stand there.
// In:   README.md, docs/*.md, the README.md of folders; the help of every verb.
// Out:  blocks of commands that follow one another, as words.
#pragma once

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "tests/testing/process.h"

namespace lightfit {

// Lines without an empty one or text in between: run in one folder, one after the other.
struct CommandBlock {
  std::string source;                 // "docs/how-to.md", "lightfit fit --help"
  int line = 0;                       // of the first
  std::vector<std::string> commands;  // "fit frame.exr --lights scene.json ..."
};

// "  $ lightfit fit a.exr   # a comment" -> "fit a.exr"; nothing for other lines.
inline std::string CommandIn(absl::string_view line, bool is_fenced) {
  if (!is_fenced && !absl::StartsWith(line, "  ")) return "";  // text, not code
  absl::string_view text = absl::StripAsciiWhitespace(line);
  absl::ConsumePrefix(&text, "$ ");
  absl::ConsumePrefix(&text, "build/release/bin/");
  if (!absl::ConsumePrefix(&text, "lightfit ")) return "";
  const size_t comment = text.find(" #");
  return std::string(absl::StripAsciiWhitespace(text.substr(0, comment)));
}

// gtest would print bytes.
inline void PrintTo(const CommandBlock& block, std::ostream* out) {
  *out << block.source << ":" << block.line;
}

inline std::vector<CommandBlock> BlocksOf(const std::string& source, const std::string& text) {
  std::vector<CommandBlock> blocks;
  bool is_fenced = false;
  bool goes_on = false;   // the block
  bool is_split = false;  // the command, over lines
  int number = 0;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    ++number;
    if (absl::StartsWith(line, "```")) is_fenced = !is_fenced;
    std::string command =
        is_split ? std::string(absl::StripAsciiWhitespace(line)) : CommandIn(line, is_fenced);
    if (command.empty()) {
      goes_on = false;
      continue;
    }
    const bool was_split = is_split;
    is_split = absl::EndsWith(command, "\\") || absl::EndsWith(command, "|");
    if (is_split)
      command = std::string(absl::StripAsciiWhitespace(absl::StripSuffix(command, "\\")));
    if (!goes_on) blocks.push_back({source, number, {}});
    goes_on = true;
    if (was_split) {
      absl::StrAppend(&blocks.back().commands.back(), " ", command);
    } else {
      blocks.back().commands.push_back(command);
    }
  }
  return blocks;
}

// The verbs that `lightfit --help` lists.
inline std::vector<std::string> Verbs() {
  std::vector<std::string> verbs;
  bool is_list = false;
  for (const absl::string_view line : absl::StrSplit(RunLightfit({"--help"}).out, '\n')) {
    if (is_list && !absl::StartsWith(line, "  ")) is_list = false;
    if (is_list && !absl::StartsWith(line, "   ")) {
      verbs.emplace_back(*absl::StrSplit(absl::StripAsciiWhitespace(line), ' ').begin());
    }
    if (absl::StartsWith(line, "Subcommands:")) is_list = true;
  }
  return verbs;
}

inline std::vector<CommandBlock> AllBlocks() {
  const std::filesystem::path root = RepositoryPath("");
  std::vector<std::filesystem::path> files = {root / "README.md", root / "CONTRIBUTING.md"};
  for (const auto& entry : std::filesystem::directory_iterator(root / "docs")) {
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  }
  for (const auto& folder : std::filesystem::directory_iterator(root)) {
    const std::string name = folder.path().filename().string();
    if (!folder.is_directory() || name == "build" || name == "out" || name.front() == '.') continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.path().filename() == "README.md") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  std::vector<CommandBlock> blocks;
  for (const std::filesystem::path& file : files) {
    const std::string source = std::filesystem::relative(file, root).string();
    for (CommandBlock& block : BlocksOf(source, ReadFile(file.string()))) {
      blocks.push_back(std::move(block));
    }
  }
  for (const std::string& verb : Verbs()) {
    for (CommandBlock& block :
         BlocksOf(absl::StrCat("lightfit ", verb, " --help"), RunLightfit({verb, "--help"}).out)) {
      blocks.push_back(std::move(block));
    }
  }
  return blocks;
}

}  // namespace lightfit
