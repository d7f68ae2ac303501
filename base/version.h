// base/version.h
//
// Which lightfit this is.
#pragma once

namespace lightfit {

// "0.1.0", as CMakeLists.txt says.
extern const char kVersion[];

}  // namespace lightfit
