// tests/cli/process.h
//
// Runs the real `lightfit` program and catches what it says.
#pragma once

#include <string>
#include <vector>

namespace lightfit {

struct ProcessResult {
  int exit_code = -1;  // 128 + signal when it was killed
  std::string out;     // stdout
  std::string err;     // stderr
};

// Runs the program under test with these arguments, without a shell, and waits for its end.
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
