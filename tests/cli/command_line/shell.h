// tests/cli/command_line/shell.h
//
// Command lines as people type them, pipes and all.
#pragma once

#include <filesystem>
#include <string>

#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {

// bin/lightfit of this build, beside tests/bin.
inline std::string LightfitPath() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  return (program.parent_path().parent_path().parent_path() / "bin" / "lightfit").string();
}

// Runs a script in bash, in which $lightfit is the program, $yard a read-back and $lights its
// lights.
inline ProcessResult RunShell(const std::string& script) {
  return RunInstalled(
      "bash",
      {"-c", "lightfit=$0 yard=$1 lights=$2\n" + script, LightfitPath(), kYard, kYardLights});
}

}  // namespace lightfit
