#include "cli/flags/number_checks.h"

#include <cmath>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"

namespace lightfit::cli {
namespace {

// As the option itself will be read.
std::optional<double> NumberOf(const std::string& text) {
  double number = 0.0;
  if (!CLI::detail::lexical_cast(text, number)) return std::nullopt;
  return number;
}

// `is_wanted` is asked of numbers alone, NaN among them; `words` go into the help.
template <typename IsWanted>
CLI::Validator NumberThat(const IsWanted& is_wanted,
                          const std::string& wanted,
                          const std::string& words) {
  const auto check = [is_wanted, wanted](const std::string& text) {
    const std::optional<double> number = NumberOf(text);
    return number.has_value() && is_wanted(*number)
               ? std::string()
               : absl::StrCat("\"", text, "\", want a number ", wanted);
  };
  return CLI::Validator(check, words);
}

}  // namespace

CLI::Validator NumberIn(double least, double most) {
  const bool is_bounded = std::isfinite(most);
  return NumberThat(
      [least, most](double number) { return number >= least && number <= most; },
      is_bounded ? absl::StrCat("from ", least, " to ", most) : absl::StrCat("from ", least, " on"),
      is_bounded ? absl::StrCat("FLOAT in [", least, " - ", most, "]") : "NONNEGATIVE");
}

CLI::Validator NumberAboveZero() {
  return NumberThat(
      [](double number) { return number > 0.0 && std::isfinite(number); }, "above 0", "POSITIVE");
}

CLI::Validator NumberAboveZeroOrInfinite() {
  return NumberThat([](double number) { return number > 0.0; }, "above 0, or inf", "POSITIVE");
}

}  // namespace lightfit::cli
