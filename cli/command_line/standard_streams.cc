#include "cli/command_line/standard_streams.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "base/text_file.h"

namespace lightfit::cli {
namespace {

struct Taken {
  std::string flag, path;  // empty: not taken
};
struct State {
  std::string folder;
  Taken input, output;
};

// Not destroyed: whatever runs at the end of the program may still ask for names.
State& TheState() {
  static auto& state = *new State;
  return state;
}

std::string ErrnoText() { return std::error_code(errno, std::generic_category()).message(); }

absl::Status MakeFolder() {
  State& state = TheState();
  if (!state.folder.empty()) return absl::OkStatus();
  std::error_code error;
  std::string name = (std::filesystem::temp_directory_path(error) / "lightfit-XXXXXX").string();
  if (error || mkdtemp(name.data()) == nullptr) {
    return absl::PermissionDeniedError(absl::StrCat("-: no folder can be made for it in ",
                                                    name,
                                                    ": ",
                                                    ErrnoText(),
                                                    "; want a TMPDIR to write "
                                                    "to, or a file"));
  }
  state.folder = name;
  return absl::OkStatus();
}

absl::Status CheckNotTaken(const std::string& flag, const Taken& taken, const char* what) {
  if (taken.flag.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(flag, " -: ", what, " is that of ", taken.flag, " already; want a file"));
}

// By the first bytes, as names of files say it.
std::string ExtensionOf(absl::string_view start) {
  if (absl::StartsWith(start, "v/1\x01")) return ".exr";
  if (absl::StartsWith(start, "glTF")) return ".glb";
  if (absl::StartsWith(start, "ply")) return ".ply";
  const absl::string_view text = absl::StripLeadingAsciiWhitespace(start);
  return absl::StartsWith(text, "{") || absl::StartsWith(text, "[") ? ".json" : "";
}

// Copies a descriptor to a file; a short read is not the end of a pipe.
bool Copy(int from, int to) {
  std::array<char, 1 << 16> piece;
  while (true) {
    const ssize_t size = read(from, piece.data(), piece.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return size == 0;
    for (ssize_t done = 0; done < size;) {
      const ssize_t written = write(to, piece.data() + done, static_cast<size_t>(size - done));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) return false;
      done += written;
    }
  }
}

class OpenFile {
 public:
  OpenFile(const std::string& path, const char* mode) : file_(std::fopen(path.c_str(), mode)) {}
  ~OpenFile() { Close(); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  bool is_open() const { return file_ != nullptr; }
  int descriptor() const { return fileno(file_); }
  bool Close() {
    const bool good = file_ == nullptr || std::fclose(file_) == 0;
    file_ = nullptr;
    return good;
  }

 private:
  std::FILE* file_;
};

std::string WithAbsolutePaths(const std::string& list) {
  std::istringstream lines(list);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    absl::StripAsciiWhitespace(&line);
    if (line.empty() || line.front() == '#') continue;
    std::error_code error;
    absl::StrAppend(&result, std::filesystem::absolute(line, error).string(), "\n");
  }
  return result;
}

}  // namespace

absl::StatusOr<std::string> TakeStandardInput(const std::string& flag, bool is_list) {
  State& state = TheState();
  if (absl::Status s = CheckNotTaken(flag, state.input, "standard input"); !s.ok()) return s;
  if (isatty(STDIN_FILENO) == 1) {
    return absl::InvalidArgumentError(
        absl::StrCat(flag, " -: standard input is a terminal; want a pipe or a file"));
  }
  if (absl::Status s = MakeFolder(); !s.ok()) return s;
  const std::string spool = absl::StrCat(state.folder, "/standard input");
  OpenFile file(spool, "wb");
  if (!file.is_open() || !Copy(STDIN_FILENO, file.descriptor()) || !file.Close()) {
    return absl::DataLossError(
        absl::StrCat(flag, " -: standard input cannot be read to its end: ", ErrnoText()));
  }
  char start[64] = {};
  std::ifstream(spool, std::ios::binary).read(start, sizeof(start));
  std::string extension = ExtensionOf(absl::string_view(start, sizeof(start)));
  if (is_list && extension.empty()) {
    extension = ".txt";
    const absl::StatusOr<std::string> list = ReadTextFile(spool);
    if (!list.ok()) return list.status();
    absl::Status status = WriteTextFileAtomically(spool, WithAbsolutePaths(*list));
    if (!status.ok()) return status;
  }
  std::error_code error;
  const std::string path = absl::StrCat(spool, extension);
  if (path != spool) std::filesystem::rename(spool, path, error);
  state.input = {flag, path};
  return path;
}

absl::StatusOr<std::string> TakeStandardOutput(const std::string& flag,
                                               const std::string& extension) {
  State& state = TheState();
  if (absl::Status s = CheckNotTaken(flag, state.output, "standard output"); !s.ok()) return s;
  const bool is_text = extension == ".json" || extension == ".csv";
  if (!is_text && isatty(STDOUT_FILENO) == 1) {
    return absl::InvalidArgumentError(absl::StrCat(flag,
                                                   " -: standard output is a terminal, and ",
                                                   extension,
                                                   " no text; want a pipe or a "
                                                   "file"));
  }
  if (absl::Status s = MakeFolder(); !s.ok()) return s;
  state.output = {flag, absl::StrCat(state.folder, "/standard output", extension)};
  return state.output.path;
}

bool IsStandardOutputTaken() { return !TheState().output.path.empty(); }

std::string WithStreamNames(absl::string_view text) {
  const State& state = TheState();
  std::string named(text);
  for (const auto& [taken, name] :
       {std::pair{&state.input, "standard input"}, std::pair{&state.output, "standard output"}}) {
    if (!taken->path.empty()) named = absl::StrReplaceAll(named, {{taken->path, name}});
  }
  return named;
}

StandardStreams::StandardStreams() = default;

StandardStreams::~StandardStreams() {
  State& state = TheState();
  std::error_code error;
  if (!state.folder.empty()) std::filesystem::remove_all(state.folder, error);
  if (output_ >= 0) close(output_);
}

void StandardStreams::Begin() {
  if (!IsStandardOutputTaken()) return;
  std::fflush(stdout);
  output_ = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
}

absl::Status StandardStreams::Finish() {
  const Taken& taken = TheState().output;
  std::error_code error;
  if (taken.path.empty() || !std::filesystem::exists(taken.path, error)) return absl::OkStatus();
  const OpenFile file(taken.path, "rb");
  if (file.is_open() && output_ >= 0 && Copy(file.descriptor(), output_)) return absl::OkStatus();
  return absl::DataLossError(
      absl::StrCat(taken.flag, " -: standard output cannot be written: ", ErrnoText()));
}

}  // namespace lightfit::cli
