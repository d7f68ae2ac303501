#include "server/unary_call.h"

namespace lightfit {
namespace {

int64_t BytesOfFineCover(const v1::FineCover& fine) {
  return static_cast<int64_t>(fine.nearest().size() + fine.furthest().size() +
                              fine.shadow_bits().size() + fine.lit_bits().size());
}

// Pixels that cannot be used where they are in the message are converted: 4 bytes for the depth,
// and 4 for each kind of bits; with a finer cover, which is copied, all are.
RequestSize SizeWithReadback(int64_t message_bytes, const v1::Readback& readback) {
  constexpr int64_t kConvertedValueBytes = 4;
  const bool is_half = readback.depth_format() == v1::DEPTH_FORMAT_FLOAT16;
  const int64_t pixels = static_cast<int64_t>(readback.depth().size()) / (is_half ? 2 : 4);
  const bool has_facing_planes = readback.facing_planes_size() > 0;
  const bool has_mapped_planes = readback.mapped_planes_size() > 0;
  const int64_t fine_bytes = BytesOfFineCover(readback.fine_cover());
  if (!is_half && readback.shadow_planes_size() == 0 && !has_facing_planes && !has_mapped_planes &&
      fine_bytes == 0) {
    return {pixels, message_bytes};
  }
  const int num_values = 2 + (has_facing_planes || !readback.facing_bits().empty() ? 1 : 0) +
                         (has_mapped_planes || !readback.mapped_bits().empty() ? 1 : 0);
  return {pixels, message_bytes + fine_bytes + num_values * kConvertedValueBytes * pixels};
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
  const RequestSize size = SizeWithReadback(BytesOf(request), request.readback());
  if (!request.has_before()) return size;
  const RequestSize before = SizeWithReadback(0, request.before());
  return {size.pixels + before.pixels, size.bytes + before.bytes};
}

RequestSize SizeOf(const v1::AllocateRequest& request) {
  return SizeWithReadback(BytesOf(request), request.readback());
}

RequestSize SizeOf(const v1::SummarizeRequest& request) {
  return SizeWithReadback(BytesOf(request), request.readback());
}

RequestSize SizeOf(const v1::CompareRequest& request) {
  return SizeWithReadback(BytesOf(request), request.readback());
}

void NoteResult(const v1::FitResult& result, Call* call) { call->NoteLights(result.lights()); }

void NoteResult(const v1::EvaluateResult& /*result*/, Call* /*call*/) {}

void NoteResult(const v1::SummarizeResult& /*result*/, Call* /*call*/) {}

void NoteResult(const v1::Comparison& /*result*/, Call* /*call*/) {}

void NoteResult(const v1::Allocation& result, Call* call) { call->NoteLights(result.lights()); }

}  // namespace lightfit
