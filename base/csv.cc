#include "base/csv.h"

#include <charconv>

namespace lightfit {

std::string CsvField(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted.push_back('"');
    quoted.push_back(c == '\n' || c == '\r' ? ' ' : c);
  }
  return quoted + "\"";
}

std::string CsvNumber(double value) {
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof(digits), value);
  return std::string(digits, end.ptr);
}

std::string CsvNumber(const std::optional<double>& value) {
  return value.has_value() ? CsvNumber(*value) : "";
}

}  // namespace lightfit
