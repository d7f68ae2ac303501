// cli/command_line/man_page.h
//
// The manual, from the declarations of the verbs: lightfit(1), and lightfit-fit(1) and so on.
// In:   the program with its verbs.
// Out:  pages for man.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

// Of a verb, or "" for the program. InvalidArgument where there is no such verb.
absl::StatusOr<std::string> ManPage(const CLI::App& app, const std::string& verb);

// All pages, lightfit.1 and lightfit-VERB.1, into a folder that is there.
absl::Status WriteManPages(const CLI::App& app, const std::string& folder);

}  // namespace lightfit::cli
