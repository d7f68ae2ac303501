#include "jobs/shot/pipeline.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/parallel.h"
#include "base/text_file.h"
#include "base/version.h"
#include "io/summary_file.h"
#include "jobs/shot/frame_fitter.h"
#include "jobs/shot/judge.h"
#include "jobs/shot/whole_plans.h"
#include "optimizer/fit.h"
#include "wire/shot_proto.h"

namespace lightfit {
namespace {

// A frame on its way.
struct FrameWork {
  size_t frame = 0;
  absl::StatusOr<ReadbackFile> file = absl::UnknownError("not read");
  std::optional<FrameViews> views;  // in the file

  struct Mode {
    ShotAnswers answers;
    ShotLookUps look_ups;  // of `answers`, or of the result that is done
    ShotStates states;
  };
  Mode per_frame, tracked;

  std::shared_ptr<FrameWork> before;  // until this frame is finished
};
using Group = std::vector<std::shared_ptr<FrameWork>>;

// Whether the frame's summary is to be made, or read for the sum.
bool NeedsSummary(const ShotContext& context, size_t frame) {
  return context.MakesSummaries() && (!context.HasShot() || !context.HasSummary(frame));
}

class FramePipeline {
 public:
  explicit FramePipeline(ShotContext* context)
      : context_(*context), job_(context->job), tracker_(context->job) {}

  absl::StatusOr<SummarySet> Run() {
    Group prepared, tracked;
    do {
      Group fresh = NextGroup();
      const auto num_fresh = static_cast<int>(fresh.size());
      const int num_items = 1 + num_fresh + static_cast<int>(tracked.size());
      ParallelFor(num_items, 1, job_.num_threads, [&](int begin, int end) {
        for (int item = begin; item < end; ++item) {
          if (item == 0) {
            for (const auto& work : prepared) Track(work.get());
          } else if (item <= num_fresh) {
            Prepare(fresh[item - 1].get());
          } else {
            Finish(tracked[item - 1 - num_fresh].get());
          }
        }
      });
      if (absl::Status status = context_.status(); !status.ok()) return status;
      tracked = std::move(prepared);
      prepared = std::move(fresh);
    } while (!prepared.empty() || !tracked.empty());
    return std::move(sum_);
  }

 private:
  Group NextGroup() {
    Group group;
    while (next_ < job_.frames.size() && static_cast<int>(group.size()) < job_.num_threads) {
      auto work = std::make_shared<FrameWork>();
      work->frame = next_++;
      work->before = last_;
      last_ = work;
      group.push_back(std::move(work));
    }
    if (group.empty()) last_ = nullptr;
    return group;
  }

  bool IsMissing(ShotMode mode, size_t frame) const {
    return job_.Has(mode) && !context_.IsDone(mode, frame);
  }

  void Prepare(FrameWork* work) {
    const size_t frame = work->frame;
    for (const auto& [mode, part] : {std::pair{ShotMode::kPerFrame, &work->per_frame},
                                     std::pair{ShotMode::kTracked, &work->tracked}}) {
      if (job_.Has(mode) && context_.IsDone(mode, frame)) LoadDone(mode, frame, part);
    }
    if (MustReadFrame(context_, frame)) {
      work->file = ReadFrame(job_, frame);
      context_.frame_status[frame] = work->file.status();
      if (work->file.ok()) context_.AddNotes(frame, *work->file);
      work->views.emplace(job_, frame, work->file);
    }
    if (IsMissing(ShotMode::kPerFrame, frame)) {
      work->per_frame.answers = FitFrame(job_, *work->views);
      work->per_frame.look_ups = LookUpsOf(work->per_frame.answers);
    }
    if (NeedsSummary(context_, frame)) Summarise(*work);
    if (context_.SumsRays()) context_.ray_sums[frame] = SumRaysOfFrame(job_, *work->views);
  }

  void LoadDone(ShotMode mode, size_t frame, FrameWork::Mode* part) {
    const absl::StatusOr<v1::FitResult> result = context_.ReadDone(mode, frame);
    if (!result.ok()) {
      context_.Fail(result.status());
      return;
    }
    part->look_ups = LookUpsOf(job_, *result);
    absl::StatusOr<ShotStates> states = StatesOf(job_, *result);
    context_.Fail(InFile(context_.paths.Result(mode, job_.frames[frame]), states.status()));
    if (states.ok()) part->states = *std::move(states);
    context_.KeepRows(mode, frame, *result);
  }

