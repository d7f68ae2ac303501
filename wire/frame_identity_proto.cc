#include "wire/frame_identity_proto.h"

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"

namespace lightfit {
namespace {

constexpr int kHashBytes = 16;

absl::Status Refuse(absl::string_view field, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat(field, " ", what));
}

}  // namespace

void FramesToProto(const std::vector<FrameIdentity>& frames, v1::SummaryFile* proto) {
  int64_t before = 0;
  for (const FrameIdentity& frame : frames) {
    proto->mutable_frame_hashes()->append(frame.hash.begin(), frame.hash.end());
    if (!frame.number.has_value()) {
      proto->set_frames_without_number(proto->frames_without_number() + 1);
      continue;
    }
    proto->add_frame_numbers(frame.number->millionths - before);
    before = frame.number->millionths;
  }
}

absl::Status FramesFromProto(const v1::SummaryFile& proto,
                             int64_t most_frames,
                             std::vector<FrameIdentity>* frames) {
  const std::string& hashes = proto.frame_hashes();
  const auto num_frames = static_cast<int64_t>(hashes.size() / kHashBytes);
  const int64_t num_without = proto.frames_without_number();
  if (hashes.size() % kHashBytes != 0 || num_frames > most_frames) {
    return Refuse("frame_hashes",
                  absl::StrFormat("has %d bytes, want %d for each of at most %d frames",
                                  hashes.size(),
                                  kHashBytes,
                                  most_frames));
  }
  if (num_without < 0 || num_without != num_frames - proto.frame_numbers_size()) {
    return Refuse("frame_numbers and frames_without_number",
                  absl::StrFormat("are of %d and %d frames, want %d in all",
                                  proto.frame_numbers_size(),
                                  num_without,
                                  num_frames));
  }
  constexpr int64_t kMost = FrameNumber::kMostWhole * FrameNumber::kUnit;
  FrameNumber number;
  frames->reserve(static_cast<size_t>(num_frames));
  for (int64_t i = 0; i < num_frames; ++i) {
    FrameIdentity frame;
    const auto first = hashes.begin() + i * kHashBytes;
    std::copy(first, first + kHashBytes, frame.hash.begin());
    if (i >= num_without) {
      const int64_t step = proto.frame_numbers(static_cast<int>(i - num_without));
      if (step < -kMost || step > 2 * kMost || number.millionths + step > kMost) {
        return Refuse("frame_numbers", absl::StrFormat("has a step of %d millionths", step));
      }
      number.millionths += step;
      frame.number = number;
    }
    if (!frames->empty() && !(frames->back() < frame)) {
      return Refuse("frame_numbers and frame_hashes", "are not in ascending order");
    }
    frames->push_back(frame);
  }
  return absl::OkStatus();
}

}  // namespace lightfit
