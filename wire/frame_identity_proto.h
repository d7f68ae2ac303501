// wire/frame_identity_proto.h
//
// FrameIdentity from and to the fields of lightfit.v1.SummaryFile.
// In:   identities in ascending order; or a message that may come from anywhere.
// Out:  the fields; or identities in order, each there once.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "lightfit/v1/summary.pb.h"
#include "wire/frame_identity.h"

namespace lightfit {

void FramesToProto(const std::vector<FrameIdentity>& frames, v1::SummaryFile* proto);

// Appends to `frames`. InvalidArgument also for more than `most_frames`.
absl::Status FramesFromProto(const v1::SummaryFile& proto,
                             int64_t most_frames,
                             std::vector<FrameIdentity>* frames);

}  // namespace lightfit
