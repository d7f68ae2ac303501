// server/unary_call.h
//
// A call of one request and one result.
// In:   the request's bytes, and the function of calls/ that answers it.
// Out:  the result's bytes, computed on the pool.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <utility>

#include "absl/status/statusor.h"
#include "calls/call_context.h"
#include "server/call.h"
#include "server/wire_message.h"

namespace lightfit {

// Of a request: pixels, and the bytes that it takes while it is worked on.
struct RequestSize {
  int64_t pixels = 0;
  int64_t bytes = 0;
};
RequestSize SizeOf(const v1::FitRequest& request);
RequestSize SizeOf(const v1::FitSummaryRequest& request);
RequestSize SizeOf(const v1::EvaluateRequest& request);
RequestSize SizeOf(const v1::AllocateRequest& request);
RequestSize SizeOf(const v1::SummarizeRequest& request);
RequestSize SizeOf(const v1::CompareRequest& request);

// The lights of a result go to the metrics.
void NoteResult(const v1::FitResult& result, Call* call);
void NoteResult(const v1::EvaluateResult& result, Call* call);
void NoteResult(const v1::Allocation& result, Call* call);
void NoteResult(const v1::SummarizeResult& result, Call* call);
void NoteResult(const v1::Comparison& result, Call* call);

// Deletes itself when gRPC is done with it.
template <typename Request, typename Result>
class UnaryCall final : public grpc::ServerUnaryReactor {
 public:
  using Answer = absl::StatusOr<Result> (*)(const Request&, const CallContext&);

  UnaryCall(ServerParts* parts,
            const char* method,
            grpc::CallbackServerContext* context,
            const grpc::ByteBuffer* request,
            grpc::ByteBuffer* result,
            Answer answer)
      : call_(parts, method, context), result_(result), answer_(answer) {
    // gRPC keeps the bytes, which are not const, until the call ends; nobody needs them once they
    // are a message.
    bytes_ = const_cast<grpc::ByteBuffer*>(request);
    if (const absl::Status status = Admit(); !status.ok()) Finish(call_.Finish(status));
  }

  void OnCancel() override { call_.Stop(); }
  void OnDone() override { delete this; }

 private:
  absl::Status Admit() {
    const auto num_bytes = static_cast<int64_t>(bytes_->Length());
    absl::Status parsed = ParseWire(bytes_, &request_);  // before it counts as a call
    if (absl::Status status = call_.Enter(); !status.ok()) return status;
    call_.NoteReceived(num_bytes);
    if (!parsed.ok()) return parsed;
    const RequestSize size = SizeOf(request_);
    call_.NotePixels(size.pixels);
    if (absl::Status status = call_.Reserve(size.bytes); !status.ok()) return status;
    return call_.Run([this] { Compute(); });
  }

  void Compute() {
    const absl::StatusOr<Result> result = answer_(request_, call_.context());
    absl::Status status = result.status();
    if (result.ok()) {
      NoteResult(*result, &call_);
      status = SerializeWire(*result, result_);
    }
    Finish(call_.Finish(status));  // may be the end of this object
  }

  Call call_;
  grpc::ByteBuffer* bytes_ = nullptr;  // of the request
  Request request_;
  grpc::ByteBuffer* result_;
  Answer answer_;
};

}  // namespace lightfit
