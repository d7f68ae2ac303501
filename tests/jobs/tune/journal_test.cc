#include "jobs/tune/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "tests/testing/matchers.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

class JournalTest : public ::testing::Test {
 protected:
  // Two values of light 0, one of light 1, and once more one of light 0.
  void WriteFour() const {
    absl::StatusOr<Journal> journal = Journal::Open(path_, "abc");
    ASSERT_THAT(journal, IsOk());
    EXPECT_FALSE(journal->Next(0).has_value());
    for (const auto& [light, value] :
         {std::pair{0, 812.0}, {0, 1.0 / 3.0}, {1, 5e5}, {0, 809.25}}) {
      EXPECT_THAT(journal->Append(light, value), IsOk());
    }
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.Path("a.journal");
};

TEST_F(JournalTest, GivesEachLightItsValuesBackInOrder) {
  WriteFour();
  const std::string text = ReadFile(path_);
  absl::StatusOr<Journal> journal = Journal::Open(path_, "abc");
  ASSERT_THAT(journal, IsOk());
  EXPECT_EQ(journal->Next(1), 5e5);
  EXPECT_EQ(journal->Next(0), 812.0);
  EXPECT_EQ(journal->Next(0), 1.0 / 3.0);
  EXPECT_EQ(journal->Next(0), 809.25);
  EXPECT_FALSE(journal->Next(0).has_value());
  EXPECT_FALSE(journal->Next(1).has_value());
  EXPECT_FALSE(journal->Next(2).has_value());
  EXPECT_EQ(ReadFile(path_), text);
}

// Wherever the file ends, what is whole is there, and appending goes on behind it.
TEST_F(JournalTest, ForgetsALineThatWasCut) {
  WriteFour();
  const std::string whole = ReadFile(path_);
  for (size_t size = 0; size <= whole.size(); ++size) {
    SCOPED_TRACE(size);
    WriteFile(path_, whole.substr(0, size));
    {
      absl::StatusOr<Journal> journal = Journal::Open(path_, "abc");
      ASSERT_THAT(journal, IsOk());
      for (const auto& [light, value] :
           {std::pair{0, 812.0}, {0, 1.0 / 3.0}, {1, 5e5}, {0, 809.25}}) {
        const std::optional<double> known = journal->Next(light);
        if (known.has_value()) {
          EXPECT_EQ(*known, value);
        } else {
          EXPECT_THAT(journal->Append(light, value), IsOk());
        }
      }
    }
    EXPECT_EQ(ReadFile(path_), whole);
  }
}

TEST_F(JournalTest, RefusesWhatIsNotItsOwnAndLeavesItAlone) {
  WriteFour();
  EXPECT_THAT(Journal::Open(path_, "abd"),
              StatusIs(kInvalid, AllOf(HasSubstr(path_), HasSubstr("another scene"))));
  // Not even the beginning of a key.
  EXPECT_THAT(Journal::Open(path_, "ab"), StatusIs(kInvalid, HasSubstr("another scene")));
  const std::string other = folder_.Path("notes.txt");
  for (const char* text : {"buy milk\n", "buy milk"}) {
    WriteFile(other, text);
    EXPECT_THAT(Journal::Open(other, "abc"), StatusIs(kInvalid, HasSubstr("no journal")));
    EXPECT_EQ(ReadFile(other), text);
  }
  EXPECT_THAT(Journal::Open(folder_.Path("no/a"), "abc"),
              StatusIs(absl::StatusCode::kUnknown, HasSubstr("cannot be written")));
}

TEST_F(JournalTest, NamesADamagedLine) {
  WriteFour();
  const std::string text = ReadFile(path_);
  for (const char* line : {"0\n", "x 5\n", "0 5 5\n", "0 nan\n", "-1 5\n", "\n"}) {
    WriteFile(path_, text + line + "0 7\n");
    EXPECT_THAT(Journal::Open(path_, "abc"), StatusIs(kInvalid, HasSubstr("line 6"))) << line;
  }
}

// A disk without room is an error that names the file, and what was written before it stays good.
TEST_F(JournalTest, SaysThatTheDiskIsFull) {
  void (*const handler)(int) = std::signal(SIGXFSZ, SIG_IGN);  // an error instead of a death
  rlimit old = {};
  getrlimit(RLIMIT_FSIZE, &old);
  rlimit small = old;
  small.rlim_cur = 60;
  int num_written = 0;
  {
    absl::StatusOr<Journal> journal = Journal::Open(path_, "abc");
    ASSERT_THAT(journal, IsOk());
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    absl::Status status;
    while (status.ok() && num_written < 100) {
      status = journal->Append(0, num_written + 0.125);
      num_written += status.ok() ? 1 : 0;
    }
    EXPECT_THAT(status, StatusIs(absl::StatusCode::kUnknown, HasSubstr(path_)));
  }
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_GT(num_written, 0);
  absl::StatusOr<Journal> journal = Journal::Open(path_, "abc");
  ASSERT_THAT(journal, IsOk());
  for (int i = 0; i < num_written; ++i) EXPECT_EQ(journal->Next(0), i + 0.125);
  EXPECT_FALSE(journal->Next(0).has_value());
}

TEST(Journal, WithoutAFileRemembersNothing) {
  Journal journal;
  EXPECT_THAT(journal.Append(0, 1.0), IsOk());
  EXPECT_FALSE(journal.Next(0).has_value());
}

}  // namespace
}  // namespace lightfit
