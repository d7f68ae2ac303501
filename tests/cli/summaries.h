// tests/cli/summaries.h
//
// Summary files made by `lightfit summarize`, for the verbs that take them.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {

using Arguments = std::vector<std::string>;

inline Arguments Joined(Arguments first, const Arguments& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

// An error is one line, and nothing goes to stdout.
inline void ExpectError(const ProcessResult& result,
                        int exit_code,
                        const std::vector<std::string>& words) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_THAT(result.err, ::testing::StartsWith("lightfit: error: "));
  for (const std::string& word : words) EXPECT_THAT(result.err, ::testing::HasSubstr(word));
  EXPECT_THAT(result.out, ::testing::IsEmpty());
}

// Runs `lightfit summarize` and expects it to succeed.
inline void RunSummarize(const Arguments& arguments) {
  const ProcessResult result = RunLightfit(Joined({"summarize"}, arguments));
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

// The yard's read-back as a frame of another number.
inline std::string YardFrame(const TemporaryFolder& folder, const std::string& name) {
  const std::string path = folder.Path(name);
  WriteFile(path, ReadFile(kYard));
  return path;
}

// The yard with some light, as a summary file of that name in the folder.
inline std::string YardSummary(const TemporaryFolder& folder,
                               const std::string& name,
                               const Arguments& more = {}) {
  const std::string path = folder.Path(name);
  RunSummarize(Joined({kYard, "--lights", kYardLights, "-o", path}, more));
  return path;
}

}  // namespace lightfit
