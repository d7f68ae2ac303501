#include "cli/exit_code.h"

#include <cstdio>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "cli/command_line/option_words.h"
#include "cli/flags/standard_streams.h"

namespace lightfit::cli {
namespace {

// The library knows fields of its own, and no command line.
std::string InWords(absl::string_view message) { return WithStreamNames(InOptionWords(message)); }

}  // namespace

void PrintError(absl::string_view message) {
  std::fprintf(stderr, "lightfit: error: %s\n", InWords(message).c_str());
}

void PrintWarning(absl::string_view message) {
  std::fprintf(stderr, "lightfit: warning: %s\n", InWords(message).c_str());
}

void PrintWarnings(const std::vector<std::string>& messages) {
  for (const std::string& message : messages) PrintWarning(message);
}

int Fail(ExitCode code, const absl::Status& status) {
  PrintError(status.message());
  return code;
}

ExitCode CodeFor(int num_failed, int num_all) {
  if (num_failed == 0) return kExitOk;
  return num_failed < num_all ? kExitIncomplete : kExitBadInput;
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
