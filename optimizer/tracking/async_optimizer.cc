#include "optimizer/tracking/async_optimizer.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_format.h"
#include "absl/types/span.h"
#include "base/latest_worker.h"

namespace lightfit {

namespace {

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
  view.background = background;
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

// It stays in place when the AsyncOptimizer moves.
struct AsyncOptimizer::Shared {
  TrackerOptions options;                                           // the submitting thread's
  Tracker tracker{TrackerOptions()};                                // the worker's
  std::unique_ptr<LatestWorker<Submission, FrameMatrices>> worker;  // ends before what it uses
};

absl::StatusOr<AsyncOptimizer> AsyncOptimizer::Start(const TrackerOptions& options) {
  if (absl::Status status = ValidateTrackerOptions(options); !status.ok()) return status;
  auto shared = std::make_unique<Shared>();
  shared->options = options;
  auto worker = LatestWorker<Submission, FrameMatrices>::Start(
      [shared = shared.get()](const Submission& submission, FrameMatrices* matrices) {
        Update(submission, &shared->tracker, matrices);
      },
      "raise the limit of threads, or call a Tracker in a thread of your own");
  if (!worker.ok()) return worker.status();
  shared->worker = *std::move(worker);
  return AsyncOptimizer(std::move(shared));
}

AsyncOptimizer::AsyncOptimizer(std::unique_ptr<Shared> shared) : shared_(std::move(shared)) {}
AsyncOptimizer::AsyncOptimizer(AsyncOptimizer&&) noexcept = default;
AsyncOptimizer& AsyncOptimizer::operator=(AsyncOptimizer&&) noexcept = default;
AsyncOptimizer::~AsyncOptimizer() = default;

FrameReadback& AsyncOptimizer::Lend() { return shared_->worker->Lend().readback; }

void AsyncOptimizer::Submit() {
  shared_->worker->Lend().options = shared_->options;
  shared_->worker->Submit();
}

absl::Status AsyncOptimizer::SetOptions(const TrackerOptions& options) {
  absl::Status status = ValidateTrackerOptions(options);
  if (status.ok()) shared_->options = options;
  return status;
}

const FrameMatrices* AsyncOptimizer::Poll() { return shared_->worker->Poll(); }

AsyncOptimizer::Counts AsyncOptimizer::counts() const {
  const auto counts = shared_->worker->counts();
  return {counts.submitted, counts.done, counts.skipped};
}

}  // namespace lightfit
