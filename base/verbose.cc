#include "base/verbose.h"

#include <atomic>
#include <cstdio>
#include <string>

namespace lightfit {
namespace {

std::atomic<bool> is_verbose = false;

}  // namespace

void SetVerbose(bool verbose) { is_verbose = verbose; }

bool IsVerbose() { return is_verbose; }

void Say(absl::string_view text) {
  if (IsVerbose()) std::fprintf(stderr, "lightfit: %s\n", std::string(text).c_str());
}

}  // namespace lightfit
