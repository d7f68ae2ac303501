#include "server/fit_stream_call.h"

#include <utility>

#include "calls/fit_call.h"
#include "server/wire_message.h"

namespace lightfit {

FitStreamCall::FitStreamCall(ServerParts* parts,
                             grpc::CallbackServerContext* context,
                             grpc::ByteBuffer* result)
    : call_(parts, "FitStream", context), result_(result) {
  if (absl::Status status = call_.EnterAsStream(nullptr); !status.ok()) {
    End(status);
    return;
  }
  const ServerLimits& limits = call_.parts().limits;
  call_.parts().deadlines.Begin(
      this, limits.upload_timeout, [this, &limits] { End(LateUpload(limits)); });
  StartRead(&bytes_);
}

void FitStreamCall::OnDone() {
  call_.parts().deadlines.End(this);
  delete this;
}

void FitStreamCall::OnReadDone(bool ok) {
  if (has_ended_) return;
  const absl::Status status = ok ? Take() : Submit();
  if (!status.ok()) {
    End(status);
  } else if (ok) {
    StartRead(&bytes_);
  }
}

absl::Status FitStreamCall::Take() {
  call_.NoteReceived(static_cast<int64_t>(bytes_.Length()));
  if (absl::Status status = ParseWire(&bytes_, &part_); !status.ok()) return status;
  switch (part_.part_case()) {
    case v1::FitStreamRequest::kRequest:
      return Begin(part_.mutable_request());
    case v1::FitStreamRequest::kPixels:
      if (!pixels_.has_value()) {
        return absl::InvalidArgumentError("pixels: come before request, want request first");
      }
      if (absl::Status status = CheckChunk(part_.pixels()); !status.ok()) return status;
      return pixels_->Append(part_.pixels());
    case v1::FitStreamRequest::PART_NOT_SET:
      break;
  }
  return absl::InvalidArgumentError("message is empty, want request or pixels");
}

absl::Status FitStreamCall::Begin(v1::FitRequest* request) {
  if (pixels_.has_value()) {
    return absl::InvalidArgumentError("request: is here already, want it once");
  }
  const absl::StatusOr<ReadbackHeader> header = ReadbackHeaderFromProto(
      request->readback(), request->lights_size(), call_.parts().limits.calls);
  if (!header.ok()) return header.status();
  if (absl::Status status = call_.Reserve(header->buffer_bytes()); !status.ok()) return status;
  call_.NotePixels(header->num_pixels());
  pixels_.emplace(*header);
  request_.Swap(request);
  absl::Status status = pixels_->Append(request_.readback());
  ClearPixels(request_.mutable_readback());
  return status;
}

absl::Status FitStreamCall::Submit() {
  call_.parts().deadlines.End(this);
  if (has_ended_) return absl::OkStatus();  // it was late; nothing else ends it from here on
  if (!pixels_.has_value()) {
    return absl::InvalidArgumentError("stream ended before its first message, want request");
  }
  if (absl::Status status = pixels_->CheckComplete(); !status.ok()) return status;
  call_.NoteUploaded();
  return call_.Run([this] { Compute(); });
}

void FitStreamCall::Compute() {
  const CallContext context = call_.context();
  FineCover fine_cover;
  const Readback readback = pixels_->View(&fine_cover);
  const absl::Status fits = CheckBoundary(readback, context.limits);
  const absl::StatusOr<v1::FitResult> result =
      fits.ok() ? AnswerFit(request_, readback, context) : fits;
  if (!result.ok()) return End(result.status());
  call_.NoteLights(result->lights());
  End(SerializeWire(*result, result_));
}

void FitStreamCall::End(const absl::Status& status) {
  if (has_ended_.exchange(true)) return;
  Finish(call_.Finish(status));
}

}  // namespace lightfit
