// cli/main.cc
//
// `lightfit`: hands the command line over, and turns what is thrown beneath into an exit code.

#include <exception>
#include <string>
#include <vector>

#include "cli/command_line/command_line.h"
#include "cli/exit_code.h"

int main(int argc, char** argv) {
  // The library throws nothing; a library beneath it might, out of memory for one.
  try {
    return lightfit::cli::RunCommandLine(
        std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc));
  } catch (const std::exception& error) {
    lightfit::cli::PrintError(error.what());
    return lightfit::cli::kExitBadInput;
  }
}
