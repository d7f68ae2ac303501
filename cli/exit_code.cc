#include "cli/exit_code.h"

#include <cstdio>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace lightfit::cli {
namespace {

// The library knows options of its own and no command line.
std::string WithFlags(absl::string_view message) {
  return absl::StrReplaceAll(message,
                             {{"options.search = kFocused", "--search focused"},
                              {"options.cover = kReceivers", "--cover receivers"},
                              {"options.metric = kL2", "--metric l2"},
                              {"options.max_maps = ", "--maps "},
                              {"options.texels = ", "--texels "},
                              {"options.guard_texels = ", "--guard "},
                              {": the guard of ", ": the --guard of "},
                              {"options.each = ", "--map "},
                              {"options.sizes.multiple = ", "--multiple "},
                              {"options.sizes.min_side, max_side = ", "--min-side, --max-side "},
                              {"options.sizes.min_side = ", "--min-side "},
                              {"options.sizes: no ", "no "},
                              {"rules.multiple = ", "--multiple "},
                              {"rules.min_side, max_side = ", "--min-side, --max-side "},
                              {"rules.min_side = ", "--min-side "},
                              {"rules: no ", "no "},
                              {" min_side ... max_side = ", " --min-side ... --max-side "},
                              {"1 <= min_side <= max_side ", "1 <= --min-side <= --max-side "}});
}

}  // namespace

void PrintError(absl::string_view message) {
  std::fprintf(stderr, "lightfit: error: %s\n", WithFlags(message).c_str());
}

void PrintWarning(absl::string_view message) {
  std::fprintf(stderr, "lightfit: warning: %s\n", WithFlags(message).c_str());
}

void PrintWarnings(const std::vector<std::string>& messages) {
  for (const std::string& message : messages) PrintWarning(message);
}

int Fail(ExitCode code, const absl::Status& status) {
  PrintError(status.message());
  return code;
}

void PrintFailedLight(absl::string_view what,
                      absl::string_view light_name,
                      const absl::Status& status) {
  std::string message(status.message());
  const std::string name = absl::StrCat("light \"", light_name, "\"");
  if (!absl::StrContains(message, name)) message = absl::StrCat(name, ": ", message);
  PrintError(absl::StrCat("no ", what, " for ", message));
}

}  // namespace lightfit::cli
