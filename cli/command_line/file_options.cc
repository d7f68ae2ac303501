#include "cli/command_line/file_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "cli/command_line/file_kinds.h"
#include "cli/command_line/standard_streams.h"

namespace lightfit::cli {
namespace {

constexpr char kDash[] = "-";

// "--json": as messages call an option; a positional in the words of the help.
std::string NameOf(const CLI::Option& option) {
  return option.get_positional() ? option.get_type_name() : option.get_name();
}

// "; --picture FILE.png writes a PNG picture", where another option of the verb writes that.
std::string OtherOutputText(const CLI::App& verb, const std::string& extension) {
  for (const CLI::Option* option : verb.get_options()) {
    const OptionKind kind = KindOf(*option);
    if (!kind.is_output || kind.extensions != std::vector<std::string>{extension}) continue;
    return absl::StrCat(
        "; ", option->get_name(), " FILE", extension, " writes ", ContentOf(extension));
  }
  return "";
}

// What is wrong with the path of an output, "" for nothing.
std::string CheckExtension(const CLI::App& verb, const OptionKind& kind, const std::string& path) {
  const std::string extension =
      absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  if (extension.empty() || kind.extensions.empty() ||
      std::find(kind.extensions.begin(), kind.extensions.end(), extension) !=
          kind.extensions.end()) {
    return "";
  }
  return absl::StrCat(path,
                      ": this option writes ",
                      ContentOf(kind.extensions.front()),
                      ", want a name that ends in ",
                      absl::StrJoin(kind.extensions, " or "),
                      OtherOutputText(verb, extension));
}

// The value with the path for `-` in place of it, or what is wrong with it.
std::string Prepare(const CLI::App& verb,
                    const CLI::Option& option,
                    const OptionKind& kind,
                    std::string* value) {
  const size_t name_end = kind.has_name ? value->find('=') + 1 : 0;
  const std::string path = value->substr(name_end);
  if (path != kDash) return kind.is_output ? CheckExtension(verb, kind, path) : "";
  if (kind.is_output && (kind.extensions.empty() || kind.has_folder)) {
    return absl::StrCat("cannot go to standard output, want the name of a ",
                        kind.has_folder ? "folder" : "file");
  }
  const absl::StatusOr<std::string> stream =
      kind.is_output ? TakeStandardOutput(NameOf(option), kind.extensions.front())
                     : TakeStandardInput(NameOf(option), kind.has_list);
  if (!stream.ok()) return std::string(stream.status().message());
  *value = absl::StrCat(value->substr(0, name_end), *stream);
  return "";
}

}  // namespace

void PrepareFileOptions(CLI::App* verb) {
  for (CLI::Option* option : verb->get_options()) {
    const OptionKind kind = KindOf(*option);
    if (!kind.has_file && !kind.has_folder) continue;
    // Before the other checks: whether a file is there, say.
    option->transform(CLI::Validator(
        [verb, option, kind](std::string& value) { return Prepare(*verb, *option, kind, &value); },
        ""));
  }
}

}  // namespace lightfit::cli
