#include "jobs/frames/frame_gaps.h"

#include <algorithm>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace lightfit {
namespace {

constexpr size_t kMostListed = 8;

}  // namespace

FrameGaps FindGaps(absl::Span<const FrameNumber> numbers) {
  FrameGaps gaps;
  gaps.is_after.assign(numbers.size(), false);
  int64_t step = 0;
  for (size_t i = 1; i < numbers.size(); ++i) {
    step = std::gcd(step, numbers[i].millionths - numbers[i - 1].millionths);
  }
  gaps.step.millionths = step;
  if (step > 0 && step < FrameNumber::kUnit) {
    int64_t num_even = 0;
    for (size_t i = 1; i < numbers.size(); ++i) {
      num_even += numbers[i].millionths - numbers[i - 1].millionths == step ? 1 : 0;
    }
    const bool is_even = 2 * num_even > static_cast<int64_t>(numbers.size()) - 1;
    if (!is_even) gaps.step = FrameNumber::Whole(1);
  }
  for (size_t i = 1; i < numbers.size(); ++i) {
    const int64_t before = numbers[i - 1].millionths, now = numbers[i].millionths;
    if (now - before <= gaps.step.millionths) continue;
    gaps.is_after[i] = true;
    // From the next step on to the last one before `now`.
    const int64_t count = (now - before - 1) / gaps.step.millionths;
    gaps.num_missing += count;
    const FrameNumber first = {before + gaps.step.millionths};
    const FrameNumber last = {before + count * gaps.step.millionths};
    gaps.missing.push_back(first == last ? first.Text()
                                         : absl::StrCat(first.Text(), "-", last.Text()));
  }
  return gaps;
}

std::string GapsText(const FrameGaps& gaps) {
  if (gaps.missing.empty()) return "";
  const size_t listed = std::min(gaps.missing.size(), kMostListed);
  std::string list = absl::StrJoin(
      gaps.missing.begin(), gaps.missing.begin() + static_cast<std::ptrdiff_t>(listed), ", ");
  if (listed < gaps.missing.size()) absl::StrAppend(&list, ", ...");
  return gaps.num_missing == 1
             ? absl::StrCat("frame ", list, " is missing")
             : absl::StrCat("frames ", list, " are missing (", gaps.num_missing, ")");
}

}  // namespace lightfit
