// server/call.h
//
// The life of one call, whatever it computes: admission, memory, cancellation, times, and what is
// said of it in the end.
// In:   the parts of the server that calls share; the call's context.
// Out:  a grpc::Status; a line in the log, figures in the metrics.
#pragma once

#include <google/protobuf/repeated_field.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "calls/call_context.h"
#include "lightfit/v1/readback.pb.h"
#include "lightfit/v1/result.pb.h"
#include "lightfit/v1/service.pb.h"
#include "server/call_gate.h"
#include "server/call_log.h"
#include "server/deadline_watch.h"
#include "server/memory_budget.h"
#include "server/metrics.h"
#include "server/server_options.h"
#include "server/work_pool.h"

namespace lightfit {

// 1 MiB of pixels, and what a message takes around them.
inline constexpr size_t kMaxChunkBytes = (size_t{1} << 20) + 1024;

// What calls share. Outlives them.
struct ServerParts {
  ServerParts(const ServerLimits& limits, Metrics* metrics, CallLog* log);

  const ServerLimits limits;
  Metrics& metrics;
  CallLog& log;
  MemoryBudget memory;
  CallGate calls;    // of one request
  CallGate streams;  // FitStream and Track
  DeadlineWatch deadlines;
  WorkPool pool;  // last: its threads work on the rest
};

// Any thread may call these functions, unless they say otherwise.
class Call {
 public:
  Call(ServerParts* parts, const char* method, grpc::CallbackServerContext* context);

  // After Finish().
  ~Call();

  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  // First of all. Unavailable while draining, ResourceExhausted when there are too many streams;
  // after an error there is only Finish(). `on_drain` is as CallGate's on_close.
  absl::Status Enter();
  absl::Status EnterAsStream(std::function<void()> on_drain);

  // ResourceExhausted when so many bytes are not to be had now. They are held until Release(), or
  // until the end of the call.
  absl::Status Reserve(int64_t bytes);
  void Release();

  // The client has cancelled the call, or its deadline is over.
  void Stop() { stop_.request_stop(); }

  CallContext context() const { return {parts_->limits.calls, stop_.get_token()}; }
  ServerParts& parts() { return *parts_; }

  // Has the pool do the work, in which Finish() or WorkDone() comes last. ResourceExhausted when
  // its queue is full.
  absl::Status Run(std::function<void()> work);

  // The same for a frame of a stream, which waits for its turn.
  void RunFrame(std::function<void()> work);
  void WorkDone();

  // What the log and the metrics say of the call in the end.
  void NoteReceived(int64_t bytes);
  void NotePixels(int64_t pixels);
  void NoteUploaded();  // all of it is here
  void NoteLights(const google::protobuf::RepeatedPtrField<v1::LightResult>& lights);

  // Once, last: what the client is told. Messages are cut to what headers can carry.
  grpc::Status Finish(const absl::Status& status);

 private:
  absl::Status Entered(CallGate* gate, CallGate::Entry entry);
  // ResourceExhausted, with advice in the trailers when to try again.
  absl::Status TryLater(const char* reason, const std::string& message);
  void BeginWork(absl::Time submitted);

  ServerParts* parts_;
  Metrics::Method* metrics_;
  grpc::CallbackServerContext* context_;
  CallGate* gate_ = nullptr;  // that it is inside of
  std::stop_source stop_;
  const absl::Time begin_;

  std::mutex mutex_;  // of what follows
  std::optional<MemoryBudget::Reservation> reservation_;
  std::optional<absl::Time> work_begin_;
  CallRecord record_;
};

// DeadlineExceeded of an upload that took longer than ServerLimits::upload_timeout, and of a stream
// that had no frame for ServerLimits::idle_timeout.
absl::Status LateUpload(const ServerLimits& limits);
absl::Status IdleStream(const ServerLimits& limits);

// InvalidArgument when it is larger than kMaxChunkBytes.
absl::Status CheckChunk(const v1::PixelChunk& chunk);

}  // namespace lightfit
