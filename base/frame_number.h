// base/frame_number.h
//
// Where a frame is on the time line: -2, 1001, or between frames 1001.25.
// In:   the digits of a file's name, or a number of a file.
// Out:  FrameNumber, exact to a millionth of a frame, in its order.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>

#include "absl/strings/string_view.h"

namespace lightfit {

struct FrameNumber {
  static constexpr int64_t kUnit = 1000000;
  static constexpr int64_t kMostWhole = 999999999999;  // longer numbers in names are dates

  int64_t millionths = 0;

  // -kMostWhole ... kMostWhole.
  static FrameNumber Whole(int64_t number) { return {number * kUnit}; }

  bool is_whole() const { return millionths % kUnit == 0; }
  double value() const { return static_cast<double>(millionths) / static_cast<double>(kUnit); }

  // The whole frame at or before it, and what is left: 0 ... kUnit - 1.
  int64_t floor() const { return (millionths - rest()) / kUnit; }
  int64_t rest() const { return ((millionths % kUnit) + kUnit) % kUnit; }

  // "-2", "1001.25".
  std::string Text() const;

  friend auto operator<=>(const FrameNumber&, const FrameNumber&) = default;
};

// "-002", "1001", "1001.25"; nothing else around it. At most twelve digits, and six after the
// point.
std::optional<FrameNumber> ParseFrameNumber(absl::string_view text);

// To the nearest millionth. Nothing for what is not finite or too large.
std::optional<FrameNumber> FrameNumberOf(double value);

}  // namespace lightfit
