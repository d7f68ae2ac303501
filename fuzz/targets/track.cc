// The call Track: its messages, through PixelBuffer and TrackSession as server/track_call takes
// them.
#include <optional>

#include "calls/pixel_buffer.h"
#include "calls/track_session.h"
#include "fuzz/calls.h"
#include "fuzz/input_form.h"
#include "fuzz/inputs.pb.h"
#include "fuzz/promises.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&TrackInput::default_instance(), Encoding::kMessage}; }

namespace {

constexpr int kMaxFrames = 8;

class Stream {
 public:
  // Ok as long as the stream goes on.
  absl::Status Take(const v1::TrackRequest& request) {
    if (request.has_setup() && !session_.has_value()) return Begin(request.setup());
    if (!session_.has_value()) return absl::InvalidArgumentError("want setup first");
    if (request.has_frame() && !pixels_.has_value()) return TakeFrame(request.frame());
    if (!request.has_pixels() || !pixels_.has_value()) {
      return absl::InvalidArgumentError("want a frame, then its pixels");
    }
    return AnswerWhenReady(pixels_->Append(request.pixels()));
  }

 private:
  absl::Status Begin(v1::TrackSetup setup) {
    ShortenSearch(setup.mutable_options());
    absl::StatusOr<TrackSession> session = TrackSession::Begin(setup, SmallContext().limits);
    if (!session.ok()) return session.status();
    session_.emplace(*std::move(session));
    return absl::OkStatus();
  }

  absl::Status TakeFrame(const v1::TrackFrame& frame) {
    if (++num_frames_ > kMaxFrames) return absl::ResourceExhaustedError("enough for a test");
    frame_ = frame;
    const absl::StatusOr<ReadbackHeader> header =
        ReadbackHeaderFromProto(frame.readback(), frame.lights_size(), SmallContext().limits);
    if (!header.ok()) return AnswerWhenReady(header.status());
    pixels_.emplace(*header);
    return AnswerWhenReady(pixels_->Append(frame.readback()));
  }

  // A frame that cannot be used is answered with its status, and the next one may come.
  absl::Status AnswerWhenReady(const absl::Status& frame_status) {
    if (frame_status.ok() && !pixels_->is_complete()) return absl::OkStatus();
    FineCover fine_cover;
    const v1::TrackResult result = session_->Update(
        frame_,
        frame_status.ok() ? absl::StatusOr<Readback>(pixels_->View(&fine_cover)) : frame_status,
        std::stop_token());
    PromiseMessage(result);
    Promise(result.number() == frame_.number(), "a frame's number comes back");
    pixels_.reset();
    return absl::OkStatus();
  }

  std::optional<TrackSession> session_;
  v1::TrackFrame frame_;
  std::optional<PixelBuffer> pixels_;
  int num_frames_ = 0;
};

}  // namespace
}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  fuzz::TrackInput input;
  if (!fuzz::ParseRequest(data, size, &input)) return 0;
  fuzz::Stream stream;
  for (const v1::TrackRequest& request : input.requests()) {
    if (const absl::Status status = stream.Take(request); !status.ok()) {
      fuzz::PromiseError(status);
      return 0;
    }
  }
  return 0;
}
