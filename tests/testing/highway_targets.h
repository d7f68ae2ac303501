// tests/testing/highway_targets.h
//
// Runs a check once on every instruction set that this processor and this build support.
#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>

namespace lightfit::testing {

// Calls check(name) with the dispatch of every kernel fixed to one target at a time.
template <typename Check>
void ForEachTarget(const Check& check) {
  int num_targets = 0;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    SCOPED_TRACE(hwy::TargetName(target));
    check(hwy::TargetName(target));
    ++num_targets;
    hwy::SetSupportedTargetsForTest(0);
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  EXPECT_GE(num_targets, 1);
}

}  // namespace lightfit::testing
