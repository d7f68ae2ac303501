// tests/cli/allocations.h
//
// `lightfit allocate` run on the yard, and what it writes read back.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/examples.h"
#include "tests/testing/process.h"
#include "wire/allocation_json.h"

namespace lightfit {

inline ProcessResult AllocateYard(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"allocate", kYard, "--lights", kYardLights};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return RunLightfit(arguments);
}

inline v1::Allocation ReadAllocation(const std::string& path) {
  const absl::StatusOr<v1::Allocation> allocation = ReadAllocationJson(path);
  EXPECT_TRUE(allocation.ok()) << allocation.status();
  return allocation.ok() ? *allocation : v1::Allocation();
}

inline void ExpectError(const ProcessResult& result, int exit_code, const std::string& words) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_THAT(
      result.err,
      ::testing::AllOf(::testing::StartsWith("lightfit: error: "), ::testing::HasSubstr(words)));
  EXPECT_THAT(result.out, ::testing::IsEmpty());
}

}  // namespace lightfit
