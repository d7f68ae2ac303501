// Shots with gaps, in every habit of numbering, with cameras from files of every kind: the right
// camera, or a refusal that names the file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>

#include "absl/strings/match.h"
#include "cli/flags/shot_flags.h"
#include "jobs/shot/judge.h"
#include "optimizer/fit.h"
#include "tests/cli/shots/numbered_shot.h"

namespace lightfit {
namespace {

using testing::NumberedShot;

constexpr int kFrames = 8;
constexpr MapSize kMap = {512, 512};
constexpr double kRounding = 1e-10;  // of an inverse, at 30 units from the origin
constexpr double kTexels = 1e-3;     // what two maps of one frame may differ by

// How frames are called, and how they are named on the command line.
struct Habit {
  const char* name;   // printf format of the file
  int first;          // the number of frame 0
  const char* given;  // what is said of them: "" for the folder, "list", "files", or a pattern
};

const Habit kHabits[] = {
    {"shot.%04d.exr", 1001, ""},
    {"shot_%04d.exr", 1001, ""},
    {"%d.exr", 1001, ""},
    {"frame%04d.exr", 5, ""},
    {"shot.v02.%04d.exr", 1001, ""},
    {"shot_%04d_left.exr", 1001, ""},
    {"sh010_%04d.denoised.exr", 1001, ""},
    {"shot.%d.exr", 6, ""},
    {"shot.%04d.exr", -3, ""},
    {"shot.%04d.exr", 1001, "shot.%04d.exr"},
    {"shot.%04d.exr", 1001, "shot.####.exr"},
    {"shot.%04d.exr", 1001, "shot.@@@@.exr"},
    {"shot.%04d.exr", 1001, "shot.$F4.exr"},
    {"shot.%04d.exr", 1001, "shot.<F4>.exr"},
    {"shot.%04d.exr", -3, "shot.*.exr"},
    {"shot.%04d.exr", 1001, "list"},
    {"shot.%04d.exr", -3, "files"},
    {"%04d/beauty.exr", 1001, "%04d/beauty.exr"},
    {"%04d/beauty.exr", 1001, "files"},
};

// Which frames there are.
const std::vector<int> kPresent[] = {{0, 1, 2, 3, 4, 5, 6, 7},
                                     {0, 1, 2, 6, 7},
                                     {1, 2, 3, 4, 5, 6, 7},
                                     {0, 1, 2, 3, 4, 5, 6},
                                     {0, 2, 4, 6},
                                     {3}};

struct CameraKind {
  const char* name;
  // The file for frames that are there and the number of frame 0.
  std::function<std::string(const std::vector<int>& present, int first)> json;
  bool states_first = false;  // with --frame: the place of the first frame
};

std::string Entries(const std::vector<int>& frames, const std::function<std::string(int)>& number) {
  std::vector<std::string> entries;
  for (const int frame : frames) {
    entries.push_back(absl::StrCat("{", number(frame), NumberedShot::CameraJson(frame), "}"));
  }
  return absl::StrCat("[", absl::StrJoin(entries, ",\n"), "]");
}

std::string NoNumber(int) { return ""; }

std::vector<CameraKind> CameraKinds() {
  const std::vector<int> all = kPresent[0];
  const auto numbered = [](const char* field, int first) {
    return [=](int frame) { return absl::StrFormat("\"%s\": %d, ", field, first + frame); };
  };
  return {
      {"numbers",
       [=](const auto&, int first) {
         return NumberedShot::SceneJson(Entries(all, numbered("frame", first)));
       }},
      {"numbers, last first",
       [=](const auto&, int first) {
         return NumberedShot::SceneJson(
             Entries({7, 6, 5, 4, 3, 2, 1, 0}, numbered("frame_number", first)));
       }},
      {"numbers of those there are",
       [=](const auto& present, int first) {
         return NumberedShot::SceneJson(Entries(present, numbered("frame", first)));
       }},
      {"numbers without one",
       [=](const auto&, int first) {
         return NumberedShot::SceneJson(Entries({0, 1, 2, 3, 4, 5, 7}, numbered("frame", first)));
       }},
      {"names",
       [=](const auto&, int first) {
         std::vector<std::string> entries;
         for (const int frame : all) {
           entries.push_back(
               absl::StrFormat("\"%04d\": {%s}", first + frame, NumberedShot::CameraJson(frame)));
         }
         return NumberedShot::SceneJson(absl::StrCat("{", absl::StrJoin(entries, ", "), "}"));
       }},
      {"frame_start",
       [=](const auto&, int first) {
         return NumberedShot::SceneJson(Entries(all, NoNumber),
                                        absl::StrFormat("\"frame_start\": %d, ", first));
       }},
      {"places", [=](const auto&, int) { return NumberedShot::SceneJson(Entries(all, NoNumber)); }},
      {"places of those there are",
       [=](const auto& present, int) {
         return NumberedShot::SceneJson(Entries(present, NoNumber));
       }},
      {"places and --frame",
       [=](const auto&, int) { return NumberedShot::SceneJson(Entries(all, NoNumber)); },
       /*states_first=*/true},
      {"some numbers",
       [=](const auto&, int first) {
         return NumberedShot::SceneJson(Entries(all, [=](int frame) {
           return frame % 2 == 0 ? absl::StrFormat("\"frame\": %d, ", first + frame) : "";
         }));
       }},
  };
}

// Largest distance of the floor's points between two maps, texels.
double LargestDistance(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  double largest = 0.0;
  for (const double x : {-4.0, 0.0, 4.0}) {
    for (const double y : {-4.0, 0.0, 4.0}) {
      const Eigen::Vector4d point(x, y, 0.0, 1.0);
      const Eigen::Vector4d in_a = a * point, in_b = b * point;
      largest = std::max(
          largest, (in_a.head<2>() / in_a.w() - in_b.head<2>() / in_b.w()).cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

class CameraCorpus : public ::testing::TestWithParam<size_t> {
 protected:
  cli::ShotFlags FlagsFor(const Habit& habit, const std::vector<int>& present) {
    const std::string folder = folder_.Path(absl::StrCat("shot", num_folders_++));
    std::vector<std::string> names;
    for (const int frame : present) {
      char name[64];
      std::snprintf(name, sizeof(name), habit.name, habit.first + frame);
      shot_.Link(frame, folder + "/" + name);
      names.emplace_back(name);
    }
    cli::ShotFlags flags;
    const std::string given = habit.given;
    if (given.empty()) {
      flags.inputs = {folder};
    } else if (given == "list") {
      std::reverse(names.begin(), names.end());
      WriteFile(folder + "/list.txt", absl::StrJoin(names, "\n"));
      flags.inputs = {folder + "/list.txt"};
    } else if (given == "files") {
      std::reverse(names.begin(), names.end());
      for (const std::string& name : names) flags.inputs.push_back(folder + "/" + name);
    } else {
      flags.inputs = {folder + "/" + given};
    }
    WriteFile(folder + "/lights.json", shot_.LightsJson());
    flags.fit.lights.path = folder + "/lights.json";
    flags.fit.camera_path = folder + "/scene.json";
    return flags;
  }

  const NumberedShot shot_{kFrames};
  const TemporaryFolder folder_;
  int num_folders_ = 0;
};

TEST_P(CameraCorpus, EveryFrameHasItsOwnCameraOrIsRefusedByName) {
  int num_shots = 0, num_right = 0, num_refused_frames = 0, num_refused_shots = 0;
  std::map<std::string, int> right_of;
  const std::vector<int>& present = kPresent[GetParam()];
  for (const Habit& habit : kHabits) {
    const cli::ShotFlags common = FlagsFor(habit, present);
    for (const CameraKind& kind : CameraKinds()) {
      SCOPED_TRACE(absl::StrCat(habit.name,
                                " ",
                                habit.given,
                                ", ",
                                present.size(),
                                " frames from ",
                                habit.first + present[0],
                                ", ",
                                kind.name));
      ++num_shots;
      cli::ShotFlags flags = common;
      if (kind.states_first) flags.fit.frame = FrameNumber::Whole(present[0]);
      WriteFile(flags.fit.camera_path, kind.json(present, habit.first));
      const absl::StatusOr<ShotJob> job = cli::MakeShotJob(flags);
      if (!job.ok()) {
        ++num_refused_shots;
        EXPECT_TRUE(absl::StrContains(job.status().message(), "scene.json")) << job.status();
        continue;
      }
      ASSERT_EQ(job->frames.size(), present.size());
      for (size_t i = 0; i < present.size(); ++i) {
        const ShotFrame& frame = job->frames[i];
        EXPECT_EQ(frame.number, FrameNumber::Whole(habit.first + present[i]));
        if (!frame.exr.ok()) {
          ++num_refused_frames;
          EXPECT_TRUE(absl::StrContains(frame.exr.status().message(), "scene.json"));
          EXPECT_TRUE(absl::StrContains(frame.exr.status().message(), frame.number.Text()));
          continue;
        }
        ++num_right;
        ++right_of[kind.name];
        const Camera expected = NumberedShot::CameraOf(present[i]);
        ASSERT_TRUE(frame.exr->camera.has_value());
        const Camera& camera = *frame.exr->camera;
        EXPECT_LE((camera.camera_from_world - expected.camera_from_world).norm(), kRounding);
        EXPECT_LE((camera.screen_from_camera - expected.screen_from_camera).norm(), kRounding);
      }
    }
  }
  // 19 habits x 10 kinds of files; times 6 sets of frames: 1140 shots, of which 4845 frames are
  // right, and 95 frames and 228 whole shots refused.
  constexpr int kNumHabits = 19;
  EXPECT_EQ(num_shots, 10 * kNumHabits);
  const auto frames = static_cast<int>(present.size());
  for (const char* kind : {"numbers",
                           "numbers, last first",
                           "numbers of those there are",
                           "names",
                           "frame_start",
                           "places and --frame"}) {
    EXPECT_EQ(right_of[kind], kNumHabits * frames) << kind;
  }
  const int lacks = std::count(present.begin(), present.end(), 6) > 0 ? 1 : 0;
  EXPECT_EQ(right_of["numbers without one"], kNumHabits * (frames - lacks));
  EXPECT_EQ(num_refused_frames, kNumHabits * lacks);
  // From the first frame to the last, as many as the file has.
  const int span = present.back() - present.front() + 1;
  const int by_place = span == kFrames ? 1 : 0, by_place_of_those = span == frames ? 1 : 0;
  EXPECT_EQ(right_of["places"], kNumHabits * frames * by_place);
  EXPECT_EQ(right_of["places of those there are"], kNumHabits * frames * by_place_of_those);
  EXPECT_EQ(right_of["some numbers"], 0);
  EXPECT_EQ(num_refused_shots, kNumHabits * (3 - by_place - by_place_of_those));
  int all_right = 0;
  for (const auto& [kind, count] : right_of) all_right += count;
  EXPECT_EQ(num_right, all_right);
}

INSTANTIATE_TEST_SUITE_P(Sets, CameraCorpus, ::testing::Range(size_t{0}, std::size(kPresent)));

// The whole way: a matrix of the frame's own camera.
class CameraMatrices : public CameraCorpus {};

TEST_P(CameraMatrices, AreThoseOfTheFramesOwnCamera) {
  int num_matrices = 0;
  const std::vector<int>& present = kPresent[GetParam()];
  for (const CameraKind& kind : CameraKinds()) {
    cli::ShotFlags flags = FlagsFor(kHabits[0], present);
    if (kind.states_first) flags.fit.frame = FrameNumber::Whole(present[0]);
    WriteFile(flags.fit.camera_path, kind.json(present, kHabits[0].first));
    const absl::StatusOr<ShotJob> job = cli::MakeShotJob(flags);
    if (!job.ok()) continue;
    for (size_t i = 0; i < present.size(); ++i) {
      if (!job->frames[i].exr.ok()) continue;
      const absl::StatusOr<ReadbackFile> file = ReadFrame(*job, i);
      ASSERT_TRUE(file.ok()) << file.status();
      for (const Light& light : shot_.lights()) {
        const auto own = FitLight(shot_.view(present[i]).View(), light, kMap);
        const auto found = FitLight(file->View(), light, kMap);
        ASSERT_TRUE(own.ok() && found.ok()) << own.status() << found.status();
        EXPECT_LE(LargestDistance(own->map_from_world, found->map_from_world), kTexels)
            << kind.name << " " << present[i];
        ++num_matrices;
      }
    }
  }
  // Two lights: 8 frames with 9 kinds but for the one without frame 6, 5 frames with 8 likewise.
  EXPECT_EQ(num_matrices, GetParam() == 0 ? 2 * (8 * 9 - 1) : 2 * (5 * 8 - 1));
}

INSTANTIATE_TEST_SUITE_P(Sets, CameraMatrices, ::testing::Values(size_t{0}, size_t{1}));

}  // namespace
}  // namespace lightfit
