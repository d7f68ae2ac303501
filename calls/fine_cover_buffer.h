// calls/fine_cover_buffer.h
//
// The finer cover of a read-back, which arrives piece by piece.
// In:   the header of a v1::FineCover (sizes, and what follows), then pieces of whole values.
// Out:  FineCover, refused as soon as a piece does not belong.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "calls/call_context.h"
#include "lightfit/v1/readback.pb.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct FineCoverHeader {
  int columns = 0, rows = 0;  // 0: there is none
  bool has_furthest = false;
  uint32_t lit_lights = 0;

  bool is_absent() const { return columns == 0; }
  int64_t num_cells() const { return int64_t{columns} * rows; }

  // What a FineCoverBuffer of it takes, bytes.
  int64_t buffer_bytes() const;
};

// Of a read-back of `width` x `height` pixels. InvalidArgument when it is not finer, or bits are of
// lights that are not there; ResourceExhausted above limits.max_pixels.
absl::StatusOr<FineCoverHeader> FineCoverHeaderFromProto(const v1::Readback& proto,
                                                         int num_lights,
                                                         const CallLimits& limits);

class FineCoverBuffer {
 public:
  // Memory is taken as values arrive.
  explicit FineCoverBuffer(const FineCoverHeader& header) : header_(header) {}

  // All that the message has; InvalidArgument for what goes beyond the end or was not announced.
  absl::Status Append(const v1::FineCover& proto);
  absl::Status Append(const v1::PixelChunk& chunk);

  // InvalidArgument says how much is missing of what.
  absl::Status CheckComplete() const;

  // Of a complete buffer; refers to it.
  FineCover View() const;

 private:
  struct Array {
    const char* name;  // in readback.fine_cover
    absl::string_view bytes;
    const char* missing;  // the field that did not announce it; null: it was announced
  };

  // Values of 4 bytes.
  template <typename Word>
  absl::Status AppendTo(const Array& array, std::vector<Word>* words) const;
  absl::Status AppendAll(absl::string_view nearest,
                         absl::string_view furthest,
                         absl::string_view shadow_bits,
                         absl::string_view lit_bits);

  FineCoverHeader header_;
  std::vector<float> nearest_, furthest_;
  std::vector<uint32_t> shadow_bits_, lit_bits_;
};

}  // namespace lightfit
