// cli/flags/number_checks.h
//
// Checks of options that take a number with a fraction. Those of CLI11 let "nan" through, which is
// neither below one number nor above another, and refuse "inf" in 300 digits.
// In:   the numbers that are wanted.
// Out:  for CLI::Option::check(): anything else is refused while parsing (exit code 1).
#pragma once

#include <CLI/CLI.hpp>

namespace lightfit::cli {

// Both ends included; `most` may be infinite.
CLI::Validator NumberIn(double least, double most);

// Above 0 and finite.
CLI::Validator NumberAboveZero();

// Above 0; "inf" is one.
CLI::Validator NumberAboveZeroOrInfinite();

}  // namespace lightfit::cli
