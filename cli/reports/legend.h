// cli/reports/legend.h
//
// What stands below a table: what its columns mean where that was asked for, else where to find it.
// In:   the verb, what the columns mean.
// Out:  lines of text.
#pragma once

#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"

namespace lightfit::cli {

// An empty line, then the legend or one line instead of it.
inline std::string LegendOrHint(absl::string_view verb, bool has_legend, absl::string_view legend) {
  return has_legend ? absl::StrCat("\n", legend)
                    : absl::StrCat("\nColumns: lightfit ", verb, " --help, or --legend here.\n");
}

// For the end of a verb's --help.
inline std::string LegendHelp(absl::string_view legend) {
  return absl::StrCat("\n\nColumns (--legend):\n", absl::StripSuffix(legend, "\n"));
}

}  // namespace lightfit::cli
