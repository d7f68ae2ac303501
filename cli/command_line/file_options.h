// cli/command_line/file_options.h
//
// What holds of every option that takes a file, whichever verb declares it: `-` is standard input
// or output, and the extension of an output is obeyed or refused.
// In:   a verb with its options declared.
// Out:  the same options, which look at their values so.
#pragma once

namespace CLI {
class App;
}

namespace lightfit::cli {

void PrepareFileOptions(CLI::App* verb);

}  // namespace lightfit::cli
