// cli/command_line/standard_streams.h
//
// `-` for standard input and output, of any option that takes a file and of any format: what is
// read is first put into a file, and what is written comes from one, in a folder that goes with the
// program.
// In:   the option that said `-`.
// Out:  a path for it; what was written there, on standard output.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace lightfit::cli {

// A file with all of standard input, with the extension that its first bytes tell: once only.
// `is_list`: lines that are no text of JSON are paths, made absolute, since those of a list are
// relative to it.
absl::StatusOr<std::string> TakeStandardInput(const std::string& flag, bool is_list);

// The path to write to for what is to go to standard output: once only.
absl::StatusOr<std::string> TakeStandardOutput(const std::string& flag,
                                               const std::string& extension);

// Whether standard output is taken by a file.
bool IsStandardOutputTaken();

// With "standard input" or "standard output" in place of those paths.
std::string WithStreamNames(absl::string_view text);

// Around a verb: with `-` as an output its tables go to stderr, and the file to standard output at
// the end. Removes the folder.
class StandardStreams {
 public:
  StandardStreams();
  ~StandardStreams();
  StandardStreams(const StandardStreams&) = delete;
  StandardStreams& operator=(const StandardStreams&) = delete;

  // From here on what is printed to stdout goes to stderr, where an output asked for that.
  void Begin();

  // What was written, to standard output; nothing where the verb wrote nothing.
  absl::Status Finish();

 private:
  int output_ = -1;  // the real standard output, while stdout is stderr
};

}  // namespace lightfit::cli
