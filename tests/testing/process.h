// tests/testing/process.h
//
// Runs a real program, of this build or installed, and catches what it says; files and folders for
// tests.
#pragma once

#include <string>
#include <vector>

namespace lightfit {

struct ProcessResult {
  int exit_code = -1;  // 128 + signal when it was killed
  std::string out;     // stdout
  std::string err;     // stderr
};

// Runs bin/NAME of the build with these arguments, without a shell, and waits for its end. It must
// have been built: lightfit_tests(... PROGRAMS NAME).
ProcessResult RunProgram(const std::string& name, const std::vector<std::string>& arguments);

// The same for a program that is installed, found as a shell does. Exit code 126: there is none.
ProcessResult RunInstalled(const std::string& name, const std::vector<std::string>& arguments);

// The same for bin/lightfit.
ProcessResult RunLightfit(const std::vector<std::string>& arguments);

// A folder of its own for one test, removed with everything in it when the object goes.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string Path(const std::string& name) const { return path_ + "/" + name; }

  // Names of the files in it, sorted.
  std::vector<std::string> Files() const;

 private:
  std::string path_;
};

std::string ReadFile(const std::string& path);
void WriteFile(const std::string& path, const std::string& text);

// "examples/yard_180/0001.exr" and so on, from the repository's root.
std::string RepositoryPath(const std::string& path);

}  // namespace lightfit
