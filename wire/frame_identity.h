// wire/frame_identity.h
//
// Which frames a sum is of, so that none is counted twice.
// In:   a read-back and its number on the time line.
// Out:  FrameIdentity, 16 bytes and the number: the same wherever and whenever it is read.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/types/span.h"
#include "base/frame_number.h"
#include "optimizer/readback/readback.h"

namespace lightfit {

struct FrameIdentity {
  std::optional<FrameNumber> number;  // a still shot has frames that are alike in all else
  std::array<uint8_t, 16> hash = {};  // of depth and camera

  // By number, those without one first; then by hash.
  friend auto operator<=>(const FrameIdentity&, const FrameIdentity&) = default;
};

// What the lights say has no part in it: it is the same frame with more or fewer of them.
FrameIdentity IdentityOf(const Readback& readback, const std::optional<FrameNumber>& number);

// "frame 1007"; "a frame without a number (3f0a6c21)".
std::string IdentityText(const FrameIdentity& identity);

// Of lists in ascending order: the first that both have.
std::optional<FrameIdentity> FirstInBoth(absl::Span<const FrameIdentity> a,
                                         absl::Span<const FrameIdentity> b);

// Puts `more` where it belongs in `frames`; both in ascending order.
void InsertInOrder(absl::Span<const FrameIdentity> more, std::vector<FrameIdentity>* frames);

// The numbers that two or more of the frames have, which are then of different content.
std::vector<FrameNumber> NumbersOfSeveral(absl::Span<const FrameIdentity> frames);

}  // namespace lightfit
