// jobs/tune/journal.h
//
// The values that a search has evaluated, on disk, so that a run which was stopped goes on.
// In:   a path, the key of what is searched; values as they come.
// Out:  the values of the earlier run, in order.
//
// A line of text with the key, then one for each value: the light's number, the value. A last line
// that was cut off is forgotten.
#pragma once

#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace lightfit {

class Journal {
 public:
  // Remembers nothing.
  Journal() = default;

  // Goes on with the file at `path`, or begins it. InvalidArgument, which names what to do, when it
  // is the journal of another key, or none.
  static absl::StatusOr<Journal> Open(const std::string& path, absl::string_view key);

  // The next value that the earlier run had for this light; absent once there are no more.
  std::optional<double> Next(int light);

  // Written through to the file before it returns.
  absl::Status Append(int light, double value);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  struct Values {
    std::vector<double> values;
    size_t num_asked = 0;
  };

  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::map<int, Values> by_light_;
};

}  // namespace lightfit
