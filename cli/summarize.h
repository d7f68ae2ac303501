// cli/summarize.h
//
// `lightfit summarize READBACK.exr -o FRAME.summary`: what read-backs have to say about their
// lights, in a kilobyte per light; and sums of such files. The other half is `lightfit fit
// --summary`.
#pragma once

#include "cli/flags/summarize_flags.h"
#include "cli/verb.h"

namespace lightfit::cli {

std::function<int()> DeclareSummarize(CLI::App* app);

// Does what `flags` ask for and returns an ExitCode. The file is written when at least one input
// could be used.
int RunSummarize(const SummarizeFlags& flags);

}  // namespace lightfit::cli
