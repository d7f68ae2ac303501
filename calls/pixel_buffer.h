// calls/pixel_buffer.h
//
// The pixels of a read-back that arrive piece by piece, or in a form that has to be converted.
// In:   the header of a v1::Readback (camera and formats), then pieces of whole values.
// Out:  a Readback of float depth and words of bits, refused as soon as a piece does not belong.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "calls/bit_buffer.h"
#include "calls/call_context.h"
#include "calls/fine_cover_buffer.h"
#include "geometry/camera.h"
#include "lightfit/v1/readback.pb.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

// What a read-back says of itself before its first pixel.
struct ReadbackHeader {
  Camera camera;
  DepthKind depth_kind = DepthKind::kCameraZ;
  std::optional<float> background;  // as Readback::background
  v1::DepthFormat depth_format = v1::DEPTH_FORMAT_FLOAT32;
  BitsHeader shadow;
  BitsHeader facing, mapped;  // may be absent
  FineCoverHeader fine;       // likewise

  int64_t num_pixels() const { return int64_t{camera.width} * camera.height; }
  int64_t depth_bytes() const;  // as sent

  // What a PixelBuffer of it takes, bytes.
  int64_t buffer_bytes() const;
};

// Looks at camera and formats; `field` names the read-back in messages. InvalidArgument when they
// cannot be or there are no lights or too many, ResourceExhausted above limits.max_pixels.
absl::StatusOr<ReadbackHeader> ReadbackHeaderFromProto(const v1::Readback& proto,
                                                       int num_lights,
                                                       const CallLimits& limits);

// Takes the pixels out of a message that a PixelBuffer has them of.
void ClearPixels(v1::Readback* readback);

class PixelBuffer {
 public:
  // Memory is taken as pixels arrive.
  explicit PixelBuffer(const ReadbackHeader& header);

  // All pixels that the message has, in its own header's formats.
  absl::Status Append(const v1::Readback& proto);

  // InvalidArgument for what goes beyond the end, is out of order or of the other shadow format.
  absl::Status Append(const v1::PixelChunk& chunk);

  // InvalidArgument says how much is missing of what.
  absl::Status CheckComplete() const;
  bool is_complete() const { return CheckComplete().ok(); }

  // Of a complete buffer; refers to it, and to `fine_cover`, which it fills in. Null: without.
  Readback View(FineCover* fine_cover = nullptr) const;

 private:
  absl::Status AppendDepth(absl::string_view bytes);

  ReadbackHeader header_;
  std::vector<float> depth_;
  int64_t num_depth_bytes_ = 0;  // arrived so far
  BitBuffer shadow_, facing_, mapped_;
  FineCoverBuffer fine_;
};

// The read-back of a header whose pixels are there already. Refers to them.
Readback ReadbackOf(const ReadbackHeader& header,
                    absl::Span<const float> depth,
                    absl::Span<const uint32_t> shadow_bits,
                    absl::Span<const uint32_t> facing_bits,
                    absl::Span<const uint32_t> mapped_bits);

// ResourceExhausted when shadows, or the surfaces that face the lights, have more border than
// limits.max_boundary_pixels, as noise has.
absl::Status CheckBoundary(const Readback& readback, const CallLimits& limits);

// A read-back that came whole: refers to the message's own bytes where they can be used as they
// are, and to a buffer of its own otherwise. The message must outlive it.
class ReadbackView {
 public:
  static absl::StatusOr<ReadbackView> Of(const v1::Readback& proto,
                                         int num_lights,
                                         const CallLimits& limits);

  ReadbackView(ReadbackView&&) = default;
  ReadbackView& operator=(ReadbackView&&) = default;

  const Readback& view() const { return view_; }

 private:
  explicit ReadbackView(const ReadbackHeader& header)
      : buffer_(header), fine_cover_(std::make_unique<FineCover>()) {}

  PixelBuffer buffer_;
  std::unique_ptr<FineCover> fine_cover_;  // stays in place when the view moves
  Readback view_;
};

}  // namespace lightfit