  // A frame that cannot be read has no part in the sum.
  void Summarise(const FrameWork& work) {
    const ShotFrame& frame = job_.frames[work.frame];
    const std::string path = context_.paths.Summary(frame);
    absl::StatusOr<SummarySet> set = absl::UnknownError("not summarised");
    if (context_.HasSummary(work.frame)) {
      set = ReadSummaryFile(path);
    } else if (work.file.ok()) {
      std::vector<LightSummary> lights;
      for (size_t i = 0; i < job_.lights.size(); ++i) {
        const absl::StatusOr<LightView>& view = (*work.views)[i];
        const absl::Status still = job_.StandsStill(i);
        const absl::Status status = still.ok() ? view.status() : still;
        const absl::StatusOr<Summary> summary =
            status.ok() ? Summarize(*view, job_.fit()) : absl::StatusOr<Summary>(status);
        lights.push_back(SummaryOfFrame(job_.lights[i], summary, frame.name, job_.fit()));
      }
      set = MakeSummarySet(
          job_.fit(), std::move(lights), IdentityOf(work.file->View(), frame.number));
      context_.Fail(WriteSummaryFile(path, *set, absl::StrCat("lightfit ", kVersion)));
      context_.Fail(WriteTextFileAtomically(context_.paths.SummaryKey(frame),
                                            context_.keys.summaries[work.frame]));
    } else {
      return;
    }
    if (!set.ok()) {
      context_.Fail(set.status());
      return;
    }
    // Sums are exact: the order does not matter.
    const std::lock_guard<std::mutex> lock(sum_mutex_);
    if (sum_.lights.empty()) {
      sum_ = *std::move(set);
    } else {
      context_.Fail(AddToSet(*set, &sum_));
    }
  }

  void Track(FrameWork* work) {
    if (!job_.Has(ShotMode::kTracked)) return;
    FrameWork::Mode& tracked = work->tracked;
    if (context_.IsDone(ShotMode::kTracked, work->frame)) {
      tracker_.set_states(tracked.states);
      return;
    }
    tracked.answers = tracker_.Track(work->file, *work->views);
    tracked.look_ups = LookUpsOf(tracked.answers);
    tracked.states = tracker_.states();
  }

  void Finish(FrameWork* work) {
    FinishMode(ShotMode::kPerFrame, &FrameWork::per_frame, work);
    FinishMode(ShotMode::kTracked, &FrameWork::tracked, work);
    work->before.reset();
    if (!MustReadFrame(context_, work->frame)) return;
    context_.Step(absl::StrCat("frame ", job_.frames[work->frame].name));
  }

  void FinishMode(ShotMode mode, FrameWork::Mode FrameWork::*part, FrameWork* work) {
    if (!IsMissing(mode, work->frame)) return;
    FrameBefore before;
    if (work->before != nullptr) {
      const FrameWork& last = *work->before;
      before = BeforeFrame(job_, work->frame, last.file, (last.*part).look_ups);
    }
    const FrameWork::Mode& own = work->*part;
    const std::vector<absl::StatusOr<ShotFit>> fits =
        JudgeFits(job_, *work->views, own.answers, before);
    context_.WriteResult(mode,
                         work->frame,
                         ShotResultToProto(job_,
                                           mode,
                                           work->frame,
                                           context_.keys.Of(mode, work->frame),
                                           work->file.ok() ? &*work->file : nullptr,
                                           fits,
                                           own.states));
  }

  ShotContext& context_;
  const ShotJob& job_;
  ShotTracker tracker_;
  size_t next_ = 0;
  std::shared_ptr<FrameWork> last_;  // of the frames that were begun
  std::mutex sum_mutex_;
  SummarySet sum_;
};

}  // namespace

bool MustReadFrame(const ShotContext& context, size_t frame) {
  if (context.NeedsFits(frame)) return true;
  if (NeedsSummary(context, frame) && !context.HasSummary(frame)) return true;
  if (context.SumsRays()) return true;
  // The frame after needs it for its crawl.
  return frame + 1 < context.job.frames.size() && context.NeedsFits(frame + 1) &&
         !context.job.frames[frame + 1].is_after_gap;
}

absl::StatusOr<SummarySet> FitFrames(ShotContext* context) { return FramePipeline(context).Run(); }

}  // namespace lightfit
