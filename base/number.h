// base/number.h
//
// Numbers as people read them.
#pragma once

#include <string>

namespace lightfit {

// Three significant digits, all digits of the integer part up to a million, no exponent in between:
// 0.0532, 1.50, 47.1, 1234, 2.35e+07. Zero is "0".
std::string FigureText(double value);

// A share of 1 in per cent, without the sign: 0.0532 for 0.000532.
inline std::string PercentText(double share) { return FigureText(100.0 * share); }

}  // namespace lightfit
