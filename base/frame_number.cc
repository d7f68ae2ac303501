#include "base/frame_number.h"

#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/strip.h"

namespace lightfit {
namespace {

constexpr size_t kMostDigits = 12, kMostDecimals = 6;

bool AreDigits(absl::string_view text) {
  for (const char c : text) {
    if (!absl::ascii_isdigit(c)) return false;
  }
  return !text.empty();
}

absl::string_view WithoutZeros(absl::string_view digits) {
  while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
  return digits;
}

}  // namespace

std::string FrameNumber::Text() const {
  const int64_t magnitude = millionths < 0 ? -millionths : millionths;
  std::string text = absl::StrCat(millionths < 0 ? "-" : "", magnitude / kUnit);
  if (is_whole()) return text;
  std::string decimals = absl::StrFormat("%06d", magnitude % kUnit);
  while (decimals.back() == '0') decimals.pop_back();
  return absl::StrCat(text, ".", decimals);
}

std::optional<FrameNumber> ParseFrameNumber(absl::string_view text) {
  const bool is_negative = absl::ConsumePrefix(&text, "-");
  const size_t point = text.find('.');
  const absl::string_view whole = WithoutZeros(text.substr(0, point));
  const std::string decimals(point == absl::string_view::npos ? "0" : text.substr(point + 1));
  if (!AreDigits(whole) || whole.size() > kMostDigits) return std::nullopt;
  if (!AreDigits(decimals) || decimals.size() > kMostDecimals) return std::nullopt;
  int64_t number = 0, millionths = 0;
  if (!absl::SimpleAtoi(whole, &number)) return std::nullopt;
  const std::string padded = decimals + std::string(kMostDecimals - decimals.size(), '0');
  if (!absl::SimpleAtoi(padded, &millionths)) return std::nullopt;
  const int64_t magnitude = number * FrameNumber::kUnit + millionths;
  return FrameNumber{is_negative ? -magnitude : magnitude};
}

std::optional<FrameNumber> FrameNumberOf(double value) {
  // Written so that NaN fails.
  if (!(std::abs(value) <= static_cast<double>(FrameNumber::kMostWhole))) return std::nullopt;
  return FrameNumber{
      static_cast<int64_t>(std::llround(value * static_cast<double>(FrameNumber::kUnit)))};
}

}  // namespace lightfit
