#include "server/unary_call.h"

namespace lightfit {
namespace {

// Pixels that cannot be used where they are in the message are converted: 8 bytes each.
RequestSize SizeWithReadback(int64_t message_bytes, const v1::Readback& readback) {
  constexpr int64_t kConvertedPixelBytes = 8;
  const bool is_half = readback.depth_format() == v1::DEPTH_FORMAT_FLOAT16;
  const int64_t pixels = static_cast<int64_t>(readback.depth().size()) / (is_half ? 2 : 4);
  const bool is_converted = is_half || readback.shadow_planes_size() > 0;
  return {pixels, message_bytes + (is_converted ? kConvertedPixelBytes * pixels : 0)};
}

int64_t BytesOf(const google::protobuf::Message& message) {
  return static_cast<int64_t>(message.ByteSizeLong());
}

}  // namespace

RequestSize SizeOf(const v1::FitRequest& request) {
  return SizeWithReadback(BytesOf(request), request.readback());
}

RequestSize SizeOf(const v1::FitSummaryRequest& request) { return {0, BytesOf(request)}; }

RequestSize SizeOf(const v1::EvaluateRequest& request) {
  return SizeWithReadback(BytesOf(request), request.readback());
}

RequestSize SizeOf(const v1::AllocateRequest& request) {
  return SizeWithReadback(BytesOf(request), request.readback());
}

void NoteResult(const v1::FitResult& result, Call* call) { call->NoteLights(result.lights()); }

void NoteResult(const v1::EvaluateResult& /*result*/, Call* /*call*/) {}

void NoteResult(const v1::Allocation& result, Call* call) { call->NoteLights(result.lights()); }

}  // namespace lightfit
