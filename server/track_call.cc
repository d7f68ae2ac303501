#include "server/track_call.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/wire_message.h"

namespace lightfit {
namespace {

absl::Status DrainingError() {
  return absl::UnavailableError(
      "this server is going out of service; go on elsewhere, with the last tracker_state in "
      "setup.state");
}

}  // namespace

TrackCall::TrackCall(ServerParts* parts, grpc::CallbackServerContext* context)
    : call_(parts, "Track", context) {
  if (absl::Status status = call_.EnterAsStream([this] { Drain(); }); !status.ok()) {
    End(status);
    return;
  }
  WatchIdling();
  StartRead(&request_bytes_);
}

void TrackCall::WatchIdling() {
  const ServerLimits& limits = call_.parts().limits;
  call_.parts().deadlines.Begin(
      this, limits.idle_timeout, [this, &limits] { End(IdleStream(limits)); });
}

void TrackCall::OnDone() {
  call_.parts().deadlines.End(this);
  delete this;
}

void TrackCall::OnReadDone(bool ok) {
  if (!ok) {
    End(pixels_.has_value() ? pixels_->CheckComplete() : absl::OkStatus());
    return;
  }
  call_.NoteReceived(static_cast<int64_t>(request_bytes_.Length()));
  absl::Status status = ParseWire(&request_bytes_, &request_);
  if (status.ok()) status = Take(&request_);
  if (!status.ok()) {
    End(status);
    return;
  }
  if (!is_frame_ready_) {
    GoOn();
    return;
  }
  call_.parts().deadlines.End(this);
  {
    const std::lock_guard lock(mutex_);
    if (has_ended_) return;
    is_working_ = true;
  }
  call_.RunFrame([this] { Answer(); });
}

absl::Status TrackCall::Take(v1::TrackRequest* request) {
  if (request->part_case() == v1::TrackRequest::kSetup) {
    if (session_.has_value()) {
      return absl::InvalidArgumentError("setup: is here already, want it once");
    }
    absl::StatusOr<TrackSession> session =
        TrackSession::Begin(request->setup(), call_.parts().limits.calls);
    if (!session.ok()) return session.status();
    session_.emplace(*std::move(session));
    return absl::OkStatus();
  }
  if (!session_.has_value()) {
    return absl::InvalidArgumentError("first message is not setup, want setup, then frames");
  }
  switch (request->part_case()) {
    case v1::TrackRequest::kFrame:
      return BeginFrame(request->mutable_frame());
    case v1::TrackRequest::kPixels:
      return TakePixels(request->pixels());
    default:
      return absl::InvalidArgumentError("message is empty, want frame or pixels");
  }
}

absl::Status TrackCall::BeginFrame(v1::TrackFrame* frame) {
  if (pixels_.has_value()) {
    const absl::Status missing = pixels_->CheckComplete();
    return absl::InvalidArgumentError(
        absl::StrCat("frame: comes before all pixels of the one before: ", missing.message()));
  }
  frame_.Swap(frame);
  skips_chunks_ = false;
  frame_status_ = absl::OkStatus();
  const absl::StatusOr<ReadbackHeader> header =
      ReadbackHeaderFromProto(frame_.readback(), frame_.lights_size(), call_.parts().limits.calls);
  frame_status_ = header.ok() ? call_.Reserve(header->buffer_bytes()) : header.status();
  if (frame_status_.ok()) {
    call_.NotePixels(header->num_pixels());
    pixels_.emplace(*header);
    frame_status_ = pixels_->Append(frame_.readback());
  }
  ClearPixels(frame_.mutable_readback());
  skips_chunks_ = !frame_status_.ok();
  is_frame_ready_ = skips_chunks_ || pixels_->is_complete();
  if (!is_frame_ready_) {
    const ServerLimits& limits = call_.parts().limits;
    call_.parts().deadlines.Begin(
        this, limits.upload_timeout, [this, &limits] { End(LateUpload(limits)); });
  }
  return absl::OkStatus();
}

absl::Status TrackCall::TakePixels(const v1::PixelChunk& chunk) {
  if (skips_chunks_) return absl::OkStatus();
  if (!pixels_.has_value()) {
    return absl::InvalidArgumentError("pixels: all of the frame are here already, want a frame");
  }
  if (absl::Status status = CheckChunk(chunk); !status.ok()) return status;
  frame_status_ = pixels_->Append(chunk);
  skips_chunks_ = !frame_status_.ok();
  is_frame_ready_ = skips_chunks_ || pixels_->is_complete();
  return absl::OkStatus();
}

void TrackCall::Answer() {
  if (frame_status_.ok()) {
    frame_status_ = CheckBoundary(pixels_->View(), call_.parts().limits.calls);
  }
  FineCover fine_cover;
  const absl::StatusOr<Readback> view =
      frame_status_.ok() ? absl::StatusOr<Readback>(pixels_->View(&fine_cover)) : frame_status_;
  result_ = session_->Update(frame_, view, call_.context().stop);
  pixels_.reset();
  call_.Release();
  is_frame_ready_ = false;
  call_.NoteLights(result_.result().lights());
  const absl::Status status = SerializeWire(result_, &result_bytes_);
  call_.WorkDone();
  if (!status.ok()) return End(status);
  StartWrite(&result_bytes_);
}

void TrackCall::OnWriteDone(bool ok) {
  {
    const std::lock_guard lock(mutex_);
    is_working_ = false;
  }
  result_bytes_.Clear();
  if (ok) {
    WatchIdling();
    GoOn();
  } else {
    End(absl::CancelledError("the client is gone"));
  }
}

void TrackCall::GoOn() {
  {
    const std::lock_guard lock(mutex_);
    if (has_ended_) return;
    if (!is_draining_) {
      StartRead(&request_bytes_);
      return;
    }
  }
  End(DrainingError());
}

void TrackCall::Drain() {
  {
    const std::lock_guard lock(mutex_);
    is_draining_ = true;
    if (is_working_) return;  // ends with its answer
  }
  End(DrainingError());
}

void TrackCall::End(const absl::Status& status) {
  {
    const std::lock_guard lock(mutex_);
    if (has_ended_) return;
    has_ended_ = true;
  }
  Finish(call_.Finish(status));
}

}  // namespace lightfit
