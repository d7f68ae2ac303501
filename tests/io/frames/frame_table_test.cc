// Which entry of a file belongs to which frame: by number, or not at all.

#include "io/frames/frame_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_join.h"
#include "wire/proto_json.h"

namespace lightfit {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<FrameTable> Table(const std::string& json) {
  google::protobuf::Struct file;
  if (absl::Status status = JsonToProto(json, file); !status.ok()) return status;
  return ReadFrameTable(file);
}

std::string Numbers(const std::string& json) {
  const absl::StatusOr<FrameTable> table = Table(json);
  if (!table.ok()) return std::string(table.status().message());
  return absl::StrJoin(*table, " ", [](std::string* out, const FrameEntry& entry) {
    out->append(entry.number.has_value() ? entry.number->Text() : "-");
  });
}

TEST(FrameTable, TakesTheNumbersThatFilesState) {
  EXPECT_EQ(Numbers(R"({"frames": [{}, {}]})"), "- -");
  EXPECT_EQ(Numbers(R"({"frames": [{"frame": 1001}, {"frame": 1007.25}]})"), "1001 1007.25");
  EXPECT_EQ(Numbers(R"({"frames": [{"frame_number": "0012"}, {"number": -2}]})"), "12 -2");
  EXPECT_EQ(Numbers(R"({"frames": [{}, {}], "frame_start": 1001})"), "1001 1002");
  EXPECT_EQ(Numbers(R"({"frames": {"1002": {}}})"), "1002");
  EXPECT_THAT(Numbers(R"({"frames": [{"frame": 1}, {}]})"), HasSubstr("1 of 2 say which"));
  EXPECT_THAT(Numbers(R"({"frames": [{"frame": 1}, {"frame": 1}]})"), HasSubstr("twice"));
  EXPECT_THAT(Numbers(R"({"frames": [{"frame": "one"}]})"), HasSubstr("frames[0].frame"));
  EXPECT_THAT(Numbers(R"({"frames": {"first": {}}})"), HasSubstr("frames.first"));
  EXPECT_THAT(Numbers(R"({"frames": []})"), HasSubstr("none"));
}

constexpr int kNone = -1;

// The entry of the frame, or kNone and why.
int EntryOf(const std::vector<std::optional<FrameNumber>>& entries,
            const ShotNumbers& shot,
            int frame,
            std::string* why = nullptr) {
  const absl::StatusOr<EntryChooser> chooser = EntryChooser::Make(entries, shot, "cameras");
  const absl::StatusOr<size_t> entry = chooser.ok() ? chooser->EntryOf(FrameNumber::Whole(frame))
                                                    : absl::StatusOr<size_t>(chooser.status());
  if (why != nullptr) *why = std::string(entry.status().message());
  return entry.ok() ? static_cast<int>(*entry) : kNone;
}

ShotNumbers Shot(int first, int last, std::optional<int> stated = std::nullopt) {
  ShotNumbers shot;
  shot.are_known = true;
  shot.first = FrameNumber::Whole(first);
  shot.last = FrameNumber::Whole(last);
  if (stated.has_value()) shot.stated = FrameNumber::Whole(*stated);
  return shot;
}

TEST(EntryChooser, GoesByNumber) {
  const std::vector<std::optional<FrameNumber>> numbered = {
      FrameNumber::Whole(1007), FrameNumber::Whole(1001), FrameNumber::Whole(1002)};
  EXPECT_EQ(EntryOf(numbered, Shot(1001, 1007), 1007), 0);
  EXPECT_EQ(EntryOf(numbered, Shot(1002, 1007), 1002), 2);
  std::string why;
  EXPECT_EQ(EntryOf(numbered, Shot(1001, 1007), 1003, &why), kNone);
  EXPECT_THAT(why, HasSubstr("has no cameras of frame 1003: it has 3, of frames 1001 ... 1007"));
  // Files are numbered otherwise, and --frame says how.
  EXPECT_EQ(EntryOf(numbered, Shot(1, 7, 1001), 2), 2);
}

TEST(EntryChooser, GoesByPlaceWhereThatIsKnown) {
  const std::vector<std::optional<FrameNumber>> eight(8);
  EXPECT_EQ(EntryOf(eight, Shot(1001, 1008), 1007), 6);
  EXPECT_EQ(EntryOf(eight, Shot(1003, 1007, 2), 1007), 6);
  std::string why;
  EXPECT_EQ(EntryOf(eight, Shot(1002, 1008), 1007, &why), kNone);
  EXPECT_THAT(why, HasSubstr("without saying which"));
  EXPECT_THAT(why, HasSubstr("--frame N"));
  EXPECT_EQ(EntryOf(eight, Shot(1001, 1008, 4), 1007, &why), kNone);
  EXPECT_THAT(why, HasSubstr("frame 10 is not in the file: it has 8, counted from 0"));
  EXPECT_EQ(EntryOf(eight, ShotNumbers(), 0, &why), kNone);
  EXPECT_THAT(why, HasSubstr("neither names nor headers"));
}

}  // namespace
}  // namespace lightfit
