// base/verbose.h
//
// What a verb says on stderr of its work where it is asked to, with -v: what it reads, what it
// searches, how long each step takes. Silent otherwise.
#pragma once

#include "absl/strings/string_view.h"

namespace lightfit {

// Of the whole program.
void SetVerbose(bool verbose);
bool IsVerbose();

// "lightfit: TEXT" on stderr, a line, where that is wanted.
void Say(absl::string_view text);

}  // namespace lightfit
