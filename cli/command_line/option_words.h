// cli/command_line/option_words.h
//
// What the library says of its own fields, in the words of the command line: options.margin_percent
// is --margin-percent there.
// In:   a message of the library; the verb that runs, whose declared options say which fields have
//       a flag.
// Out:  the message with options in place of fields.
#pragma once

#include <string>

#include "absl/strings/string_view.h"

namespace CLI {
class App;
}

namespace lightfit::cli {

// From here on messages name the options of `verb`, which must outlive them.
void NameOptionsOf(const CLI::App& verb);

// What stands in quotes and what is part of a path stays as it is.
std::string InOptionWords(absl::string_view message);

}  // namespace lightfit::cli
