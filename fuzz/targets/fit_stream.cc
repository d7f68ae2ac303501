// The call FitStream: its messages, through PixelBuffer as server/fit_stream_call takes them.
#include <optional>

#include "calls/fit_call.h"
#include "calls/pixel_buffer.h"
#include "fuzz/calls.h"
#include "fuzz/input_form.h"
#include "fuzz/inputs.pb.h"
#include "fuzz/promises.h"

namespace lightfit::fuzz {

InputForm FormOfInput() { return {&FitStreamInput::default_instance(), Encoding::kMessage}; }

namespace {

class Stream {
 public:
  // Ok as long as the stream may go on.
  absl::Status Take(const v1::FitStreamRequest& part) {
    if (part.has_pixels() && pixels_.has_value()) return pixels_->Append(part.pixels());
    if (!part.has_request() || pixels_.has_value()) {
      return absl::InvalidArgumentError("want one request, then pixels");
    }
    request_ = part.request();
    ShortenSearch(request_.mutable_options());
    const absl::StatusOr<ReadbackHeader> header =
        ReadbackHeaderFromProto(request_.readback(), request_.lights_size(), context_.limits);
    if (!header.ok()) return header.status();
    pixels_.emplace(*header);
    return pixels_->Append(request_.readback());
  }

  absl::StatusOr<v1::FitResult> Answer() const {
    if (!pixels_.has_value()) return absl::InvalidArgumentError("want a request");
    if (absl::Status status = pixels_->CheckComplete(); !status.ok()) return status;
    FineCover fine_cover;
    const Readback readback = pixels_->View(&fine_cover);
    const auto num_pixels = static_cast<size_t>(readback.camera.width) * readback.camera.height;
    const auto is_all = [&](const auto& values) { return values.size() == num_pixels; };
    Promise(is_all(readback.depth) && is_all(readback.shadow_bits) &&
                (readback.facing_bits.empty() || is_all(readback.facing_bits)) &&
                (readback.mapped_bits.empty() || is_all(readback.mapped_bits)),
            "a complete buffer has all pixels");
    return AnswerFit(request_, readback, context_);
  }

 private:
  CallContext context_ = SmallContext();
  v1::FitRequest request_;
  std::optional<PixelBuffer> pixels_;
};

}  // namespace
}  // namespace lightfit::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lightfit;  // NOLINT(google-build-using-namespace)
  fuzz::FitStreamInput input;
  if (!fuzz::ParseRequest(data, size, &input)) return 0;
  fuzz::Stream stream;
  for (const v1::FitStreamRequest& part : input.requests()) {
    if (const absl::Status status = stream.Take(part); !status.ok()) {
      fuzz::PromiseError(status);
      return 0;
    }
  }
  fuzz::PromiseAnswer(stream.Answer());
  return 0;
}
