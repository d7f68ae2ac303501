// What is said of long work on a terminal and in a log.
#include "base/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

namespace lightfit {
namespace {

using ::testing::EndsWith;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// What was written, from whatever thread.
class Log {
 public:
  // Lines as often as can be, so that no test waits for half a minute.
  ProgressOutput Output(bool is_terminal) {
    return {.is_terminal = is_terminal,
            .line_every = std::chrono::milliseconds(1),
            .write = [this](const std::string& text) {
              const std::lock_guard<std::mutex> lock(mutex_);
              texts_.push_back(text);
              written_.notify_all();
            }};
  }

  // The first text that ends so, once it is there.
  std::string WaitFor(const std::string& end) {
    std::unique_lock<std::mutex> lock(mutex_);
    std::string found;
    written_.wait(lock, [&] {
      for (const std::string& text : texts_) {
        if (::testing::Matches(EndsWith(end))(text)) found = text;
      }
      return !found.empty();
    });
    return found;
  }

  std::vector<std::string> texts() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return texts_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable written_;
  std::vector<std::string> texts_;
};

TEST(ProgressLine, HasCountShareElapsedAndEstimate) {
  EXPECT_EQ(ProgressLine(12, 24, 90.0, "fitting sun"),
            "progress: 12 of 24 (50 %), 1 min 30 s elapsed, 1 min 30 s left: fitting sun");
  EXPECT_EQ(ProgressLine(1, 3, 30.0, ""), "progress: 1 of 3 (33 %), 30 s elapsed, 1 min 0 s left");
  EXPECT_EQ(ProgressLine(3, 3, 7200.0, "drawing"),
            "progress: 3 of 3 (100 %), 2 h 0 min elapsed, 0 s left: drawing");
}

TEST(ProgressLine, EstimatesNothingBeforeTheFirstStepIsDone) {
  EXPECT_EQ(ProgressLine(0, 24, 60.0, "fitting sun"),
            "progress: 0 of 24 (0 %), 1 min 0 s elapsed: fitting sun");
}

TEST(Progress, WritesLinesToALogWhileAStepIsStillAtWork) {
  Log log;
  {
    Progress progress(4, /*quiet=*/false, log.Output(/*is_terminal=*/false));
    progress.Begin("fitting sun");
    EXPECT_THAT(log.WaitFor(": fitting sun\n"), StartsWith("progress: 0 of 4 (0 %), "));
    progress.Advance();
    progress.Begin("fitting key");
    EXPECT_THAT(log.WaitFor(": fitting key\n"), StartsWith("progress: 1 of 4 (25 %), "));
  }
  const std::vector<std::string> texts = log.texts();
  for (const std::string& text : texts) {
    EXPECT_THAT(text, EndsWith("\n"));
    EXPECT_EQ(text.find('\r'), std::string::npos) << text;
  }
}

// The line that is due later is nobody's any more: the end does not wait for it.
TEST(Progress, EndsAtOnceAndSaysNothingOfShortWork) {
  Log log;
  {
    ProgressOutput output = log.Output(/*is_terminal=*/false);
    output.line_every = std::chrono::hours(24);
    Progress progress(1, /*quiet=*/false, output);
    progress.Begin("fitting sun");
    progress.Advance();
  }
  EXPECT_THAT(log.texts(), IsEmpty());
}

TEST(Progress, IsSilentWhereItIsToBeQuietOrWorkOnATerminalIsShort) {
  Log log;
  for (const bool is_terminal : {false, true}) {
    ProgressOutput output = log.Output(is_terminal);
    if (!is_terminal) output.line_every = std::chrono::milliseconds(0);
    Progress progress(2, /*quiet=*/true, output);
    progress.Begin("fitting sun");
    progress.Advance();
  }
  {
    Progress progress(2, /*quiet=*/false, log.Output(/*is_terminal=*/true));
    progress.Begin("fitting sun");
  }
  EXPECT_THAT(log.texts(), IsEmpty());
}

}  // namespace
}  // namespace lightfit
