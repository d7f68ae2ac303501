// base/csv.h
//
// Fields of comma-separated values, as RFC 4180 has them.
#pragma once

#include <optional>
#include <string>

namespace lightfit {

// In quotes where it has to be; line ends become spaces.
std::string CsvField(const std::string& text);

// The shortest digits that read back as the same number; nothing for none.
std::string CsvNumber(double value);
std::string CsvNumber(const std::optional<double>& value);

}  // namespace lightfit
