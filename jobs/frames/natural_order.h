// jobs/frames/natural_order.h
//
// Names in the order in which people count.
#pragma once

#include "absl/strings/string_view.h"

namespace lightfit {

// Whether `a` comes before `b`: "frame9" before "frame10".
bool NaturalLess(absl::string_view a, absl::string_view b);

}  // namespace lightfit
