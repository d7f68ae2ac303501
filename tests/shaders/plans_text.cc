#include "tests/shaders/plans_text.h"

#include <gtest/gtest.h>

#include <sstream>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "tests/testing/process.h"

namespace lightfit::testing {

namespace {

constexpr int kNotInstalled = 126;

std::vector<std::string> BlocksOf(const std::string& language) {
  std::vector<std::string> blocks;
  for (const std::string& block : PlansBlocks()) {
    if (absl::StartsWith(block, "// " + language)) blocks.push_back(block);
  }
  EXPECT_FALSE(blocks.empty()) << "docs/plans.md has no block that opens with // " << language;
  return blocks;
}

}  // namespace

std::vector<std::string> PlansBlocks() {
  std::istringstream page(ReadFile(RepositoryPath("docs/plans.md")));
  std::vector<std::string> blocks;
  bool is_inside = false;
  std::string line, between;  // `between`: empty lines that may turn out to be a block's own
  while (std::getline(page, line)) {
    if (line.empty()) {
      between += '\n';
      continue;
    }
    const bool is_code = absl::StartsWith(line, "    ");
    // Blocks of code stand next to each other where a new one opens with its language.
    const bool opens =
        absl::StartsWith(line, "    // GLSL") || absl::StartsWith(line, "    // HLSL");
    if (is_code && (!is_inside || opens)) {
      blocks.emplace_back();
    } else if (is_code) {
      blocks.back() += between;
    }
    if (is_code) absl::StrAppend(&blocks.back(), line.substr(4), "\n");
    is_inside = is_code;
    between.clear();
  }
  return blocks;
}

std::string PlansText(const std::string& language) {
  std::string text;
  for (const std::string& block : BlocksOf(language)) text += block;
  return text;
}

std::string PlansLookUp(const std::string& language) {
  const std::vector<std::string> blocks = BlocksOf(language);
  return blocks.empty() ? "" : blocks.front();
}

ShaderFile CompileShader(const std::string& text,
                         const std::string& stage,
                         const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("shader." + stage), spirv_path = folder.Path("shader.spv");
  WriteFile(path, text);
  std::vector<std::string> all = arguments;
  all.insert(all.end(), {"-S", stage, path});
  bool is_binary = false;
  for (const std::string& argument : arguments) is_binary = is_binary || argument == "-V";
  if (is_binary) all.insert(all.end(), {"-o", spirv_path});
  const ProcessResult result = RunInstalled("glslangValidator", all);
  EXPECT_NE(result.exit_code, kNotInstalled)
      << "glslangValidator is not installed: packages-test.txt, glslang-tools";
  return {result.exit_code == 0,
          absl::StrCat(result.out, result.err),
          is_binary ? ReadFile(spirv_path) : std::string()};
}

ShaderFile CompileHlsl(const std::string& text, const std::string& stage) {
  return CompileShader(
      text, stage, {"-D", "-V", "-e", "main", "--hlsl-offsets", "--auto-map-bindings", "-l", "-q"});
}

}  // namespace lightfit::testing
