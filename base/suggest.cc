#include "base/suggest.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace lightfit {
namespace {

constexpr size_t kMostMeant = 3;
constexpr size_t kLeastBeginning = 2;  // letters: a single one begins too many words

// Optimal string alignment: fewest letters inserted, removed, replaced, or swapped with their
// neighbour.
size_t EditDistance(const std::string& a, const std::string& b) {
  const size_t width = b.size() + 1;
  std::vector<size_t> table((a.size() + 1) * width);
  const auto at = [&table, width](size_t i, size_t j) -> size_t& { return table[i * width + j]; };
  for (size_t i = 0; i <= a.size(); ++i) {
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        at(i, j) = i + j;
        continue;
      }
      const size_t replaced = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
      }
    }
  }
  return at(a.size(), b.size());
}

}  // namespace

std::vector<std::string> LikelyMeant(const std::string& word,
                                     const std::vector<std::string>& choices) {
  const std::string lower = absl::AsciiStrToLower(word);
  const size_t most = std::max<size_t>(1, word.size() / 3);
  std::vector<std::pair<size_t, std::string>> close;
  std::vector<std::string> beginning;
  for (const std::string& choice : choices) {
    const std::string lower_choice = absl::AsciiStrToLower(choice);
    const size_t distance = EditDistance(lower, lower_choice);
    if (distance <= most && distance < choice.size()) close.emplace_back(distance, choice);
    if (lower.size() >= kLeastBeginning &&
        (absl::StartsWith(lower_choice, lower) ||
         absl::StrContains(lower_choice, absl::StrCat("-", lower)))) {
      beginning.push_back(choice);
    }
  }
  std::stable_sort(
      close.begin(), close.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> meant;
  for (const auto& [distance, choice] : close) {
    if (distance == close.front().first) meant.push_back(choice);
  }
  if (meant.empty()) meant = std::move(beginning);
  if (meant.size() > kMostMeant) meant.resize(kMostMeant);
  return meant;
}

std::string DidYouMean(const std::string& word, const std::vector<std::string>& choices) {
  const std::vector<std::string> meant = LikelyMeant(word, choices);
  return meant.empty() ? ""
                       : absl::StrCat("; did you mean \"", absl::StrJoin(meant, "\" or \""), "\"?");
}

}  // namespace lightfit
