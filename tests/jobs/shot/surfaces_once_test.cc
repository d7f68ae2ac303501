// The pass over all pixels is made once for each frame of a shot: fitted, summed up, tracked and
// judged it is asked of the same surfaces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "io/readback_exr_write.h"
#include "jobs/shot/context.h"
#include "jobs/shot/frames.h"
#include "jobs/shot/run.h"
#include "optimizer/readback/surfaces.h"
#include "tests/testing/frame_loop.h"
#include "tests/testing/matchers.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using testing::IsOk;

TEST(SurfacesOnce, ForEachFrameOfAShot) {
  constexpr int kNumFrames = 4;
  const TemporaryFolder folder;
  const testing::BoxWalk walk(/*seed=*/3, /*num_lights=*/2, kNumFrames, 72, 48);
  std::vector<std::string> paths;
  for (int i = 0; i < kNumFrames; ++i) {
    paths.push_back(folder.Path(absl::StrCat("walk.", i, ".exr")));
    ASSERT_THAT(WriteReadbackExr(paths.back(), walk.views[i].View(), walk.lights), IsOk());
  }
  const absl::StatusOr<FrameList> frames = ListFrames(paths);
  ASSERT_THAT(frames, IsOk());
  for (const int num_threads : {1, 2}) {
    ShotJob job;
    job.name = "walk";
    job.frames = frames->frames;
    job.lights = walk.lights;
    job.modes = {true, true, false};
    job.map = {300, 200};
    job.folder = folder.Path(absl::StrCat("out", num_threads));
    job.num_threads = num_threads;
    job.quiet = true;
    ASSERT_THAT(MakeShotFolders(job), IsOk());
    ShotContext context(job);
    const int64_t before = NumSurfacesFound();
    ASSERT_THAT(RunShot(&context), IsOk());
    EXPECT_EQ(NumSurfacesFound() - before, kNumFrames);

    // One map for the whole shot reads the frames again: for each round of weighing, and to judge.
    job.modes = {false, false, true};
    ASSERT_THAT(MakeShotFolders(job), IsOk());
    ShotContext whole(job);
    const int64_t before_whole = NumSurfacesFound();
    ASSERT_THAT(RunShot(&whole), IsOk());
    const int64_t num_passes = (NumSurfacesFound() - before_whole) / kNumFrames;
    EXPECT_GE(num_passes, 2);               // summed up, judged
    EXPECT_LE(num_passes, 3 + job.rounds);  // and weighed anew in each round

    // Plans for it come of what the other modes have read, and are judged.
    job.modes = {true, true, true};
    job.plans.emplace();
    job.plans->plan.max_maps = 2;
    job.plans->plan.texels = 300 * 200;
    ASSERT_THAT(MakeShotFolders(job), IsOk());
    ShotContext of_plans(job);
    const int64_t before_plans = NumSurfacesFound();
    ASSERT_THAT(RunShot(&of_plans), IsOk());
    EXPECT_EQ(NumSurfacesFound() - before_plans, 2 * kNumFrames);
    EXPECT_THAT(ReadFitResultJson(of_plans.paths.Shot()), IsOk());
  }
}

}  // namespace
}  // namespace lightfit
