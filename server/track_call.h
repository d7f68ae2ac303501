// server/track_call.h
//
// The call Track: frames in, matrices out, one at a time.
// In:   v1::TrackRequest: the setup, then frames, in chunks of pixels where a message is too small.
// Out:  v1::TrackResult for each frame. The next frame is not read before that is written: a client
//       that sends faster than frames are fitted waits in its own network layer.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <mutex>
#include <optional>

#include "calls/pixel_buffer.h"
#include "calls/track_session.h"
#include "lightfit/v1/service.pb.h"
#include "server/call.h"

namespace lightfit {

// Deletes itself when gRPC is done with it.
class TrackCall final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  TrackCall(ServerParts* parts, grpc::CallbackServerContext* context);

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override { call_.Stop(); }
  void OnDone() override;

 private:
  // Takes a message; then `is_frame_ready_` says whether it was the last of a frame.
  absl::Status Take(v1::TrackRequest* request);
  absl::Status BeginFrame(v1::TrackFrame* frame);
  absl::Status TakePixels(const v1::PixelChunk& chunk);
  void Answer();  // on the pool
  void GoOn();    // to the next message, if there is to be one
  void WatchIdling();
  void Drain();
  // The first to say so ends the stream. A frame in work is waited for.
  void End(const absl::Status& status);

  Call call_;
  grpc::ByteBuffer request_bytes_, result_bytes_;
  v1::TrackRequest request_;
  std::optional<TrackSession> session_;

  v1::TrackFrame frame_;
  std::optional<PixelBuffer> pixels_;  // of frame_, while it arrives
  absl::Status frame_status_;          // why frame_ cannot be used
  bool is_frame_ready_ = false;
  bool skips_chunks_ = false;  // those of a frame that was answered before its end

  v1::TrackResult result_;

  std::mutex mutex_;         // of what follows: streams are ended from several threads
  bool is_working_ = false;  // a frame is with the pool, or its answer under way
  bool is_draining_ = false;
  bool has_ended_ = false;
};

}  // namespace lightfit
