#include "tests/testing/process.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace lightfit {
namespace {

// Redirects to files rather than pipes: nothing can block, however much is written.
void Exec(const std::string& program,
          const std::vector<std::string>& arguments,
          const std::string& out_path,
          const std::string& err_path) {
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  if (std::freopen(out_path.c_str(), "w", stdout) != nullptr &&
      std::freopen(err_path.c_str(), "w", stderr) != nullptr) {
    execvp(program.c_str(), argv.data());
  }
  _exit(126);
}

ProcessResult Run(const std::string& program, const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const std::string out_path = folder.Path("out"), err_path = folder.Path("err");
  ProcessResult result;
  std::fflush(nullptr);  // or what is not written yet would be written twice
  const pid_t child = fork();
  if (child < 0) {
    ADD_FAILURE() << "cannot fork";
    return result;
  }
  if (child == 0) Exec(program, arguments, out_path, err_path);
  int status = 0;
  if (waitpid(child, &status, 0) != child) {
    ADD_FAILURE() << "cannot wait for " << program;
    return result;
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = ReadFile(out_path);
  result.err = ReadFile(err_path);
  return result;
}

}  // namespace

ProcessResult RunProgram(const std::string& name, const std::vector<std::string>& arguments) {
  return Run(std::string(LIGHTFIT_BIN_DIR) + "/" + name, arguments);
}

ProcessResult RunInstalled(const std::string& name, const std::vector<std::string>& arguments) {
  return Run(name, arguments);
}

ProcessResult RunLightfit(const std::vector<std::string>& arguments) {
  return RunProgram("lightfit", arguments);
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "lightfit-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    ADD_FAILURE() << "cannot create the folder " << name;
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

std::vector<std::string> TemporaryFolder::Files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void WriteFile(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string RepositoryPath(const std::string& path) {
  return std::string(LIGHTFIT_REPOSITORY) + "/" + path;
}

}  // namespace lightfit
