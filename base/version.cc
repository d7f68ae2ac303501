#include "base/version.h"

namespace lightfit {

const char kVersion[] = LIGHTFIT_VERSION;

}  // namespace lightfit
