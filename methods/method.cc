#include "methods/method.h"

#include "absl/strings/str_cat.h"
#include "methods/focused.h"
#include "methods/lispsm.h"
#include "methods/perspective.h"
#include "methods/plane_optimal.h"
#include "methods/standard.h"
#include "methods/trapezoidal.h"

namespace lightfit {

const std::vector<Method>& AllMethods() {
  static const auto& methods = *new std::vector<Method>{Method::kStandard,
                                                        Method::kFocused,
                                                        Method::kTrapezoidal,
                                                        Method::kLispsmSimple,
                                                        Method::kLispsm,
                                                        Method::kPerspective,
                                                        Method::kPlaneOptimal};
  return methods;
}

const char* MethodName(Method method) {
  switch (method) {
    case Method::kStandard:
      return "standard";
    case Method::kFocused:
      return "focused";
    case Method::kTrapezoidal:
      return "tsm";
    case Method::kLispsmSimple:
      return "lispsm-simple";
    case Method::kLispsm:
      return "lispsm";
    case Method::kPerspective:
      return "psm";
    case Method::kPlaneOptimal:
      return "plane-optimal";
  }
  return "unknown";
}

absl::StatusOr<Method> ParseMethod(const std::string& name) {
  std::string names;
  for (const Method method : AllMethods()) {
    if (name == MethodName(method)) return method;
    absl::StrAppend(&names, names.empty() ? "" : ", ", MethodName(method));
  }
  return absl::InvalidArgumentError(absl::StrCat("method = \"", name, "\", want one of: ", names));
}

absl::StatusOr<MethodMap> SetUpMap(Method method, const MethodInput& input) {
  switch (method) {
    case Method::kStandard:
      return StandardMap(input);
    case Method::kFocused:
      return FocusedMap(input);
    case Method::kTrapezoidal:
      return TrapezoidalMap(input);
    case Method::kLispsmSimple: {
      LispsmOptions options;
      options.formula = LispsmOptions::Formula::kSimple;
      return LispsmMap(input, options);
    }
    case Method::kLispsm:
      return LispsmMap(input);
    case Method::kPerspective:
      return PerspectiveMap(input);
    case Method::kPlaneOptimal:
      return PlaneOptimalMap(input);
  }
  return absl::InvalidArgumentError("method: not one of AllMethods()");
}

}  // namespace lightfit
