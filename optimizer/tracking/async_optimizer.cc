#include "optimizer/tracking/async_optimizer.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

#include "absl/strings/str_format.h"
#include "absl/types/span.h"
#include "base/scratch.h"
#include "base/stop.h"
#include "base/triple_buffer.h"

namespace lightfit {

namespace {

// Waking a sleeper takes the render thread 10 us and more. While frames keep coming the optimizer
// therefore naps between looks for the next one: later by half a nap on average, and each nap is
// about 20 us of work. Once none has come for so many naps it sleeps until it is woken.
constexpr auto kNap = std::chrono::milliseconds(1);
constexpr int kNumNaps = 100;

// A frame on its way to the optimizer.
struct Submission {
  FrameReadback readback;
  TrackerOptions options;
};

// Plain copies, none of which refers to the pool that the result is made in.
void Publish(const absl::StatusOr<TrackedMatrix>& result, FrameLight* light) {
  light->status = result.status();
  const bool ok = result.ok();
  light->map_from_world = ok ? result->matrix.map_from_world : Eigen::Matrix4d::Identity();
  light->map = ok ? result->matrix.map : MapSize();
  light->border = ok ? result->matrix.border : Border::kLit;
  light->energy = ok ? result->matrix.figures.energy : 0.0;
  light->action = ok ? result->action : TrackerAction::kFirst;
}

void Update(const Submission& submission, Tracker* tracker, FrameMatrices* matrices) {
  const FrameReadback& readback = submission.readback;
  const size_t num_lights = std::min(readback.lights.size(), size_t{kMaxLights});
  matrices->frame = readback.frame;
  matrices->num_lights = static_cast<int>(num_lights);
  for (size_t i = 0; i < num_lights; ++i) matrices->lights[i].name = readback.lights[i].name;
  if (readback.lights.size() > num_lights) {
    const absl::Status too_many = absl::InvalidArgumentError(
        absl::StrFormat("lights: %d of them, want at most %d, a shadow bit each; submit the rest "
                        "to another AsyncOptimizer",
                        readback.lights.size(),
                        kMaxLights));
    for (FrameLight& light : matrices->lights) Publish(too_many, &light);
    return;
  }
  tracker->set_options(submission.options);
  FineCover cover;
  const auto results = tracker->Update(readback.View(&cover), readback.lights, readback.map);
  for (size_t i = 0; i < num_lights; ++i) Publish(results[i], &matrices->lights[i]);
}

}  // namespace

FineCover FrameFineCover::View() const {
  FineCover view;
  view.columns = columns;
  view.rows = rows;
  view.nearest = nearest;
  view.furthest = furthest;
  view.shadow_bits = shadow_bits;
  view.lit_bits = lit_bits;
  view.lit_lights = lit_lights;
  return view;
}

Readback FrameReadback::View(FineCover* cover) const {
  Readback view;
  view.camera = camera;
  view.depth = depth;
  view.depth_kind = depth_kind;
  view.shadow_bits = shadow_bits;
  view.facing_bits = facing_bits;
  if (cover != nullptr && (fine_cover.columns != 0 || fine_cover.rows != 0)) {
    *cover = fine_cover.View();
    view.fine_cover = cover;
  }
  return view;
}

const FrameLight* FrameMatrices::Find(absl::string_view name) const {
  for (int i = 0; i < num_lights; ++i) {
    if (lights[i].name == name) return &lights[i];
  }
  return nullptr;
}

// What the threads share. It stays in place when the AsyncOptimizer moves.
struct AsyncOptimizer::Shared {
  TripleBuffer<Submission> submissions;  // from the submitting thread to the optimizer
  TripleBuffer<FrameMatrices> matrices;  // from the optimizer to the polling thread
  TrackerOptions options;                // the submitting thread's

  // Counts everything the optimizer should wake up for. It reads this first and looks for work
  // second, so that what comes in between changes the number and does not let it fall asleep. All
  // accesses are sequentially consistent: whoever counts up sees a sleeper, or the sleeper sees it.
  std::atomic<uint32_t> wake = 0;

  std::atomic<int64_t> num_submitted = 0, num_done = 0, num_skipped = 0;
  std::jthread thread;  // its stop ends the frame in work, and then the thread

  // A system call, but only when the optimizer sleeps; naps end by themselves.
  void WakeUp() {
    wake.fetch_add(1);
    wake.notify_one();
  }

  // The optimizer's thread.
  void Run(const std::stop_token& stop) {
    const StopScope stop_scope(stop);
    ScratchPool pool;  // no frame but the first few takes anything from the heap
    Tracker tracker{TrackerOptions()};
    int num_naps = 0;
    while (true) {
      const uint32_t wake_before = wake.load();
      if (stop.stop_requested()) return;
      if (!submissions.Take()) {
        if (num_naps < kNumNaps) {
          ++num_naps;
          std::this_thread::sleep_for(kNap);
        } else {
          wake.wait(wake_before);
        }
        continue;
      }
      num_naps = 0;
      {
        const ScratchScope scope(&pool);
        Update(submissions.front(), &tracker, &matrices.back());
      }
      if (stop.stop_requested()) return;
      num_done.fetch_add(1);  // first, so that nobody polls a frame that is not counted
      matrices.Publish();
    }
  }

  ~Shared() {
    if (!thread.joinable()) return;
    thread.request_stop();
    WakeUp();
    thread.join();
  }
};

absl::StatusOr<AsyncOptimizer> AsyncOptimizer::Start(const TrackerOptions& options) {
  if (absl::Status status = ValidateTrackerOptions(options); !status.ok()) return status;
  auto shared = std::make_unique<Shared>();
  shared->options = options;
  try {
    shared->thread =
        std::jthread([shared = shared.get()](const std::stop_token& stop) { shared->Run(stop); });
  } catch (const std::system_error& error) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("cannot start the optimizer's thread: %s; raise the limit of threads, or "
                        "call a Tracker in a thread of your own",
                        error.what()));
  }
  return AsyncOptimizer(std::move(shared));
}

AsyncOptimizer::AsyncOptimizer(std::unique_ptr<Shared> shared) : shared_(std::move(shared)) {}
AsyncOptimizer::AsyncOptimizer(AsyncOptimizer&&) noexcept = default;
AsyncOptimizer& AsyncOptimizer::operator=(AsyncOptimizer&&) noexcept = default;
AsyncOptimizer::~AsyncOptimizer() = default;

FrameReadback& AsyncOptimizer::Lend() { return shared_->submissions.back().readback; }

void AsyncOptimizer::Submit() {
  shared_->submissions.back().options = shared_->options;
  shared_->num_submitted.fetch_add(1);
  if (shared_->submissions.Publish()) shared_->num_skipped.fetch_add(1);
  shared_->WakeUp();
}

absl::Status AsyncOptimizer::SetOptions(const TrackerOptions& options) {
  absl::Status status = ValidateTrackerOptions(options);
  if (status.ok()) shared_->options = options;
  return status;
}

const FrameMatrices* AsyncOptimizer::Poll() {
  return shared_->matrices.Take() ? &shared_->matrices.front() : nullptr;
}

AsyncOptimizer::Counts AsyncOptimizer::counts() const {
  // Submitted last: it is never less than the others together.
  Counts counts;
  counts.done = shared_->num_done.load();
  counts.skipped = shared_->num_skipped.load();
  counts.submitted = shared_->num_submitted.load();
  return counts;
}

}  // namespace lightfit
