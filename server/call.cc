#include "server/call.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "server/request_id.h"

namespace lightfit {
namespace {

// gRPC's own limit for all headers and trailers is 8 KiB.
constexpr size_t kMaxMessageBytes = 2048;

// How long a piece of work in the queue takes, about: for advice when to come back.
constexpr absl::Duration kTypicalWork = absl::Milliseconds(20);
constexpr absl::Duration kLeastPause = absl::Milliseconds(50);
constexpr absl::Duration kMostPause = absl::Seconds(5);

constexpr int kNoLimit = 1 << 30;

std::string Header(const grpc::CallbackServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  if (found == context.client_metadata().end()) return "";
  return {found->second.data(), found->second.size()};
}

}  // namespace

ServerParts::ServerParts(const ServerLimits& limits, Metrics* metrics, CallLog* log)
    : limits(limits),
      metrics(*metrics),
      log(*log),
      memory(limits.memory_bytes),
      calls(kNoLimit),
      streams(limits.max_streams),
      pool(limits.num_threads, limits.max_queue) {}

Call::Call(ServerParts* parts, const char* method, grpc::CallbackServerContext* context)
    : parts_(parts),
      metrics_(&parts->metrics.ForMethod(method)),
      context_(context),
      begin_(absl::Now()) {
  record_.method = method;
  record_.peer = context->peer();
  record_.request_id = RequestId(Header(*context, kRequestIdKey));
  context->AddInitialMetadata(kRequestIdKey, record_.request_id);
  metrics_->Started();
}

Call::~Call() {
  Release();
  if (gate_ != nullptr) gate_->Leave(this);
}

absl::Status Call::Enter() {
  return Entered(&parts_->calls, parts_->calls.TryEnter(this, nullptr));
}

absl::Status Call::EnterAsStream(std::function<void()> on_drain) {
  return Entered(&parts_->streams, parts_->streams.TryEnter(this, std::move(on_drain)));
}

absl::Status Call::Entered(CallGate* gate, CallGate::Entry entry) {
  switch (entry) {
    case CallGate::Entry::kIn:
      gate_ = gate;
      return absl::OkStatus();
    case CallGate::Entry::kFull:
      return TryLater("streams",
                      absl::StrFormat("%d streams are open, and this server takes no more",
                                      parts_->limits.max_streams));
    case CallGate::Entry::kClosed:
      break;
  }
  parts_->metrics.Refused("draining");
  return absl::UnavailableError("this server is going out of service; try again, elsewhere");
}

absl::Status Call::Reserve(int64_t bytes) {
  std::optional<MemoryBudget::Reservation> reservation = parts_->memory.TryReserve(bytes);
  if (reservation.has_value()) {
    parts_->metrics.AddReadbackMemory(bytes);
    const std::lock_guard lock(mutex_);
    reservation_ = std::move(reservation);
    return absl::OkStatus();
  }
  if (bytes > parts_->memory.limit_bytes()) {
    parts_->metrics.Refused("too_large");
    return absl::ResourceExhaustedError(
        absl::StrFormat("the read-back takes %d bytes, and this server sets %d aside for all "
                        "together: send a smaller one, or raise lightfit serve --memory-mib",
                        bytes,
                        parts_->memory.limit_bytes()));
  }
  return TryLater("memory",
                  absl::StrFormat("the read-back takes %d bytes, and %d of %d are in use",
                                  bytes,
                                  parts_->memory.used_bytes(),
                                  parts_->memory.limit_bytes()));
}

void Call::Release() {
  const std::lock_guard lock(mutex_);
  if (!reservation_.has_value()) return;
  parts_->metrics.AddReadbackMemory(-reservation_->bytes());
  reservation_.reset();
}

absl::Status Call::Run(std::function<void()> work) {
  parts_->metrics.AddQueued(1);
  const bool is_queued =
      parts_->pool.TrySubmit([this, work = std::move(work), submitted = absl::Now()] {
        BeginWork(submitted);
        work();
      });
  if (is_queued) return absl::OkStatus();
  parts_->metrics.AddQueued(-1);
  return TryLater("queue",
                  absl::StrFormat("%d calls are waiting, and this server lets no more wait",
                                  parts_->limits.max_queue));
}

void Call::RunFrame(std::function<void()> work) {
  parts_->metrics.AddQueued(1);
  parts_->pool.Submit([this, work = std::move(work), submitted = absl::Now()] {
    BeginWork(submitted);
    work();
  });
}

void Call::BeginWork(absl::Time submitted) {
  parts_->metrics.AddQueued(-1);
  parts_->metrics.AddWorkersBusy(1);
  const absl::Time now = absl::Now();
  metrics_->ObserveStage(Stage::kQueue, now - submitted);
  const std::lock_guard lock(mutex_);
  record_.queue += now - submitted;
  work_begin_ = now;
}

void Call::WorkDone() {
  const std::lock_guard lock(mutex_);
  if (!work_begin_.has_value()) return;
  const absl::Duration duration = absl::Now() - *work_begin_;
  work_begin_.reset();
  record_.solve += duration;
  metrics_->ObserveStage(Stage::kSolve, duration);
  parts_->metrics.AddWorkersBusy(-1);
}

void Call::NoteReceived(int64_t bytes) {
  parts_->metrics.AddReceivedBytes(bytes);
  const std::lock_guard lock(mutex_);
  record_.bytes += bytes;
}

void Call::NotePixels(int64_t pixels) {
  parts_->metrics.AddPixels(pixels);
  const std::lock_guard lock(mutex_);
  record_.pixels += pixels;
}

void Call::NoteUploaded() {
  const absl::Duration duration = absl::Now() - begin_;
  metrics_->ObserveStage(Stage::kDecode, duration);
  const std::lock_guard lock(mutex_);
  record_.decode += duration;
}

void Call::NoteLights(const google::protobuf::RepeatedPtrField<v1::LightResult>& lights) {
  int num_failed = 0;
  for (const v1::LightResult& light : lights) {
    parts_->metrics.LightDone(static_cast<absl::StatusCode>(light.status().code()));
    num_failed += light.status().code() != 0 ? 1 : 0;
  }
  const std::lock_guard lock(mutex_);
  record_.lights += lights.size();
  record_.lights_failed += num_failed;
}

absl::Status Call::TryLater(const char* reason, const std::string& message) {
  parts_->metrics.Refused(reason);
  const absl::Duration pause =
      std::clamp(kTypicalWork * parts_->pool.num_waiting() / parts_->pool.num_threads(),
                 kLeastPause,
                 kMostPause);
  const int64_t pause_ms = absl::ToInt64Milliseconds(pause);
  context_->AddTrailingMetadata("grpc-retry-pushback-ms", absl::StrCat(pause_ms));
  return absl::ResourceExhaustedError(absl::StrFormat("%s; try again in %d ms", message, pause_ms));
}

grpc::Status Call::Finish(const absl::Status& status) {
  WorkDone();
  const absl::Duration total = absl::Now() - begin_;
  metrics_->Finished(status.code(), total);
  const std::lock_guard lock(mutex_);
  record_.status = status;
  record_.total = total;
  parts_->log.Call(record_);
  return {static_cast<grpc::StatusCode>(status.code()),
          std::string(status.message().substr(0, kMaxMessageBytes))};
}

absl::Status LateUpload(const ServerLimits& limits) {
  return absl::DeadlineExceededError(
      absl::StrFormat("the read-back was not here after %s: send it faster, or make it smaller",
                      absl::FormatDuration(limits.upload_timeout)));
}

absl::Status IdleStream(const ServerLimits& limits) {
  return absl::DeadlineExceededError(
      absl::StrFormat("no frame for %s: open another stream when there is one, with the last "
                      "tracker_state in setup.state",
                      absl::FormatDuration(limits.idle_timeout)));
}

absl::Status CheckChunk(const v1::PixelChunk& chunk) {
  if (chunk.ByteSizeLong() <= kMaxChunkBytes) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "pixels: a chunk of %d bytes, want at most 1 MiB each", chunk.ByteSizeLong()));
}

}  // namespace lightfit
