#include "cli/command_line/file_kinds.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace lightfit::cli {
namespace {

constexpr char kOutputGroup[] = "Output";

struct Content {
  const char* extension;
  const char* words;
};
constexpr Content kContents[] = {{".json", "JSON"},
                                 {".csv", "a table of commas"},
                                 {".png", "a PNG picture"},
                                 {".exr", "an OpenEXR image"},
                                 {".summary", "a summary"}};

// A word of the command line such as "reversed-z", as against what stands for one: "TEXELS".
bool IsChoice(absl::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return absl::ascii_islower(c) || absl::ascii_isdigit(c) || c == '-';
  });
}

void AddAlternative(absl::string_view text, OptionKind* kind) {
  if (absl::ConsumePrefix(&text, "NAME=")) kind->has_name = true;
  const absl::string_view word = text.substr(0, text.find_first_of(".:"));
  if (word == "FOLDER" || word == "DIR") {
    kind->has_folder = true;
  } else if (word == "LIST") {
    kind->has_list = true;
    kind->has_file = true;
  } else if (word == "SCENE") {
    kind->has_file = true;
    for (const char* extension : {".glb", ".gltf", ".obj", ".ply"}) {
      kind->extensions.emplace_back(extension);
    }
  } else if (word == "FILE" || word == "READBACK" || word == "RESULT") {
    kind->has_file = true;
    text.remove_prefix(word.size());
    if (!text.empty() && text.front() == '.') {
      kind->extensions.emplace_back(text.substr(0, text.find(':')));
    }
  }
}

}  // namespace

OptionKind KindOf(const CLI::Option& option) {
  OptionKind kind;
  kind.is_flag = option.get_items_expected_max() == 0;
  kind.is_output = option.get_group() == kOutputGroup;
  if (kind.is_flag) return kind;
  const std::string type = option.get_type_name();
  const std::vector<std::string> alternatives = absl::StrSplit(type, '|');
  if (alternatives.size() > 1 && std::all_of(alternatives.begin(), alternatives.end(), IsChoice)) {
    kind.choices = alternatives;
    return kind;
  }
  for (const std::string& alternative : alternatives) AddAlternative(alternative, &kind);
  return kind;
}

std::string ContentOf(const std::string& extension) {
  for (const Content& content : kContents) {
    if (extension == content.extension) return content.words;
  }
  return extension;
}

}  // namespace lightfit::cli
