// server/fit_stream_call.h
//
// The call FitStream: a read-back in pieces, then one answer.
// In:   v1::FitStreamRequest: the request, then chunks of at most kMaxChunkBytes.
// Out:  v1::FitResult, as AnswerFit().
//
// Memory is taken when the first message has told the size, if it is to be had; a chunk is read
// when the one before has been stored, so that a fast sender waits in its own network layer.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <optional>

#include "calls/pixel_buffer.h"
#include "lightfit/v1/service.pb.h"
#include "server/call.h"

namespace lightfit {

// Deletes itself when gRPC is done with it.
class FitStreamCall final : public grpc::ServerReadReactor<grpc::ByteBuffer> {
 public:
  FitStreamCall(ServerParts* parts, grpc::CallbackServerContext* context, grpc::ByteBuffer* result);

  void OnReadDone(bool ok) override;
  void OnCancel() override { call_.Stop(); }
  void OnDone() override;

 private:
  absl::Status Take();  // of what has been read
  absl::Status Begin(v1::FitRequest* request);
  absl::Status Submit();
  void Compute();
  // The first to say so ends the call: a late upload ends it while a read is under way.
  void End(const absl::Status& status);

  Call call_;
  grpc::ByteBuffer* result_;
  grpc::ByteBuffer bytes_;  // of part_
  v1::FitStreamRequest part_;
  v1::FitRequest request_;
  std::optional<PixelBuffer> pixels_;
  std::atomic<bool> has_ended_ = false;
};

}  // namespace lightfit
